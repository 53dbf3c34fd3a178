"""One function per figure of Chen et al. 2022; each draws what the program found and marks what the paper prints."""
import os

import numpy as np

from draw import BLACK, BLUE, CYAN, GREY, RED, Plot, View, figure

HEIGHTS = 20  # of the reflector in the line drawings: it is 9 cm deep and 10 m wide


def save(out, number, panels, caption, result):
    """fig02.svg and so on, with the settings in the caption and the case in the file."""
    source = "\n".join([result.setting] + [result.file[f"case/{name}"].asstr()[()] for name in ("text", "overrides")])
    figure(os.path.join(out, f"fig{number:02d}.svg"), [panel.draw() for panel in panels],
           f"As Fig. {number} of the paper. {caption[0].upper()}{caption[1:]}", source)


def shapes(result, group, found_name):
    """Theory and what was found, as Figs. 2, 5, 12 and 18 show them."""
    view = View(result.theory_m, HEIGHTS)
    view.cables(result.theory_m, result.end, "theoretical shape", BLUE, 1.0)
    view.cables(result[f"{group}/position_m"], result.end, found_name, RED, 1.3, dashed=True)
    return view.bar(2.0, result.theory_m.min(0) - [0.8, 0.8, 0])


def moved_mm(result, group, role):
    distance = np.linalg.norm(result[f"{group}/position_m"] - result.theory_m, axis=1)
    return 1e3 * distance[result.role == role].max()


def shape_caption(result, group):
    return (f"{result.setting}. The nodes inside the modules are at most "
            f"{moved_mm(result, group, 'inner'):.1f} mm from their theoretical places, those of the boundary cables "
            f"{moved_mm(result, group, 'edge'):.0f} mm. Heights are drawn {HEIGHTS} times too large.")


def fig02(runs, out):
    r = runs["fdm"]
    save(out, 2, [shapes(r, "form", "iterative FDM")], shape_caption(r, "form"), r)


def fig03(runs, out):
    r = runs["fdm"]
    inner, edge = r["form/history/inner_tension_ratio"], r["form/history/boundary_tension_ratio"]
    x = np.arange(1, len(inner) + 1)
    plot = Plot("iteration", "largest / smallest tension", (0, len(x)), (0.95, 1.02 * max(inner.max(), edge.max())))
    plot.curve(x, inner, "inner cables", CYAN).curve(x, edge, "boundary cables", BLACK)
    save(out, 3, [plot], f"{r.setting}: the ratio tends to 1; {inner[-1]:.4f} and {edge[-1]:.4f} after {len(x)} "
         "iterations. The paper prints no number here.", r)


def fig04(runs, out):
    r = runs["hifdm"]
    view = View(r.theory_m, HEIGHTS)
    view.cables(r.theory_m, r.end[r.inner], "inner cables (Eq. 7: tension)", CYAN, 1.2)
    view.cables(r.theory_m, r.end[r.boundary], "boundary cables (Eq. 8: length)", BLACK, 1.6)
    view.nodes(r.theory_m[r.role == "support"], "fixed points", BLUE, 4)
    view.bar(2.0, r.theory_m.min(0) - [0.8, 0.8, 0])
    save(out, 4, [view], "The net as assumed here: 12 m x 10 m, 5 x 5 modules of 2 x 2 cells, fixed at the corners of "
         f"the modules, f = 70.6 m. The paper does not print its topology. Heights are drawn {HEIGHTS} times too "
         "large.", r)


def fig05(runs, out):
    r = runs["hifdm"]
    save(out, 5, [shapes(r, "form", "HIFDM")], shape_caption(r, "form"), r)


def at_outer_edge(result):
    """Cables of the outer edge, and inner cables that end there."""
    at = result.theory_m[:, :2]
    outer = (np.abs(at - at.min(0)) < 1e-9) | (np.abs(at - at.max(0)) < 1e-9)
    sides = outer[result.end]
    return np.where(result.boundary, sides.all(1).any(1), sides.any((1, 2)))


def tension_plot(result, group, kind, paper_ratio, before=None):
    """Tension of each cable, in the order of the scene; the paper's ratio as the level it would reach here."""
    pick = result.inner if kind == "inner" else result.boundary
    tension, index = result[f"{group}/tension_N"][pick], np.arange(1, pick.sum() + 1)
    marked = at_outer_edge(result)[pick]
    level = paper_ratio * tension.min()
    low, high = (0, level) if kind == "boundary" else (tension.min(), max(tension.max(), level))
    high = max(high, tension.max(), *([] if before is None else [before[pick].max()]))
    margin = 0.15 * (high - low)
    plot = Plot(f"{kind} cable", "tension (N)", (0, len(index) + 1), (low - (low > 0) * margin, high + margin))
    if before is not None:
        plot.dots(index, before[pick], "before the GA", GREY, 3.8)
    near, far = ("end at the outer edge", "others") if kind == "inner" else ("outer edge", "between modules")
    plot.dots(index[marked], tension[marked], near, RED)
    plot.dots(index[~marked], tension[~marked], far, BLUE)
    plot.level(level, f"the paper's ratio {paper_ratio:g}, from our smallest tension")
    return plot, (f"Between {tension.min():.4f} and {tension.max():.4f} N, ratio {tension.max() / tension.min():.4f}; "
                  f"the paper prints {paper_ratio:g}.")


def tensions(runs, out, number, group, kind, paper_ratio, before=None):
    plot, words = tension_plot(runs, group, kind, paper_ratio, before)
    save(out, number, [plot], f"{runs.setting}. {words}", runs)


def fig06(runs, out):
    tensions(runs["hifdm"], out, 6, "form", "inner", 1.0011)


def fig07(runs, out):
    tensions(runs["hifdm"], out, 7, "form", "boundary", 4.8445)


def fig08(runs, out):
    r = runs["hifdm"]
    y = r["form/history/inner_tension_ratio"]
    x = np.arange(1, len(y) + 1)
    plot = Plot("iteration", "largest / smallest inner tension", (0, len(x)), (0.95, 1.05 * y.max()))
    plot.curve(x, y, "inner cables", CYAN).level(1.0011, "paper: 1.0011", above=False)
    save(out, 8, [plot], f"{r.setting}: {y[-1]:.4f} after {len(x)} iterations.", r)


def fig09(runs, out):
    r, limit = runs["hifdm"], runs["limit"]
    y = 1e3 * r["form/history/psi_m"]
    x = np.arange(1, len(y) + 1)
    plot = Plot("iteration", "psi (mm)", (0, len(x)), (1, 200), log_y=True)
    plot.curve(x, y, "psi, Eq. 10", BLUE).level(6.6, "paper: 6.6 mm")
    psi = 1e3 * limit.get("form", "psi_m")
    plot.curve([0, len(x)], [psi, psi], "limit for infinitely many iterations", GREY, dashed=True)
    save(out, 9, [plot], f"{r.setting}: {y[-1]:.4f} mm after {len(x)} iterations, which the focal length is calibrated "
         "to. That is a plateau: with tensions in the straight chains that grow without end, psi tends to "
         f"{psi:.4f} mm.", r)


def fig10(runs, out):
    r, exact = runs["seeded"], runs["ga"]
    series = [(1e3 * r[f"ga/{word}_psi_m"], word, colour) for word, colour in
              (("worst", GREY), ("mean", BLUE), ("best", BLACK))]
    best, found, lm = (1e3 * v for v in (r["ga/best_psi_m"], exact["ga/best_psi_m"], exact.get("polish", "psi_m")))
    base, n = 1e3 * r.get("ga", "base_psi_m"), len(best)
    whole = Plot("generation", "psi (mm)", (0, n), (4, 1.05 * series[0][0].max()), 300, "population")
    for y, name, colour in series:
        whole.curve(np.arange(1, n + 1), y, name, colour)
    whole.level(6.6, "paper, before: 6.6 mm").level(4.3, "paper, after: 4.3 mm")
    near = Plot("generation", "psi (mm)", (0, n), (lm - 0.02, max(best[0], found[0]) + 0.02), 300, "best")
    near.curve(np.arange(1, n + 1), best, "at the paper's stop", BLACK)
    near.curve(np.arange(1, n + 1), found, "at equilibrium", CYAN)
    near.curve([0, n], [lm, lm], "Levenberg-Marquardt, at equilibrium", RED, dashed=True)
    save(out, 10, [whole, near], f"{r.setting}; 50 individuals, boundary pretensions within 1 N of those after "
         f"form-finding. psi falls from {base:.4f} to {best[-1]:.4f} mm. With every individual at equilibrium: "
         f"{found[-1]:.4f} mm, and {lm:.4f} mm is the optimum that Levenberg-Marquardt reaches within the same bounds; "
         "nothing found within 1 N comes near the 4.3 mm of the paper.", r)


def fig11(runs, out):
    r = runs["seeded"]
    gain = -1e3 * np.diff(r["ga/best_psi_m"])
    x = np.flatnonzero(gain > 0) + 2
    plot = Plot("generation", "fall of the best psi (mm)", (0, len(gain) + 1), (1e-8, 1), log_y=True)
    plot.dots(x, gain[x - 2], "best psi, from one generation to the next", BLUE)
    plot.level(1e-3, "tol = 0.001 mm").upright(282, "paper: stall from 282")
    save(out, 11, [plot], f"{r.setting}. {len(gain) - len(x)} of {len(gain)} generations bring nothing and are not "
         f"drawn; the last fall by more than 0.001 mm is in generation {last_fall(r)}.", r)


def last_fall(result):
    """Generation, counted from 1, of the last fall of the best psi by more than the paper's tol."""
    return int(np.flatnonzero(-np.diff(result["ga/best_psi_m"]) > 1e-6).max()) + 2


def fig12(runs, out):
    r = runs["seeded"]
    save(out, 12, [shapes(r, "ga/best", "optimised")], shape_caption(r, "ga/best"), r)


def fig13(runs, out):
    r = runs["seeded"]
    tensions(r, out, 13, "ga/best", "inner", 1.001, r["form/tension_N"])


def fig14(runs, out):
    r = runs["seeded"]
    tensions(r, out, 14, "ga/best", "boundary", 5.608, r["form/tension_N"])
