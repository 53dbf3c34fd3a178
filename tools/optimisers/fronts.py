#!/usr/bin/env python3
"""Compares our optimiser of fronts with NSGA-II of pagmo: `make bench-fronts`.

The fronts have two and three objectives and belong to several nets. Both optimisers have the same evaluations and the
same first 100 designs (fronts.cpp). That of pagmo also runs with one variable per chain of boundary cables. The measure
is the hypervolume of the last population: what it dominates below a corner. In each objective, the corner is the worst
value that a front has in the first population of any run, or in the best known front. The best known front is that of
all individuals of all runs. The script writes into --out:

fronts.csv  per problem, optimiser and 1000, 5000 and 20 000 evaluations: how much of the hypervolume of the best front
            is missing, in %: median, minimum and maximum over the seeds
"""

import argparse
import csv
import statistics
import subprocess
from pathlib import Path

import numpy as np

CYLINDER = "scene.parabolic_cylinder."
BUDGETS = 1000, 5000, 20000
PSI, FACETS, PULL = "{figure: psi}", "{figure: facets, feed: fixed}", "{figure: pull}"
RATIO = "{figure: ratio, set: boundary}"
TRIANGLES = ["pattern=triangle", "modules=[3, 3]", "focal_length_m=30", "optimize.range_N=2"]
PROBLEMS = {  # name: case, objectives, changes of the case; the settings were chosen on other nets than the last four
    "chen2022, psi and ratio": ("chen2022", (PSI, RATIO), []),
    "straight-edges, psi and ratio": ("straight-edges", (PSI, RATIO), []),
    "triangles 3x3, f = 30 m, psi and ratio": ("reflector", (PSI, RATIO), TRIANGLES),
    "triangles 8x2 on ties, f = 25 m, psi and ratio": (
        "reflector", (PSI, RATIO), ["pattern=triangle", "modules=[8, 2]", "cells_per_module=[2, 1]",
                                    "focal_length_m=25", "scallop=0.15", "edge_tie_m=0.2", "optimize.range_N=1"]),
    "alternating 4x3 on ties, facets and pull": (
        "reflector", (FACETS, PULL), ["pattern=alternating", "modules=[4, 3]", "edge_tie_m=0.3", "focal_length_m=40",
                                      "optimize.range_N=1"]),
    "triangles 5x3, f = 20 m, psi, ratio and pull": (
        "reflector", (PSI, RATIO, PULL), ["pattern=triangle", "focal_length_m=20", "modules=[5, 3]",
                                          "optimize.range_N=3"]),
}


def settings(objectives, changes):
    for change in ["optimize.front=[" + ", ".join(objectives) + "]", *changes]:
        yield "--set"
        yield change if change.startswith("optimize.") else CYLINDER + change


def front_of(points):
    """Returns the points that no other point dominates, in the order of their objectives."""
    points = np.unique(np.asarray(points), axis=0)
    kept = []
    for point in points:  # a point that dominates this one comes before it
        if not kept or not np.any(np.all(np.asarray(kept) <= point, axis=1)):
            kept.append(point)
    return np.asarray(kept)


def hypervolume(points, corner):
    """Returns the hypervolume of two or three objectives, by slices across the last of three."""
    points = np.asarray(points)
    points = points[np.all(points < corner, axis=1)]
    if len(points) == 0:
        return 0.0
    if points.shape[1] == 2:
        volume, low = 0.0, corner[1]
        for x, y in points[np.lexsort((points[:, 1], points[:, 0]))]:
            if y < low:
                volume += (corner[0] - x) * (low - y)
                low = y
        return volume
    points = points[np.argsort(points[:, 2])]
    tops = np.append(points[1:, 2], corner[2])
    return sum((top - point[2]) * hypervolume(points[: i + 1, :2], corner[:2])
               for i, (point, top) in enumerate(zip(points, tops)) if top > point[2])


def measure(o, case, objectives, changes):
    """Returns {(optimiser, variables, evaluations, seed): points}. Designs beyond their limits are left out."""
    run = subprocess.run([o.driver, f"{o.cases}/{case}.yaml", str(o.seeds), ",".join(map(str, BUDGETS)),
                          *settings(objectives, changes)], check=True, text=True, stdout=subprocess.PIPE,
                         stderr=subprocess.DEVNULL)
    found = {}
    for row in csv.reader(run.stdout.splitlines()):
        value = [float(word) for word in row[4:]]
        of = found.setdefault((row[0], row[1], int(row[3]), int(row[2])), [])
        if max(value) < 1e6:
            of.append(value)
    return found


def look_at(o, name, case, objectives, changes):
    found = measure(o, case, objectives, changes)
    best = front_of([point for points in found.values() for point in points])
    first = front_of([point for key, points in found.items() if key[2] == 0 for point in points])
    corner = np.maximum(best.max(axis=0), first.max(axis=0))
    least = best.min(axis=0)
    scale = corner - least

    def volume(points):
        return hypervolume((front_of(points) - least) / scale, np.ones(len(least))) if points else 0.0

    whole, missing = volume(best.tolist()), {}
    for (optimiser, variables, evaluations, _), points in found.items():
        if evaluations > 0:
            missing.setdefault((optimiser, variables, evaluations), []).append(100 * (1 - volume(points) / whole))
    print(f"{name}: {len(best)} points from {least} to {best.max(axis=0)}", flush=True)
    rows, lost = [], 0
    for budget in BUDGETS:
        mine = statistics.median(missing["ours", "gene", budget])
        for (optimiser, variables, evaluations), of in missing.items():
            if evaluations != budget:
                continue
            lost += statistics.median(of) < mine
            rows.append([name, len(objectives), optimiser, variables, budget, len(of), f"{statistics.median(of):.3g}",
                         f"{min(of):.3g}", f"{max(of):.3g}"])
            print("   ", *rows[-1][2:], flush=True)
    return rows, lost


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--driver", required=True)
    options.add_argument("--cases", default="configs")
    options.add_argument("--seeds", type=int, default=9)
    options.add_argument("--out", type=Path, required=True)
    o = options.parse_args()
    table, n_lost = [], 0
    for name, (case, objectives, changes) in PROBLEMS.items():
        rows, lost = look_at(o, name, case, objectives, changes)
        table += rows
        n_lost += lost
    with open(o.out / "fronts.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(
            [["problem", "objectives", "optimiser", "variables", "evaluations", "seeds", "missing_percent",
              "least_percent", "most_percent"], *table])
    others = sum(row[2] != "ours" for row in table)
    print(f"pagmo's is better in {n_lost} of {others} comparisons")


if __name__ == "__main__":
    main()
