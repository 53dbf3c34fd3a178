"""One function per figure of Chen et al. 2022. Each draws the results of the program and marks the numbers of the
paper."""
import os

import numpy as np

from draw import BLACK, BLUE, CYAN, GREY, RED, Plot, View, figure

HEIGHTS = 4  # factor of heights in the line drawings: the reflector is 38 cm deep and 10 m wide
MOVES = 20  # factor of the deviations from the target positions in Figs. 5, 12 and 18


def save(out, number, panels, caption, result):
    """Writes fig02.svg and so on, with the settings in the caption and the case in the file."""
    source = "\n".join([result.setting] + [result.file[f"case/{name}"].asstr()[()] for name in ("text", "overrides")])
    figure(os.path.join(out, f"fig{number:02d}.svg"), [panel.draw() for panel in panels],
           f"As Fig. {number} of the paper. {caption[0].upper()}{caption[1:]}", source)


def shapes(result, group, found_name, moves=MOVES):
    """Draws the target shape and the found shape, as Figs. 2, 5, 12 and 18 do. Deviations are drawn `moves` times too
    large."""
    shown = result.target_m + moves * (result[f"{group}/position_m"] - result.target_m)
    view = View(np.vstack([result.target_m, shown]), HEIGHTS)
    view.cables(result.target_m, result.end, "theoretical shape", BLUE, 1.0)
    view.cables(shown, result.end, found_name, RED, 1.3, dashed=True)
    return view.bar(2.0, result.target_m.min(0) - [0.8, 0.8, 0])


def moved_mm(result, group, role):
    distance = np.linalg.norm(result[f"{group}/position_m"] - result.target_m, axis=1)
    return 1e3 * distance[result.role == role].max()


def shape_caption(result, group, moves=MOVES):
    shown = f", deviations from theory {moves} times" if moves != 1 else ""
    return (f"{result.setting}. The inner nodes are at most {moved_mm(result, group, 'inner'):.1f} mm from their "
            f"theoretical places, those of the edge {moved_mm(result, group, 'edge'):.1f} mm. Heights are drawn "
            f"{HEIGHTS} times too large{shown}.")


def fig02(runs, out):
    r = runs["fdm"]
    save(out, 2, [shapes(r, "form", "first step", 1)], shape_caption(r, "form", 1) + " Further steps let the "
         "edge collapse: its cables do not hold the pull of the net at the same tension.", r)


def fig03(runs, out):
    r = runs["fdm"]
    tension = r["form/tension_N"]
    inner, edge = (tension[pick].max() / tension[pick].min() for pick in (r.inner, r.boundary))
    plot = Plot("iteration", "largest / smallest tension", (0, 2), (0.95, 1.1 * max(inner, edge)))
    plot.dots([1], [inner], "inner cables", CYAN, 5).dots([1], [edge], "boundary cables", BLACK, 5)
    save(out, 3, [plot], f"{r.setting}: {inner:.4f} inside and {edge:.4f} on the boundary. The paper's net holds at "
         "equal tensions, and its ratio tends to 1; ours collapses in the steps that follow.", r)


def fig04(runs, out):
    r = runs["hifdm"]
    view = View(r.target_m, HEIGHTS)
    view.cables(r.target_m, r.end[r.inner], "inner cables (Eq. 7: tension)", CYAN, 1.2)
    view.cables(r.target_m, r.end[r.boundary], "boundary cables (Eq. 8: length)", BLACK, 1.6)
    view.nodes(r.target_m[r.role == "support"], "fixed points", BLUE, 4)
    view.bar(2.0, r.target_m.min(0) - [0.8, 0.8, 0])
    save(out, 4, [view], "The net that the search found: 12 m x 10 m, 11 x 2 modules of 2 x 1 cells, diagonals; edges "
         "that hang on ties at the corners of the modules. The paper does not print its topology. Heights are drawn "
         f"{HEIGHTS} times too large.", r)


def fig05(runs, out):
    r = runs["hifdm"]
    save(out, 5, [shapes(r, "form", "HIFDM")], shape_caption(r, "form"), r)


def ties_and_ends(result):
    """Returns a mask of edge ties, and of inner cables that end at the edge."""
    role = result.role[result.end]
    return np.where(result.boundary, (role == "support").any(1), (role == "edge").any(1))


def tension_plot(result, group, kind, paper_ratio, before=None):
    """Draws the tension of each cable in the order of the scene. A level shows the tension at which the paper's ratio
    would be reached."""
    pick = result.inner if kind == "inner" else result.boundary
    tension, index = result[f"{group}/tension_N"][pick], np.arange(1, pick.sum() + 1)
    marked = ties_and_ends(result)[pick]
    level = paper_ratio * tension.min()
    low, high = (0, level) if kind == "boundary" else (tension.min(), max(tension.max(), level))
    high = max(high, tension.max(), *([] if before is None else [before[pick].max()]))
    margin = 0.15 * (high - low)
    plot = Plot(f"{kind} cable", "tension (N)", (0, len(index) + 1), (low - (low > 0) * margin, high + margin))
    if before is not None:
        plot.dots(index, before[pick], "before the GA", GREY, 3.8)
    near, far = ("end at the edge", "others") if kind == "inner" else ("edge ties", "edge")
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
    r, stopped = runs["hifdm"], runs["stopped"]
    y, short = r["form/history/inner_tension_ratio"], stopped["form/history/inner_tension_ratio"]
    x = np.arange(1, len(y) + 1)
    plot = Plot("iteration", "largest / smallest inner tension", (0, 300), (0.98, 1.05 * y.max()))
    plot.curve(x[:300], y[:300], "inner cables", CYAN).level(1.0011, "paper: 1.0011", above=False)
    plot.dots([len(short)], short[-1:], "the paper's rule stops here", RED, 4)
    save(out, 8, [plot], f"{r.setting}, the first 300 of {len(y)} iterations: {y[-1]:.4f} in the end, "
         f"{short[-1]:.4f} where the paper's rule stops, after {len(short)}.", r)


def fig09(runs, out):
    r, stopped = runs["hifdm"], runs["stopped"]
    y, short = 1e3 * r["form/history/psi_m"], 1e3 * stopped["form/history/psi_m"]
    x = np.arange(1, len(y) + 1)
    plot = Plot("iteration", "psi (mm)", (0, len(x)), (1, 100), log_y=True)
    plot.curve(x, y, "psi, Eq. 10", BLUE).level(6.6, "paper: 6.6 mm")
    plot.dots([len(short)], short[-1:], "the paper's rule stops here", RED, 4)
    save(out, 9, [plot], f"{r.setting}: {y[-1]:.4f} mm after {len(x)} iterations, which is calibrated. The paper's "
         f"rule stops after {len(short)}, at {short[-1]:.4f} mm.", r)


def fig10(runs, out):
    r, stopped = runs["ga"], runs["seeded"]
    series = [(1e3 * r[f"search/population/{word}_psi_m"], word, colour) for word, colour in
              (("worst", GREY), ("mean", BLUE), ("best", BLACK))]
    best, literal = (1e3 * run["search/population/best_psi_m"] for run in (r, stopped))
    base, lm, n = 1e3 * r.get("search", "initial_psi_m"), 1e3 * r.get("refine", "psi_m"), len(best)
    top = 1.05 * max(y.max() for y, _, _ in series)
    whole = Plot("generation", "psi (mm)", (0, n), (4, top), 300, "population")
    for y, name, colour in series:
        whole.curve(np.arange(1, n + 1), y, name, colour)
    whole.level(6.6, "paper, before: 6.6 mm").level(4.3, "paper, after: 4.3 mm")
    near = Plot("generation", "psi (mm)", (0, n), (4, max(best[0], literal[0]) + 0.2), 300, "best")
    near.curve(np.arange(1, n + 1), best, "at equilibrium", BLACK)
    near.curve(np.arange(1, len(literal) + 1), literal, "at the paper's stop", CYAN)
    near.curve([0, n], [lm, lm], "Levenberg-Marquardt", RED, dashed=True).level(4.3, "paper: 4.3 mm")
    save(out, 10, [whole, near], f"{r.setting}; 50 individuals, boundary pretensions within 1 N of those after "
         f"form-finding. psi falls from {base:.4f} to {best[-1]:.4f} mm, by {100 * (1 - best[-1] / base):.1f} % (the "
         f"paper: 34.8 %); focal length, scallop and tie are calibrated to 6.6 and 4.3 mm. {lm:.4f} mm is the optimum "
         "that Levenberg-Marquardt reaches within the same bounds.", r)


def fig11(runs, out):
    r = runs["ga"]
    gain = -1e3 * np.diff(r["search/population/best_psi_m"])
    x = np.flatnonzero(gain > 0) + 2
    plot = Plot("generation", "fall of the best psi (mm)", (0, len(gain) + 1), (1e-8, 1), log_y=True)
    plot.dots(x, gain[x - 2], "best psi, from one generation to the next", BLUE)
    plot.level(1e-3, "tol = 0.001 mm").upright(282, "paper: stall from 282")
    save(out, 11, [plot], f"{r.setting}. {len(gain) - len(x)} of {len(gain)} generations bring nothing and are not "
         f"drawn; the last fall by more than 0.001 mm is in generation {last_fall(r)}.", r)


def last_fall(result):
    """Returns the generation, counted from 1, in which the best psi last fell by more than the paper's tol."""
    return int(np.flatnonzero(-np.diff(result["search/population/best_psi_m"]) > 1e-6).max()) + 2


def fig12(runs, out):
    r = runs["ga"]
    save(out, 12, [shapes(r, "search", "optimised")], shape_caption(r, "search"), r)


def fig13(runs, out):
    r = runs["ga"]
    tensions(r, out, 13, "search", "inner", 1.001, r["form/tension_N"])


def fig14(runs, out):
    r = runs["ga"]
    tensions(r, out, 14, "search", "boundary", 5.608, r["form/tension_N"])
