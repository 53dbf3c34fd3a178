#!/usr/bin/env python3
"""Compares a batch of designs through the package for Python with the same in C.

The script measures processor time on one thread, as medians of interleaved rounds, with one process for each
measurement. The C side is `hifdm evaluate`, whose cpu_s is that of its batch alone. The Python side is the whole first
call, including checks and results, and the second call.

    PYTHONPATH=tools/python python_batch.py --program build/hifdm --work build/bench [CASE]
"""
import argparse
import csv
import json
import os
import statistics
import subprocess
import sys
import time
import warnings

import numpy as np

import hifdm


def once(path, table):
    """Prints the processor times of the first and the second call, s."""
    case = hifdm.open(path, threads=1)
    designs = np.loadtxt(table, delimiter=",", skiprows=1)
    case.form()
    for _ in range(2):
        start = time.process_time()
        case.evaluate(designs)
        print(time.process_time() - start)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", nargs="?", default="configs/chen2022.yaml")
    parser.add_argument("--program", default="build/hifdm")
    parser.add_argument("--work", default="build/bench")
    parser.add_argument("--rounds", type=int, default=31)
    parser.add_argument("--designs", type=int, default=1000)
    parser.add_argument("--once", metavar="TABLE", help="only evaluate this table, in this process")
    options = parser.parse_args()
    warnings.simplefilter("ignore", hifdm.HifdmWarning)
    if options.once:
        once(options.case, options.once)
        return
    os.makedirs(options.work, exist_ok=True)
    case = hifdm.open(options.case, threads=1)
    designs = case.base + np.random.default_rng(1).uniform(-1, 1, (options.designs, case.n_gene))
    table, results = (os.path.join(options.work, name) for name in ("designs.csv", "results.csv"))
    with open(table, "w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([case.variables, *designs.tolist()])
    command = [options.program, "evaluate", options.case, "--designs", table, "-o", results, "--force", "--json",
               "--threads", "1"]
    ours, again, theirs = [], [], []
    for _ in range(options.rounds):
        said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        theirs.append(json.loads(said)["cpu_s"])
        said = subprocess.run([sys.executable, __file__, options.case, "--once", table], capture_output=True, text=True,
                              check=True).stdout
        for values, line in zip((ours, again), said.split()):
            values.append(float(line))
    c_s, first_s, second_s = (statistics.median(values) for values in (theirs, ours, again))
    print(f"{options.designs} designs of {options.case}, one thread, processor time, medians of {options.rounds} "
          f"rounds: C {c_s * 1e3:.2f} ms, Python {first_s * 1e3:.2f} ms, ratio {first_s / c_s:.3f}; "
          f"the second call {second_s * 1e3:.2f} ms")


if __name__ == "__main__":
    main()
