#!/usr/bin/env python3
"""Searches for the net of the paper: patterns, modules, cells, supports, ties and spacings, each with the focal length
and the scallop that give the paper's 6.6 mm and 4.8445. `hifdm sweep` solves every scene.

    search.py --program build/hifdm --work build/search      # writes the two studies configs/chen2022-search*.yaml

1. A grid of focal lengths and scallops for every net.
2. Newton's method on both from each crossing of the grid.
3. The genetic algorithm, 50 x 400 within 1 N, on all nets that give both figures.
4. The best nets on a truss, whose stiffness is calibrated to 8.38 mm.

`make paper` runs the two studies and writes results/chen2022/search.md."""
import argparse
import itertools
import math
import os
import textwrap

import h5py
import numpy as np

from runs import NET, ROOT, SEARCH, SEARCH_TRUSS, TRUSS, Runs

KEY = "scene.parabolic_cylinder."
PSI_M, RATIO, GA_PSI_M, GA_RATIO, TRUSS_PSI_M = 6.6e-3, 4.8445, 4.3e-3, 5.608, 8.38e-3
FOCAL_M = [8, 11, 15, 21, 30, 45, 70, 110, 180, 300, 500]
SCALLOP = [0.05, 0.07, 0.09, 0.115, 0.14, 0.16, 0.17, 0.175, 0.18, 0.19]
KEPT = 24
# Nets that another search has found, at the paper's stop, with their focal lengths and scallops.
KNOWN = [("triangle", "module_corners", [3, 3], [1, 2], "equal_arc", 0.1, 458.924208982529, 0.113401206248162),
         ("triangle", "ribs", [1, 2], [6, 2], "equal_arc", 0.15, 242.244555706559, 0.0758665519960033),
         ("alternating", "ribs", [1, 5], [6, 2], "equal_arc", 0.1, 154.09689404534, 0.0524282744218751)]


def nets():
    """Yields pattern, supports, modules, cells, spacing and tie of every net of the search."""
    both = ("triangle", "alternating")
    for pattern, my, cells, tie in itertools.product(both, range(2, 6), ([2, 2], [4, 2], [6, 2]), (0.1, 0.15, 0.2)):
        yield pattern, "ribs", [1, my], cells, "equal_arc", tie
    for pattern, mx, my, cells, tie in itertools.product((*both, "quad"), range(2, 7), range(2, 6),
                                                         ([2, 1], [1, 2], [3, 2]), (0.06, 0.1, 0.15, 0.4)):
        yield pattern, "module_corners", [mx, my], cells, "equal_arc", tie
    for spacing, mx, my, tie in itertools.product(("equal_arc", "equal_projected"), range(4, 14), (1, 2, 3),
                                                  (0.1, 0.14, 0.18, 0.2, 0.22, 0.24, 0.26, 0.28, 0.3)):
        yield "triangle", "module_corners", [mx, my], [2, 1], spacing, tie


def scene(net, focal_length_m, scallop):
    names = ("pattern", "supports", "modules", "cells_per_module", "spacing", "edge_tie_m")
    return dict(zip([KEY + name for name in names], net)) | {
        KEY + "focal_length_m": f"{focal_length_m:.15g}", KEY + "scallop": f"{scallop:.15g}"}


def fits(net, scallop):
    """Returns true if the scallops end well before the next nodes."""
    pattern, _, modules, cells, _, _ = net
    size, share = (10, 12), 0.8
    spans, pitch = [size[k] / modules[k] for k in (0, 1)], [size[k] / modules[k] / cells[k] for k in (0, 1)]
    return all(cells[k] == 1 or scallop * spans[k] < share * pitch[1 - k] for k in (0, 1))


def write_study(path, base, points, head=""):
    with open(path, "w") as file:
        file.write(f"{head}base: {os.path.relpath(base, os.path.dirname(path))}\n\nsweep:\n  combine: zip\n"
                   "  files: none\n")
        for key in points[0]:
            file.write(textwrap.fill(f"{key}: [{', '.join(str(point[key]) for point in points)}]", 118,
                                     initial_indent="  ", subsequent_indent="    ") + "\n")


def solve(runs, name, base, points, **more):
    """Returns the columns of the merged table, one row per point; NaN if a point failed."""
    study, merged = os.path.join(runs.work, name + ".yaml"), os.path.join(runs.work, name + ".h5")
    write_study(study, base, [point | more for point in points])
    runs.sweep(study, merged, allowed=(0, 3))
    return columns(merged)


def columns(path):
    with h5py.File(path, "r") as file:
        points, out = file["points"], {}
        points.visititems(lambda name, item: out.update({name: item[:]}) if isinstance(item, h5py.Dataset) else None)
        failed = out["status"] != 0
        for name, values in out.items():
            if values.dtype.kind == "f" and not name.startswith("input/"):
                values[failed] = np.nan
        return out


def errors(table):
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.column_stack([np.log(table["form/psi_m"] / PSI_M),
                                np.log(table["form/boundary_tension_ratio"] / RATIO)])


def crossings(net, psi, ratio):
    """Finds where both errors change sign on the grid [focal length][scallop], or where the ratio has a minimum and is
    nearly right."""
    f, r = np.full(len(SCALLOP), np.nan), np.full(len(SCALLOP), np.nan)
    for k, j in itertools.product(range(len(SCALLOP)), reversed(range(len(FOCAL_M) - 1))):
        a, b = psi[j, k], psi[j + 1, k]
        if np.isfinite([a, b, ratio[j, k], ratio[j + 1, k]]).all() and a * b <= 0 and a != b:
            t = a / (a - b)
            f[k], r[k] = (1 - t) * math.log(FOCAL_M[j]) + t * math.log(FOCAL_M[j + 1]), \
                (1 - t) * ratio[j, k] + t * ratio[j + 1, k]
    for k in range(1, len(SCALLOP) - 1):
        if 0 < r[k] < 0.05 and r[k] <= r[k - 1] and r[k] <= r[k + 1]:
            yield net, math.exp(f[k]), SCALLOP[k]
    for k in range(len(SCALLOP) - 1):
        if np.isfinite(r[k:k + 2]).all() and r[k] * r[k + 1] <= 0 and r[k] != r[k + 1]:
            t = r[k] / (r[k] - r[k + 1])
            yield net, math.exp((1 - t) * f[k] + t * f[k + 1]), (1 - t) * SCALLOP[k] + t * SCALLOP[k + 1]


def newton(runs, found, rounds=4, step=1.004):
    """Returns focal length and scallop of each net for which psi and the ratio are those of the paper, if Newton's
    method converges."""
    done = {}
    for k in range(rounds):
        found = list({str(scene(n, round(f, 2), round(s, 4))): (n, f, s) for n, f, s in found
                      if fits(n, s * step)}.values())
        table = solve(runs, f"newton{k}", runs.form, [scene(net, *at) for net, f, s in found
                                                      for at in ((f, s), (f * step, s), (f, s * step))])
        error, following = errors(table), []
        for i, (net, f, s) in enumerate(found):
            at, df, ds = error[3 * i:3 * i + 3]
            if not np.isfinite([at, df, ds]).all():
                continue
            if abs(math.expm1(at[0])) < 0.002 and abs(math.expm1(at[1])) < 0.008:
                done[str(scene(net, round(f), round(s, 3)))] = (net, float(f"{f:.4g}"), round(s, 4))
            slope = np.column_stack([df - at, ds - at]) / math.log(step)
            if abs(np.linalg.det(slope)) > 1e-9:
                move = np.clip(-np.linalg.solve(slope, at), -0.15, 0.15)
                following.append((net, f * math.exp(move[0]), s * math.exp(move[1])))
        found = following
    return list({str(scene(*x)): x for x in done.values()}.values())


def misfit(psi_m, ratio, focal_length_m):
    """Returns the misfit that the calibration leaves: psi and ratio after the genetic algorithm, and the depth."""
    return (max(abs(psi_m - GA_PSI_M) / 0.1e-3 - 1, 0) + abs(math.log(ratio / GA_RATIO)) / 0.05
            + max(math.log(focal_length_m / 10), 0))


def soften(runs, points, rounds=6, step=1.02):
    """Returns Young's modulus of the truss of each point for which psi is the paper's 8.38 mm; NaN if none is found."""
    E = np.full(len(points), 1e11)
    for k in range(rounds):
        table = solve(runs, f"truss{k}", TRUSS, [point | {"truss.E_Pa": f"{e * h:.4g}"}
                                                 for point, e in zip(points, E) for h in (1, step)])
        psi = table["form/psi_m"].reshape(-1, 2)
        slope = np.log(psi[:, 1] / psi[:, 0]) / math.log(step)
        move = np.where(slope < -1e-6, -np.log(psi[:, 0] / TRUSS_PSI_M) / slope, np.nan)
        E = np.where(np.isfinite(move), E * np.exp(np.clip(move, -1, 1)), E)
    return [float(f"{e:.4g}") if abs(p / TRUSS_PSI_M - 1) < 2e-3 else None for e, p in zip(E, psi[:, 0])]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True, help="folder for studies and their results")
    a = parser.parse_args()
    runs = Runs(a.program, a.work)
    runs.form = runs.case("form", NET, drop=["optimize"],
                          form={"method": "newton", "pretension_N": 10, "residual_tolerance": 1e-8})
    every = list({str(net): net for net in nets()}.values())
    grid = [(i, j, k) for i, net in enumerate(every) for j in range(len(FOCAL_M)) for k, s in enumerate(SCALLOP)
            if fits(net, s)]
    error = np.full((2, len(every), len(FOCAL_M), len(SCALLOP)), np.nan)
    table = solve(runs, "grid", runs.form, [scene(every[i], FOCAL_M[j], SCALLOP[k]) for i, j, k in grid])
    error[(slice(None), *np.transpose(grid))] = errors(table).T
    found = newton(runs, [x for i, net in enumerate(every) for x in crossings(net, *error[:, i])])
    table = solve(runs, "ga", NET, [scene(*x) for x in found], **{"optimize.seed": 2022,
                                                                  "optimize.compare_lm": "false"})
    rank = [misfit(psi, ratio, x[1]) if np.isfinite(psi) else np.inf
            for psi, ratio, x in zip(table["search/psi_m"], table["search/boundary_tension_ratio"], found)]
    best = [found[i] for i in np.argsort(rank)[:KEPT]]
    print(f"{len(every)} nets, {len(grid)} scenes; {len(found)} give {1e3 * PSI_M} mm and {RATIO}; {len(best)} kept")
    points = [scene(*x) | {"form.stop": "residual"} for x in best] + \
             [scene(net, *at) | {"form.stop": "rms_change"} for *net, f, s in KNOWN for at in [(f, s)]]
    write_study(SEARCH, NET, [point | {"optimize.seed": 2022, "optimize.compare_lm": "false"} for point in points],
                "# The nets that meet the paper's figures best, and three that another search found.\n"
                "# Written by `make paper-search`.\n")
    points = [point | {"truss.match_tolerance_m": f"{1.5 * x[0][5]:.3g}", "coupling.scheme": "plain",
                       "coupling.tof_m": "1e-3"} for point, x in zip(points, best)]
    tight = [point | {"coupling.scheme": "auto", "coupling.tof_m": "1e-6"} for point in points]
    points = [point | {"truss.E_Pa": e} for point, e in zip(points, soften(runs, tight)) if e]
    write_study(SEARCH_TRUSS, TRUSS, points,
                "# On trusses of a softness that is calibrated to psi of 8.38 mm: nets that meet the paper's figures "
                "best.\n# Written by `make paper-search`.\n")


if __name__ == "__main__":
    main()
