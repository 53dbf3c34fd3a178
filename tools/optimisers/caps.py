#!/usr/bin/env python3
"""Checks the warning that no feasible design is expected: part of `make bench-auto`.

On each net of run.py without a cap, it sets caps from 0.7 to 0.99 times the boundary tension ratio after form-finding,
and runs `ga+lm` for 100 generations. It writes caps.csv into --out: per cap, whether the first generation led to the
warning, and whether the run found a feasible design. A warning where there is one is a false claim.
"""

import argparse
import sys
from pathlib import Path

import run
from running_times import write_rows

PARTS = 0.99, 0.97, 0.95, 0.92, 0.89, 0.86, 0.83, 0.8, 0.75, 0.7
HEAD = ["net", "cap", "is_warned", "is_feasible"]


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--program", required=True)
    options.add_argument("--out", type=Path, required=True)
    o = options.parse_args()
    nets = [problem for problem in run.problems() if "cap" not in problem[0]]
    rows = []
    for net, case, arguments in nets:
        ratio = run.result_of(o, case, [*arguments, "--set", "optimize.generations=1"], "ga", 1)[0]["form"][
            "boundary_tension_ratio"]
        for part in PARTS:
            cap = max(1.001, part * ratio)
            limits = [*arguments, "--set", f"optimize.boundary_ratio_cap={cap:.6g}", "--set",
                      "optimize.generations=100"]
            result, said = run.result_of(o, case, limits, "ga+lm", 1)
            rows.append([net, f"{cap:.4g}", int("expects no feasible design" in said), int(result is not None)])
    write_rows(o.out / "caps.csv", HEAD, rows, [net[0] for net in nets])
    missed = [row for row in rows if not row[3]]
    false = [row for row in rows if row[2] and row[3]]
    print(f"{sum(row[2] for row in missed)} of {len(missed)} caps that no design met were named, and {len(false)} of "
          f"{len(rows) - len(missed)} that designs met")
    sys.exit(bool(false))


if __name__ == "__main__":
    main()
