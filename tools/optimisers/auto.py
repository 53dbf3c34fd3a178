#!/usr/bin/env python3
"""Measures `method: auto` from many seeds, beside other optimisers with its budget: `make bench-auto`.

The nets are those of run.py, and nets A, B and C of METHOD, "Other local optima". Nets with a cap in their name have
no other optimisers, because those of budget.cpp know no constraints. All run on one thread. The script writes into
--out:

auto.csv  per net and optimiser: the budget ("solves": as many form-findings as `auto` uses at most; "time": its
          time of refinements plus the processor time of its search, median over seeds), the number of seeds that come
          within 1e-6 times the lowest psi known, psi above that (median and maximum over seeds, in %), the median
          number of form-findings, and for `auto` its time, in times of one
          refinement of the best design of a first generation (`ga+lm` with one generation; means over seeds)
best.csv  per net the lowest psi known, here or in the optimisers.csv and best.csv of --out; who found it; and the
          command with which `auto` finds its own lowest psi, and the last commit to src or include
"""

import argparse
import csv
import statistics
import subprocess
import sys
from pathlib import Path

import run
from running_times import write_rows

REACHED = 1e-6
LIMITS = "tests/verify/data/limits/"
HEADS = {
    "auto.csv": ["net", "variables", "optimiser", "budget", "seeds", "seeds_at_best", "median_above_percent",
                 "max_above_percent", "median_solves", "refinements"],
    "best.csv": ["net", "psi_mm", "found_by", "command", "commit"],
}


def problems():
    for name, case, arguments in run.problems():
        yield name, case, arguments
    for net in "abc":
        yield f"net {net.upper()}", "tools/optimisers/triangles.yaml", [
            "--set", f"scene.import.nodes={LIMITS}triangles_{net}_nodes.csv",
            "--set", f"scene.import.cables={LIMITS}triangles_{net}_cables.csv"]


def solve(o, case, arguments, method, seed):
    """Returns psi (m), form-findings and time without storing (s) of a run with this method, and its number of
    variables."""
    of = run.result_of(o, case, arguments, method, seed)[0]
    search = of.get("search") or {"evaluations": 0, "cpu_s": 0, "store_cpu_s": 0, "independent_variables": 0}
    return (of["refine"]["psi_m"], of["refine"]["evaluations"] + search["evaluations"],
            of["refine"]["wall_s"] + search["cpu_s"] - search["store_cpu_s"], search["independent_variables"])


def row_of(net, variables, optimiser, budget, psi, best, solves, refinements=""):
    above = [100 * (p / best - 1) for p in psi]
    return [net, variables, optimiser, budget, len(psi), sum(p <= best * (1 + REACHED) for p in psi),
            f"{statistics.median(above):.3g}", f"{max(above):.3g}", f"{statistics.median(solves):.0f}", refinements]


def look_at(o, net, case, arguments, known_m):
    ours = [solve(o, case, arguments, "auto", seed) for seed in range(1, o.seeds + 1)]
    once = [*arguments, "--set", "optimize.generations=1"]
    single = statistics.mean(solve(o, case, once, "ga+lm", seed)[2] for seed in range(1, o.seeds + 1))
    psi, solves, took_s, variables = zip(*ours)
    found = {}
    if "cap" not in net:
        budget = str(max(solves)), str(statistics.median(took_s))
        done = subprocess.run([o.driver, case, str(o.peer_seeds), *budget, *arguments], text=True, check=True,
                              stdout=subprocess.PIPE)
        for name, _, by, used, best_m in csv.reader(done.stdout.splitlines()):
            found.setdefault((name, by), []).append((float(best_m), float(used)))
    best, who = min([(min(psi), "hifdm run, method auto"), *((min(p for p, _ in runs), key[0])
                                                             for key, runs in found.items()), known_m])
    if min(psi) <= best * (1 + 1e-9):
        best, who = min(psi), "hifdm run, method auto"
    rows = [row_of(net, variables[0], "hifdm auto", "", psi, best, solves,
                   f"{statistics.mean(took_s) / single:.2f}")]
    rows += [row_of(net, variables[0], *key, [p for p, _ in runs], best, [n for _, n in runs])
             for key, runs in found.items()]
    words = " ".join(f"'{word}'" if " " in word else word for word in arguments)
    seed = 1 + psi.index(min(psi))
    command = f"hifdm run {case} {words} --set optimize.method=auto --seed {seed}".replace("  ", " ")
    return rows, [net, f"{best * 1e3:.12g}", who, command, o.commit]


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--driver", required=True)
    options.add_argument("--program", required=True)
    options.add_argument("--seeds", type=int, default=20, help="of method auto")
    options.add_argument("--peer-seeds", type=int, default=5, help="of each other optimiser")
    options.add_argument("--out", type=Path, required=True)
    o = options.parse_args()
    o.commit = subprocess.run(["git", "log", "-1", "--format=%h", "--", "src", "include"], text=True, check=True,
                              stdout=subprocess.PIPE).stdout.strip()
    known = {}
    if (o.out / "optimisers.csv").exists():
        for row in csv.DictReader((o.out / "optimisers.csv").open()):
            known[row["net"]] = 1e-3 * float(row["psi_star_mm"]), row["psi_star_of"]
    if (o.out / "best.csv").exists():
        for row in csv.DictReader((o.out / "best.csv").open()):
            known[row["net"]] = min(known.get(row["net"], (float("inf"), "")),
                                    (1e-3 * float(row["psi_mm"]), row["found_by"]))
    tables = {name: [] for name in HEADS}
    order = [problem[0] for problem in problems()]
    for net, case, arguments in problems():
        rows, best = look_at(o, net, case, arguments, known.get(net, (float("inf"), "")))
        print(f"{net}: {best[1]} mm, {rows[0][5]} of {o.seeds} seeds, {rows[0][-1]} refinements", flush=True)
        tables["auto.csv"] += rows
        tables["best.csv"].append(best)
        for name, head in HEADS.items():
            write_rows(o.out / name, head, tables[name], order)
    few = [row[0] for row in tables["auto.csv"] if row[2] == "hifdm auto" and row[5] < 0.95 * o.seeds]
    print(f"on {len(order) - len(few)} of {len(order)} nets, 95 % of the seeds reach the lowest psi known")
    for net in few:
        print(f"not on {net}", file=sys.stderr)


if __name__ == "__main__":
    main()
