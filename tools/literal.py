#!/usr/bin/env python3
"""Compares the literal method of the paper for evaluating an individual with the other methods of the program: psi and
time on one case. Then it compares one solve with given force densities by each factorisation (form.factor): errors and
time.

    literal.py --program build/hifdm --case configs/chen2022.yaml --work build/literal [--rounds 7]

The script prints two tables in Markdown. Rounds are interleaved. Times are medians, and ratios are medians of the
ratios within a round. CPU time is that of the evaluations alone, over all threads, because other work on the machine
disturbs it least."""
import argparse
import csv
import json
import os
import statistics
import subprocess

# rule, solver, factor, description
WAYS = [
    ("seeded", "fixed_point", "own",
     "the paper's: Eq. 8 from the design, to its stop; band Cholesky in each iteration"),
    ("seeded", "fixed_point", "lapack", "the same, each design alone, by dpbtrf and dpbtrs"),
    ("force_density", "fixed_point", "own", "the same iteration to equilibrium, boundary force densities held"),
    ("force_density", "newton", "own", "Newton, each design with matrices of its own"),
    ("force_density", "newton", "lapack", "the same by dpbtrf and dpbtrs"),
    ("force_density", "auto", "own", "default: one Newton matrix shared read-only by all threads"),
]
FACTORS = ["own", "lapack"]


def processor():
    with open("/proc/cpuinfo") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return f"{len(names)} x {names[0]}" if names else "unknown processor"


def run(a, name, *settings):
    """Returns the JSON of a run with these settings. Its result is NAME.h5 in the folder for results."""
    out = os.path.join(a.work, f"{name}.h5")
    command = [a.program, "run", a.case, "-o", out, "--force", "--json", "--quiet"]
    for setting in settings:
        command += ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: exit status {done.returncode}\n{done.stderr}")
    return json.loads(done.stdout)


def run_way(a, rule, solver, factor):
    answer = run(a, f"{rule}-{solver}-{factor}", f"optimize.rule={rule}", f"optimize.solver={solver}",
                 f"form.factor={factor}")
    return answer["search"] | {"threads": answer["threads"]}


def solve_once(a, factor):
    """Runs form-finding alone with given force densities: one factorisation, three right-hand sides, and the
    measures."""
    return run(a, f"once-{factor}", "form.method=fdm", f"form.factor={factor}", "optimize.method=ga",
               "optimize.compare_lm=false", "optimize.generations=1")["form"]


def positions(a, factor):
    folder = os.path.join(a.work, f"once-{factor}")
    subprocess.run([a.program, "export", f"{folder}.h5", "--csv", folder, "--stage", "form", "--force"], check=True,
                   capture_output=True)
    with open(os.path.join(folder, "nodes.csv"), newline="") as file:
        return [float(row[key]) for row in csv.DictReader(file) for key in ("x_m", "y_m", "z_m")]


def print_single(a):
    """Prints the table of single solves. Backward error: the largest nodal force over the largest sum of tensions at a
    node."""
    found = [[solve_once(a, factor) for factor in FACTORS] for _ in range(a.rounds)]
    own = positions(a, "own")
    largest = max(map(abs, own))
    print("\n| `form.factor`, one solve | backward error | condition | largest difference from `own`, relative "
          "| form-finding (us) |\n|---|---|---|---|---|")
    for i, factor in enumerate(FACTORS):
        mine = [one[i] for one in found]
        wall_us = statistics.median(r["wall_s"] for r in mine) * 1e6
        off = max(abs(x - y) for x, y in zip(own, positions(a, factor))) / largest
        print(f"| `{factor}` | {mine[0]['backward_error']:.1e} | {mine[0]['condition']:.1f} | {off:.1e} "
              f"| {wall_us:.0f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--case", required=True)
    parser.add_argument("--work", required=True, help="folder for result files")
    parser.add_argument("--rounds", type=int, default=7)
    a = parser.parse_args()
    os.makedirs(a.work, exist_ok=True)

    found = [[run_way(a, *way[:3]) for way in WAYS] for _ in range(a.rounds)]
    print(f"{a.case}: medians of {a.rounds} interleaved runs; {found[0][0]['threads']} threads; {processor()}\n")
    print("| `rule`, `solver`, `factor` | an individual is | psi (mm) | evaluations | wall (s) "
          "| CPU per evaluation (us) | CPU against the first |\n|---|---|---|---|---|---|---|")
    for i, (rule, solver, factor, what) in enumerate(WAYS):
        mine = [one[i] for one in found]
        wall_s = statistics.median(r["wall_s"] for r in mine)
        each_us = statistics.median(r["cpu_s"] / r["evaluations"] * 1e6 for r in mine)
        part = statistics.median((one[i]["cpu_s"] / one[i]["evaluations"]) /
                                 (one[0]["cpu_s"] / one[0]["evaluations"]) for one in found)
        psi = {f"{1e3 * r['psi_m']:.4f}" for r in mine}
        print(f"| `{rule}`, `{solver}`, `{factor}` | {what} | {', '.join(sorted(psi))} "
              f"| {mine[0]['evaluations']} | {wall_s:.2f} | {each_us:.1f} | {part:.2f} |", flush=True)
    print_single(a)


if __name__ == "__main__":
    main()
