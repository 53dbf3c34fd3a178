#!/usr/bin/env python3
"""The paper's literal way to evaluate an individual beside the program's others: psi and time on one case.

    literal.py --program build/hifdm --case configs/chen2022.yaml --work build/literal [--rounds 7]

Prints a table in Markdown. Rounds are interleaved; times are medians, and ratios medians of the ratios within a round.
CPU time is that of the evaluations alone, over all threads: other work on the machine disturbs it least.
"""
import argparse
import json
import os
import statistics
import subprocess

# rule, solver, what it is
WAYS = [
    ("seeded", "fixed_point", "the paper's: Eq. 8 from the design, to its stop; band Cholesky in each iteration"),
    ("force_density", "fixed_point", "the same iteration to equilibrium, boundary force densities held"),
    ("force_density", "newton", "Newton, each design with matrices of its own"),
    ("force_density", "auto", "default: one Newton matrix shared read-only by all threads"),
]


def processor():
    with open("/proc/cpuinfo") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return f"{len(names)} x {names[0]}" if names else "unknown processor"


def run(a, rule, solver):
    out = os.path.join(a.work, f"{rule}-{solver}.h5")
    command = [a.program, "run", a.case, "-o", out, "--force", "--json", "--quiet",
               "--set", f"optimize.rule={rule}", "--set", f"optimize.solver={solver}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: exit status {done.returncode}\n{done.stderr}")
    answer = json.loads(done.stdout)
    return answer["optimize"] | {"threads": answer["threads"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--case", required=True)
    parser.add_argument("--work", required=True, help="folder for result files")
    parser.add_argument("--rounds", type=int, default=7)
    a = parser.parse_args()
    os.makedirs(a.work, exist_ok=True)

    found = [[run(a, rule, solver) for rule, solver, _ in WAYS] for _ in range(a.rounds)]
    print(f"{a.case}: medians of {a.rounds} interleaved runs; {found[0][0]['threads']} threads; {processor()}\n")
    print("| `rule`, `solver` | an individual is | psi (mm) | evaluations | wall (s) | CPU per evaluation (us) "
          "| CPU against the first |\n|---|---|---|---|---|---|---|")
    for i, (rule, solver, what) in enumerate(WAYS):
        mine = [one[i] for one in found]
        wall_s = statistics.median(r["wall_s"] for r in mine)
        each_us = statistics.median(r["cpu_s"] / r["evaluations"] * 1e6 for r in mine)
        part = statistics.median((one[i]["cpu_s"] / one[i]["evaluations"]) /
                                 (one[0]["cpu_s"] / one[0]["evaluations"]) for one in found)
        psi = {f"{1e3 * r['psi_m']:.4f}" for r in mine}
        print(f"| `{rule}`, `{solver}` | {what} | {', '.join(sorted(psi))} | {mine[0]['evaluations']} | {wall_s:.2f} "
              f"| {each_us:.1f} | {part:.2f} |", flush=True)


if __name__ == "__main__":
    main()
