"""Figs. 15 to 22: the truss, the coupling of net and truss, and the sweep over pretensions."""
import numpy as np

from draw import BLACK, BLUE, CYAN, RED, WIDTH, Plot, View, path_of
from figures import HEIGHTS, MOVES, save, shapes, tensions
from svg import text

UNITS = (("bud", "BUD, on the directrix", RED), ("mbug", "MBUG, main, on the generatrix", BLUE),
         ("abug", "ABUG, assistant", CYAN))


def fig15(runs, out):
    r = runs["truss"]
    at, end, unit = r["truss/node/position_m"], r["truss/member/end"], r.words("truss/member/unit")
    view = View(at)
    for word, name, colour in UNITS:
        view.cables(at, end[unit == word], name, colour, 1.3)
    view.nodes(at[r["truss/attachment/truss_node"]], "net is attached", BLACK, 2.6)
    view.bar(2.0, at.min(0) - [1.0, 1.6, 0])
    save(out, 15, [view], f"The truss as assumed here: {len(at)} nodes, {len(end)} members, "
         f"{r.get('truss', 'mass_kg'):.1f} kg with its hinges; the paper prints no dimension of its own, and 200 kg in "
         "all. It is clamped at the rear of its central module. Drawn to scale.", r)


class Blocks:
    """Draws the nonzero blocks of the stiffness matrix as dots in a square."""

    def __init__(self, result, size=470):
        end, unit, n = result["truss/member/end"], result.words("truss/member/unit"), len(result["truss/node/id"])
        self.pairs = {(i, j) for a, b in end for i, j in ((a, a), (b, b), (a, b), (b, a))}
        step, left, self.height = size / n, (WIDTH - size) / 2, size + 70
        self.body = [f'<rect x="{left}" y="40" width="{size}" height="{size}" fill="none" stroke="#888"/>']
        for k, (word, name, colour) in enumerate(UNITS):
            pairs = sorted({(i, j) for a, b in end[unit == word] for i, j in ((a, b), (b, a))})
            if word == "bud":
                pairs += [(k, k) for k in range(n)]
            squares = "".join(f"M{left + j * step:.1f} {40 + i * step:.1f}h{step:.1f}v{step:.1f}h-{step:.1f}z"
                              for i, j in pairs)
            self.body.append(f'<path d="{squares}" fill="{colour}"/>')
            self.body += [f'<rect x="{20 + 250 * k}" y="14" width="10" height="10" fill="{colour}"/>',
                          text(36 + 250 * k, 23, name, 12, "start")]
        self.body.append(text(WIDTH / 2, size + 60, f"node (6 degrees of freedom each), 1 to {n}", 13))

    def draw(self):
        return self.body, self.height


def fig16(runs, out):
    r = runs["truss"]
    blocks, n = Blocks(r), len(r["truss/node/id"])
    save(out, 16, [blocks], f"Each member adds four blocks of 6 x 6 to the total stiffness matrix [K] of {6 * n} rows: "
         f"{len(blocks.pairs)} of {n * n} blocks are not zero. Nodes in the order of the result file; blocks on the "
         "diagonal gather members of all units. The paper's figure explains the same sum for two elements.", r)


class Flow:
    """Draws boxes from top to bottom, with an arrow back from the last question."""

    def __init__(self, boxes, again, back_to):
        self.body, self.height, middle, w, h, gap = [], 0, 300, 470, 44, 22
        for k, (words, note) in enumerate(boxes):
            y = 20 + k * (h + gap)
            last = k == len(boxes) - 1
            self.body += [f'<rect x="{middle - w / 2}" y="{y}" width="{w}" height="{h}" rx="{20 if last else 4}" '
                          f'fill="#f4f7fb" stroke="{BLUE}"/>', text(middle, y + 19, words, 13),
                          f'<g fill="#555">{text(middle, y + 36, note, 12)}</g>']
            if not last:
                self.body += self.arrow([(middle, y + h), (middle, y + h + gap)])
        low, high = 20 + (len(boxes) - 1) * (h + gap) + h / 2, 20 + back_to * (h + gap) + h / 2
        right = middle + w / 2
        self.body += self.arrow([(right, low), (right + 70, low), (right + 70, high), (right, high)])
        self.body.append(text(right + 80, (low + high) / 2, again, 12, "start"))
        self.height = 20 + len(boxes) * (h + gap)

    @staticmethod
    def arrow(points):
        (x, y), (a, b) = points[-1], points[-2]
        dx, dy = np.sign(x - a), np.sign(y - b)
        tip = f"M{x} {y}L{x - 8 * dx - 4 * dy} {y - 8 * dy - 4 * dx}L{x - 8 * dx + 4 * dy} {y - 8 * dy + 4 * dx}z"
        return [path_of(points, BLACK, 1.4), f'<path d="{tip}" fill="{BLACK}"/>']

    def draw(self):
        return self.body, self.height


def fig17(runs, out):
    r, n = runs["truss"], len(runs["truss"]["truss/node/id"])
    step, psi = 1e3 * r["coupling/history/step_m"], 1e3 * r["coupling/history/psi_m"]
    pull = np.linalg.norm(r["coupling/force_N"], axis=1).max()
    largest = 1e3 * r.get("coupling", "deflection_max_m")
    flow = Flow([("net: topology, theoretical shape, Td, supports", f"{len(r.target_m)} nodes, {len(r.end)} cables"),
                 ("truss: [K] assembled, factored once, condensed to the attachments",
                  f"{6 * n} rows; {len(r['coupling/node'])} attachments"),
                 ("HIFDM until the nodal forces vanish", "psi " + ", ".join(f"{v:.3f}" for v in psi) + " mm"),
                 ("pull of the cables on the attachments {F}", f"up to {pull:.2f} N"),
                 ("displacements from {Q} = [K]{D}, Eq. 15", f"up to {largest:.4f} mm"),
                 ("have they changed by less than tof = 1 mm?",
                  "changes " + ", ".join(f"{v:.2g}" for v in step) + " mm: yes, done")], "no: move them", 2)
    save(out, 17, [flow], f"{r.setting}; the numbers are those of this run, one per form-finding. The truss is "
         "factored once, because its matrix never changes.", r)


def fig18(runs, out):
    r, tight = runs["truss"], runs["truss_tight"]
    at, end = r["truss/node/position_m"], r["truss/member/end"]
    move = r["truss/node/displacement"][:, :3]
    largest = np.linalg.norm(r["coupling/displacement_m"], axis=1).max()
    view = View(np.vstack([at, at + MOVES * move]), elevation=24, height=380)
    view.cables(at, end, "truss", BLUE, 0.8)
    view.cables(at + MOVES * move, end, f"under the net, moves {MOVES} times too large", RED, 1.1, True)
    psi, rigid = (1e3 * run.get("form", "psi_m") for run in (tight, runs["hifdm"]))
    save(out, 18, [shapes(r, "form", "net on its truss"), view], f"{r.setting}. Above, the net: psi "
         f"{psi:.4f} mm, to which the softness of the truss is calibrated (the paper: 8.38 mm); {rigid:.4f} mm on "
         f"rigid supports. Heights are drawn {HEIGHTS} times too large, moves {MOVES} times. Below, the truss, "
         f"whose attachments give way by up to {1e3 * largest:.2f} mm.", r)


def fig19(runs, out):
    tensions(runs["truss_ga"], out, 19, "search", "inner", 1.0372, runs["truss_ga"]["form/tension_N"])


def fig20(runs, out):
    tensions(runs["truss_ga"], out, 20, "search", "boundary", 5.5898, runs["truss_ga"]["form/tension_N"])


def fig21(runs, out):
    r = runs["truss"]
    y = 1e3 * r["coupling/history/step_m"][1:]  # the first one is the displacement itself
    x = np.arange(1, len(y) + 1)
    plot = Plot("comparison of two displacements", "change of the displacements (mm)", (0, len(y) + 1), (0.1, 100),
                log_y=True)
    plot.curve(x, y, "calibrated truss", BLUE).dots(x, y, "", BLUE, 4)
    plot.level(1.0, "tof = 1 mm").upright(4, "paper: 4")
    save(out, 21, [plot], f"{r.setting}: {len(y)} comparisons, of {len(y) + 1} form-findings, until displacements "
         "change by less than 1 mm. The paper has four iterations.", r)


def fig22(runs, out):
    r, sweep = runs["truss"], runs["sweep"]
    plot = Plot("pretension Td (N)", "psi (mm)", (0, 42), (6, 1.05e3 * sweep.psi_m.max()))
    rigid = 1e3 * runs["hifdm"].get("form", "psi_m")
    plot.curve([0, 42], [rigid, rigid], "rigid supports", BLACK, dashed=True)
    order = np.argsort(sweep.pretension_N)
    x, y = sweep.pretension_N[order], 1e3 * sweep.psi_m[order]
    plot.curve(x, y, "truss, calibrated at 10 N", BLUE).dots(x, y, "", BLUE, 3.5)
    plot.dots([10], [8.38], "paper: 8.38 mm at 10 N", RED, 5)
    save(out, 22, [plot], "HIFDM on the truss at each pretension (hifdm sweep), displacements to 0.001 mm. As in the "
         "paper psi grows with the pretension. The softness of the truss is calibrated at 10 N; the other points are "
         "predictions.", r)
