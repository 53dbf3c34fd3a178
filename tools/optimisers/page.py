#!/usr/bin/env python3
"""Writes optimisers.html from optimisers.csv and optimisers_runs.csv of a folder: `page.py FOLDER`.

The page shows the running times of all optimisers (running_times.py), as in COCO. It needs no other files."""
import csv
import sys
from html import escape
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
import svg  # noqa: E402
from running_times import LIMIT, mean_share, read_times  # noqa: E402

OURS, OUR_CHAIN = "ours", "ours (variation chain)"
CONSTRAINT = "pagmo cstrs "
TABLE_PERCENT = "10", "1", "0.1", "0.01"
FIRST = 10  # evaluations at the left end of the axes
GRID = [FIRST * (LIMIT / FIRST) ** (i / 160) for i in range(161)]
COLOURS = [("#0072b2", "#5ab4f0"), ("#007a5a", "#3fc79b"), ("#a8488a", "#e38fc6"), ("#8a6100", "#e0b040"),
           ("#555555", "#b5b5b5"), ("#5b4bb5", "#a99cff"), ("#00707f", "#4fc3d0")]  # light, dark
STYLE = """
:root { color-scheme: light dark; --back: #fff; --ink: #1c1c1c; --grid: #ddd; --faint: #b4b4b4; --ours: #c04e00; LIGHT }
@media (prefers-color-scheme: dark) {
  :root { --back: #16181b; --ink: #e6e6e6; --grid: #3a3d42; --faint: #6a6e75; --ours: #ff9a4d; DARK }
}
body { background: var(--back); color: var(--ink); font: 15px/1.45 Helvetica, Arial, sans-serif; margin: 24px auto;
  max-width: 1020px; padding: 0 16px; }
h1 { font-size: 24px; } h2 { font-size: 19px; margin: 32px 0 8px; } h3 { font-size: 13px; margin: 0 0 2px; }
svg { display: block; max-width: 100%; height: auto; }
svg text { fill: var(--ink); } svg line { stroke: var(--grid); }
svg path { fill: none; stroke: currentColor; stroke-width: 1.5; } svg path.dash { stroke-dasharray: 5 3; }
svg g.label text, svg g.label line { fill: currentColor; stroke: none; } svg g.label line { stroke: currentColor; }
svg g.ours { color: var(--ours); } svg g.ours path { stroke-width: 3.5; } svg g.ours text { font-weight: bold; }
svg g.our-chain { color: var(--ours); } svg g.faint { color: var(--faint); } svg g.faint path { stroke-width: 1; }
svg g.peer path { stroke-width: 2; }
.panels { display: flex; flex-wrap: wrap; gap: 18px 12px; } .panels figure { margin: 0; width: 330px; }
.scroll { overflow-x: auto; } table { border-collapse: collapse; font-size: 13px; }
tbody th { min-width: 130px; }
th, td { border-bottom: 1px solid var(--grid); padding: 3px 6px; text-align: left; vertical-align: top; }
td.number { text-align: right; } .best { font-weight: bold; }
td.ours { color: var(--ours); } thead th { vertical-align: bottom; }
"""


def style():
    themes = [" ".join(f"--c{i}: {pair[theme]};" for i, pair in enumerate(COLOURS)) for theme in (0, 1)]
    rules = "\n".join(f"svg g.c{i} {{ color: var(--c{i}); }}" for i in range(len(COLOURS)))
    return STYLE.replace("LIGHT", themes[0]).replace("DARK", themes[1]) + rules + "\n"


def base_of(name):
    return "pagmo " + name[len(CONSTRAINT):] if name.startswith(CONSTRAINT) else name


def label_of(key):
    name, variables = key
    if name == OUR_CHAIN:
        return "ours, variation chain"
    words = base_of(name).replace("differential evolution", "DE")
    return words + (", chains" if variables == "chain" else "") + (
        ", constraint" if name.startswith(CONSTRAINT) else "")


def curves_of(nets):
    """nets: {(optimiser, variables): Times} of each net. Returns {base: (key, mean share at each of GRID)}. Of the
    variants of an optimiser, the key is that with the largest area below its curve. If a net has no chains, its variant
    `chain` is `gene`."""
    best = {}
    for key in {key: None for net in nets for key in net}:
        several = [net.get(key) or net.get((key[0], "gene")) for net in nets]
        if None in several:
            continue
        shares = [mean_share(several, x) for x in GRID]
        base = base_of(key[0])
        if base not in best or sum(shares) > sum(best[base][1]):
            best[base] = key, shares
    return best


def draw_curve(axes, shares, group, dash=False):
    path = axes.curve(list(zip(GRID, shares)))
    return f'<g class="{group}"><path{" class=" + chr(34) + "dash" + chr(34) if dash else ""} d="{path}"/></g>'


def draw_labels(axes, labels, size):
    """labels: (words, share at the right end, group). Labels that would overlap are moved apart."""
    right, out = axes.left + axes.w, []
    ends = [axes.at(LIMIT, share)[1] for _, share, _ in labels]
    places = svg.spread(ends, size + 2, axes.top + 2, axes.top + axes.h)
    for (words, _, group), end, y in zip(labels, ends, places):
        out.append(f'<g class="label {group}">{svg.line(right + 1, end, right + 16, y)}'
                   f'{svg.text(right + 20, y + size / 3, words, size, "start")}</g>')
    return out


def image(w, h, body, words):
    return (f'<svg viewBox="0 0 {w} {h}" width="{w}" height="{h}" role="img" aria-label="{escape(words)}">\n'
            + "\n".join(body) + "\n</svg>")


def large_panel(nets, styles, words):
    axes, curves = svg.ShareAxes(980, 440, FIRST, LIMIT, 240), curves_of(nets)
    body = axes.frame("evaluations", "share of targets reached", (10, 100, 1000, 5000, 20000))
    labels = []
    for base in sorted(curves, key=lambda base: base == OURS):  # ours last, above all others
        key, shares = curves[base]
        group, dash = styles[base]
        body.append(draw_curve(axes, shares, group, dash))
        labels.append((f"{label_of(key)}  {100 * shares[-1]:.0f} %", shares[-1], group))
    return image(980, 440, body + draw_labels(axes, labels, 12), words)


def small_panel(net, words):
    axes, curves = svg.ShareAxes(330, 210, FIRST, LIMIT, 104), curves_of([net])
    peers = sorted((base for base in curves if base not in (OURS, OUR_CHAIN)), key=lambda base: sum(curves[base][1]))
    body = axes.frame("evaluations", "targets reached", (10, 100, 1000, 20000))
    labels = []
    for base in [*peers, *(base for base in (OURS,) if base in curves)]:
        key, shares = curves[base]
        group = "ours" if base == OURS else "peer c0" if base == peers[-1] else "faint"
        body.append(draw_curve(axes, shares, group))
        if group != "faint":
            labels.append((label_of(key), shares[-1], group))
    return image(330, 210, body + draw_labels(axes, labels, 11), words)


def best_peer(net, percent):
    """Returns (ERT, key) of the optimiser other than ours with the smallest ERT; None if none reaches the target."""
    found = [(times.ert[percent], key) for key, times in net.items()
             if key[0] not in (OURS, OUR_CHAIN) and times.successes.get(percent)]
    return min(found) if found else None


def cells(net, percent):
    mine, peer = net.get((OURS, "gene")), best_peer(net, percent)
    words = ["not reached", "not reached"]
    if mine and mine.successes.get(percent):
        words[0] = f"{mine.ert[percent]:.0f}" + some(mine, percent)
    if peer:
        words[1] = f"{peer[0]:.0f}" + some(net[peer[1]], percent)
    ert = mine.ert[percent] if mine and mine.successes.get(percent) else float("inf")
    mine_is_best, peer_is_best = bool(ert < float("inf")) and (not peer or ert <= peer[0]), peer and peer[0] <= ert
    name = f"<br>{escape(label_of(peer[1]))}" if peer else ""
    return (f'<td class="number ours{" best" if mine_is_best else ""}">{words[0]}</td>'
            f'<td class="number{" best" if peer_is_best else ""}">{words[1]}{name}</td>')


def some(times, percent):
    """Returns the share of seeds if not all of them reach the target."""
    n = times.successes[percent]
    return f" ({n}/{times.seeds})" if n < times.seeds else ""


def table(nets, stars):
    groups = "".join(f'<th colspan="2" scope="colgroup">{percent} %</th>' for percent in TABLE_PERCENT)
    kinds = '<th scope="col">ours</th><th scope="col">best other</th>' * len(TABLE_PERCENT)
    rows = []
    for name, net in nets.items():
        psi_mm, of = stars[name]
        rows.append(f'<tr><th scope="row">{escape(name)}</th><td class="number">{float(psi_mm):.6g} mm<br>'
                    f'{escape(of.replace(" (gene)", ""))}</td>'
                    f'{"".join(cells(net, percent) for percent in TABLE_PERCENT)}</tr>')
    return ('<div class="scroll"><table><thead><tr><th rowspan="2" scope="col">net</th>'
            f'<th rowspan="2" scope="col">psi*, found by</th>{groups}</tr><tr>{kinds}</tr></thead><tbody>\n'
            + "\n".join(rows) + "\n</tbody></table></div>")


def write(folder):
    """Writes the page of the files in the folder."""
    nets = read_times(folder / "optimisers_runs.csv")
    with open(folder / "optimisers.csv", encoding="utf-8", newline="") as file:
        stars = {row["net"]: (row["psi_star_mm"], row["psi_star_of"]) for row in csv.DictReader(file)}
    bases = sorted({base_of(key[0]) for net in nets.values() for key in net} - {OURS, OUR_CHAIN})
    n = len(COLOURS)
    styles = {base: (f"c{i % n}", i >= n) for i, base in enumerate(bases)}
    styles |= {OURS: ("ours", False), OUR_CHAIN: ("our-chain", True)}
    large = ""
    for title, of in (("Nets without a cap", [name for name in nets if ", cap " not in name]),
                      ("Nets with a cap on the boundary tension ratio", [name for name in nets if ", cap " in name])):
        if of:
            title += f" ({len(of)})"
            large += f"<h2>{title}</h2>\n{large_panel([nets[name] for name in of], styles, title)}\n"
    small = "\n".join(f"<figure><h3>{escape(name)}</h3>{small_panel(net, name)}</figure>" for name, net in nets.items())
    seeds = sorted({times.seeds for net in nets.values() for key, times in net.items() if key == (OURS, "gene")})
    (folder / "optimisers.html").write_text(f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Optimisers: expected running times</title><style>{style()}</style></head><body>
<h1>The genetic algorithm of hifdm and other optimisers</h1>
<p>Each line shows the share of targets that an optimiser has reached after a number of evaluations. A line that is
higher or further to the left is better. The targets are 100 % to 10<sup>-6</sup> % above psi*, five to a decade. psi*
of a net is the minimum surface error that any optimiser has found inside the limits. The shares are means over seeds
({escape(" or ".join(map(str, seeds)))} seeds) and nets. Ours is the thick line.</p>
<p>The other optimisers have several variants: one variable per cable, one per chain of boundary cables ("chains"), and
for pagmo also the cap as a constraint ("constraint"). A line is that of the variant with the largest area below it.
This choice favours the other optimisers. The command <code>make bench-optimisers</code> writes this page.</p>
{large}<h2>Each net</h2>
<p>The blue line is the other optimiser with the largest area below its line. The grey lines are the rest.</p>
<div class="panels">
{small}
</div>
<h2>Expected running time</h2>
<p>The table has the expected number of evaluations until psi is at most 10, 1, 0.1 and 0.01 % above psi*. This is the
number of evaluations of all seeds, divided by the number of seeds that reach the target. (3/7): only 3 of 7 seeds reach
it. BOBYQA has no seeds, so it has one run. The smaller number is bold. Levenberg-Marquardt is not
in the comparison, because it uses derivatives. <code>optimisers.csv</code> has its form-findings.</p>
{table(nets, stars)}
</body></html>
""", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: page.py FOLDER")
    write(Path(sys.argv[1]))
