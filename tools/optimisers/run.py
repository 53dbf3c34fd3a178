#!/usr/bin/env python3
"""Compares our genetic algorithm with other optimisers: `make bench-optimisers`.

Ten nets were not used in choosing the settings of optimize.variation (METHOD section 7). All optimisers have the same
number of evaluations and the same first population (peers.cpp). In addition to those of the driver there are scipy's
differential evolution, and Levenberg-Marquardt of `hifdm run`, whose evaluations are form-findings with derivatives.
psi* of a net is the minimum that any optimiser has found. The script writes into --out:

optimisers.csv       per net (psi_mm: of its initial design) and optimiser: psi above psi*, in % of psi*, after 1000,
                     5000 and 20 000 evaluations (median over seeds), and the expected running time (evaluations of all
                     seeds until the target or their end, over the number of seeds that reached it) to
                     psi* (1 + 10^-1 ... 10^-6)
optimisers_lost.csv  each budget at which another population, or BOBYQA or Levenberg-Marquardt, is better than ours
optimisers.svg       share of (net, seed, target) not reached yet, over evaluations
"""

import argparse
import csv
import json
import math
import statistics
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

sys.path.insert(0, str(Path(__file__).parents[1]))
import svg  # noqa: E402

CYLINDER = "scene.parabolic_cylinder."
BUDGETS = 1000, 5000, 20000
TARGETS = range(1, 7)
POPULATION = 50
NETS = {  # name: changes of the case
    "triangles 3x3, f = 30 m": ["pattern=triangle", "modules=[3, 3]", "focal_length_m=30", "optimize.range_N=2"],
    "diagonals 4x4, f = 60 m": ["pattern=diagonal", "modules=[4, 4]", "focal_length_m=60", "optimize.range_N=2"],
    "alternating 4x3 on ties": ["pattern=alternating", "modules=[4, 3]", "edge_tie_m=0.3", "focal_length_m=40"],
    "triangles 5x3, f = 20 m, 3 N": ["pattern=triangle", "focal_length_m=20", "modules=[5, 3]", "optimize.range_N=3"],
    "triangles 3x3 of 3x3, f = 90 m": ["pattern=triangle", "modules=[3, 3]", "cells_per_module=[3, 3]", "scallop=0.15",
                                       "focal_length_m=90", "optimize.range_N=4"],
    "triangles 3x4, deep, on ties": ["pattern=triangle", "focal_length_m=3", "modules=[3, 4]", "edge_tie_m=0.5"],
    "triangles 4x5, rule tension": ["pattern=triangle", "modules=[4, 5]", "focal_length_m=40", "optimize.rule=tension",
                                    "optimize.range_N=2"],
    "alternating 4x3 on ties, f = 80 m": ["pattern=alternating", "modules=[4, 3]", "edge_tie_m=0.2", "scallop=0.15",
                                          "focal_length_m=80", "optimize.range_N=3"],
    "quads 6x2, 6 N": ["modules=[6, 2]", "cells_per_module=[2, 3]", "optimize.range_N=6"],
    "triangles 8x2 on ties, f = 25 m": ["pattern=triangle", "modules=[8, 2]", "cells_per_module=[2, 1]",
                                        "focal_length_m=25", "scallop=0.15", "edge_tie_m=0.2"],
}


def settings(changes):
    for change in ["optimize.range_N=1", *changes]:
        yield "--set"
        yield change if change.startswith("optimize.") else CYLINDER + change


class Record:
    """The minimum of psi so far at each of `counts`."""

    def __init__(self, counts):
        self.counts, self.used, self.best_m, self.at = counts, 0, math.inf, []

    def note(self, costs):
        for cost in costs:
            if self.used == self.counts[-1]:
                return
            self.used += 1
            self.best_m = min(self.best_m, cost)
            if self.used == self.counts[len(self.at)]:
                self.at.append(self.best_m)

    def whole(self):
        return self.at + [self.best_m] * (len(self.counts) - len(self.at))


def ask(server, by_chain, n, values=b""):
    """Asks the driver. n > 0: returns costs of n designs; else the number of variables and the first designs of seed
    -n."""
    server.stdin.write(struct.pack("ii", by_chain, n) + values)
    server.stdin.flush()
    if n > 0:
        return np.frombuffer(server.stdout.read(8 * n))
    n_variable = int(np.frombuffer(server.stdout.read(8))[0])
    return np.frombuffer(server.stdout.read(8 * n_variable * POPULATION)).reshape(POPULATION, n_variable)


def evolve_scipy(server, by_chain, seed, counts):
    record = Record(counts)

    def costs(columns):
        designs = np.ascontiguousarray(columns.T)
        found = ask(server, by_chain, len(designs), designs.tobytes())
        record.note(found)
        return found

    first = np.clip(ask(server, by_chain, -seed), 0, 1)
    differential_evolution(costs, [(0, 1)] * first.shape[1], init=first, vectorized=True, updating="deferred", tol=0,
                           atol=0, polish=False, maxiter=counts[-1] // POPULATION, seed=seed)
    return record.whole()


def measure(o, changes):
    """Returns {(optimiser, variables): [psi of each seed at each of counts]}, and counts."""
    run = subprocess.run([o.driver, o.case, str(o.seeds), str(BUDGETS[-1]), *settings(changes)], check=True, text=True,
                         stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    rows = list(csv.reader(run.stdout.splitlines()))
    counts = [int(word) for word in rows[0][3:]]
    found = {}
    for row in rows[1:]:
        found.setdefault((row[0], row[1]), []).append([float(word) for word in row[3:]])
    server = subprocess.Popen([o.driver, o.case, "serve", *settings(changes)], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    for variables in sorted({key[1] for key in found}, reverse=True):
        found["scipy differential evolution", variables] = [
            evolve_scipy(server, variables == "chain", seed, counts) for seed in range(1, o.seeds + 1)]
    sizes = [ask(server, by_chain, 0).shape[1] for by_chain in (0, 1)]
    server.stdin.close()
    server.wait()
    return found, counts, sizes


def refine(o, changes, method, seed):
    """Returns psi and form-findings of Levenberg-Marquardt in `hifdm run` with this method, and psi of the initial
    design."""
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([o.program, "run", o.case, "-o", folder + "/r.h5", "--json", *settings(changes), "--set",
                              "optimize.method=" + method, "--seed", str(seed)], text=True, stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL)
    result = json.loads(run.stdout)
    initial = result.get("search", {}).get("initial_psi_m")
    refined = result.get("refine")
    return (refined["psi_m"], refined["evaluations"], initial) if refined and refined["psi_m"] else \
        (math.inf, 0, initial)


def running_time(rows, counts, limit_m):
    """Returns the evaluations of all seeds until the target, or until their end, over the number of those that reached
    it."""
    at = [next((count for count, value in zip(counts, row) if value <= limit_m), None) for row in rows]
    hits = sum(count is not None for count in at)
    return sum(counts[-1] if count is None else count for count in at) / hits if hits else math.inf


def is_population(key):
    return key[0].startswith(("pagmo", "scipy"))


def look_at_net(o, net, changes, tables, missed):
    found, counts, (genes, chains) = measure(o, changes)
    lm, lm_evaluations, _ = refine(o, changes, "lm", 1)
    ga_lm, _, base = min(refine(o, changes, "ga+lm", seed) for seed in (1, 2))
    star = min(lm, ga_lm, *(min(row[-1] for row in rows) for rows in found.values()))
    above = {key: [100 * (statistics.median(row[counts.index(b)] for row in rows) / star - 1) for b in BUDGETS]
             for key, rows in found.items()}
    above["Levenberg-Marquardt", "gene"] = [100 * (lm / star - 1)] * 3 if math.isfinite(lm) else [math.inf] * 3
    print(f"{net}: {genes} genes in {chains} chains, psi {base * 1e3:.4f} mm, psi* {star * 1e3:.7f} mm",
          flush=True)
    for key, of in above.items():
        times = [running_time(found[key], counts, star * (1 + 10.0 ** -t)) if key in found else math.nan
                 for t in TARGETS]
        if key not in found and math.isfinite(lm):
            times = [lm_evaluations if lm <= star * (1 + 10.0 ** -t) else math.inf for t in TARGETS]
        tables["all"].append([net, genes, chains, f"{base * 1e3:.7g}", f"{star * 1e3:.9g}", *key,
                              len(found.get(key, [0])), *(f"{x:.3g}" for x in of),
                              *("" if not math.isfinite(t) else f"{t:.0f}" for t in times)])
    for i, budget in enumerate(BUDGETS):
        mine = above["ours", "gene"][i]
        for kind, fits in (("population", is_population), ("one design at a time", lambda key: key[0][0] in "nL")):
            best, key = min((of[i], key) for key, of in above.items() if fits(key))
            if best < mine and mine - best > 1e-7 * (100 + best):
                tables["lost"].append([net, budget, kind, *key, f"{best:.3g}", f"{mine:.3g}"])
    for key, rows in found.items():
        reached = [sum(row[i] <= star * (1 + 10.0 ** -t) for row in rows for t in TARGETS) for i in range(len(counts))]
        missed.setdefault(key, []).append((np.array(reached), len(rows) * len(TARGETS)))
    return counts


def draw(path, counts, missed):
    best = {}  # of the two kinds of variables the one that has reached more in the end
    for (name, variables), parts in missed.items():
        reached, of = sum(part[0] for part in parts), sum(part[1] for part in parts)
        if name not in best or reached[-1] > best[name][0][-1]:
            best[name] = reached, of, variables
    panel = {f"{name} ({variables})": [(c, max(1 - r / of, 1e-9)) for c, r in zip(counts, reached) if r < of]
             for name, (reached, of, variables) in best.items()}
    svg.loglog(path, {"Targets psi* (1 + 10^-1 ... 10^-6) on ten nets": panel}, "evaluations", "share not reached yet",
               "make bench-optimisers; of the two kinds of variables that with more in the end", columns=1,
               styles={name: "dash" for name in panel if not name.startswith(("ours (gene", "nlopt", "pagmo"))})


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--driver", required=True)
    options.add_argument("--program", required=True)
    options.add_argument("--case", default="configs/reflector.yaml")
    options.add_argument("--seeds", type=int, default=15)
    options.add_argument("--nets", type=int, default=len(NETS))
    options.add_argument("--out", type=Path, required=True)
    o = options.parse_args()
    tables, missed, counts = {"all": [], "lost": []}, {}, []
    for net, changes in list(NETS.items())[: o.nets]:
        counts = look_at_net(o, net, changes, tables, missed)
    heads = {"all": ["net", "genes", "chains", "psi_mm", "psi_star_mm", "optimiser", "variables", "seeds",
                     *(f"above_after_{b}_percent" for b in BUDGETS), *(f"ert_1e-{t}" for t in TARGETS)],
             "lost": ["net", "evaluations", "to", "optimiser", "variables", "above_percent", "ours_percent"]}
    for name, file_name in (("all", "optimisers.csv"), ("lost", "optimisers_lost.csv")):
        with open(o.out / file_name, "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([heads[name], *tables[name]])
    draw(o.out / "optimisers.svg", counts, missed)
    lost = sum(row[2] == "population" for row in tables["lost"])
    print(f"another population is better in {lost} of {o.nets * len(BUDGETS)} comparisons")


if __name__ == "__main__":
    main()
