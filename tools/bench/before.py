#!/usr/bin/env python3
"""Compares form-finding now with that of an old commit. The script takes that commit from the history of the
repository, builds its library, and runs both in turn on the same nets. For a true error of 1e-6 m and of 1e-12 m, the
table shows the steps, the processor time and the error that each reaches. Errors are relative to today's shape at a
tolerance of 1e-13.

    before.py --library build/libhifdm.a --driver build/bench/bench --work build/bench/before --out results/bench

`make bench-before` runs the script in this way. COMMIT=... selects another commit than 2161b94, the last one before the
interior path (METHOD section 5). Cases given as arguments are measured, too. OPENBLAS=.../libblas.so.3 is the BLAS for
both."""
import argparse
import os
import re
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from run import processor  # noqa: E402

CYLINDER = "scene.parabolic_cylinder."
TRUSS = ["configs/straight-edges-truss.yaml", CYLINDER + "boundary=outer_edge", CYLINDER + "scallop=0.1"]
ALL = ["form.method=auto", "form.stop=residual"]
# A case and overrides each. {work} stands for cases that the driver of the benchmark writes there.
NETS = {
    "straight-edges (no answer)": ["configs/straight-edges.yaml"],
    "21x25 f=15": ["configs/reflector.yaml", CYLINDER + "focal_length_m=15"],
    "imported 31x37": ["{work}/imported.yaml"],
    "41x49 f=5": ["configs/reflector.yaml", CYLINDER + "focal_length_m=5", CYLINDER + "cells_per_module=[4,4]"],
    "21x25 perimeter": ["configs/reflector.yaml", CYLINDER + "supports=perimeter", CYLINDER + "scallop=0"],
    "21x25 f=7.2": ["configs/reflector.yaml"],
    **{f"triangles_{x}": [f"{{work}}/triangles_{x}.yaml"] for x in "abc"},
    "mixed laws; a cable of 0.004 N": ["tests/verify/data/mixed/case.yaml"],
    "mixed laws; nodes that part again": ["tests/verify/data/parting/case.yaml"],
    "21x25 tension; length and elastic": ["{work}/mixed/laws.yaml"],
    "21x25 elastic": ["{work}/elastic/laws.yaml"],
    "21x25 elastic; cut with errors of 0.5 mm": ["{work}/cut/laws.yaml"],
    "on its truss": TRUSS,
    "on a truss 300 times as soft": TRUSS + ["truss.E_Pa=4.3e8"],
}
# Cases that the driver of the benchmark writes: section, name there, folder under WORK.
WRITTEN = [("equilibrium", "21x25 elastic", "elastic"),
           ("equilibrium", "21x25 elastic; cut with errors of 0.5 mm", "cut"),
           ("equilibrium", "21x25 tension; length and elastic", "mixed"), ("cases", "imported 31x37", ".")]


def run(command, **keywords):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, **keywords).stdout


def make_words(name, folder="."):
    return run(["make", "-s", f"print-{name}"], cwd=folder).split()


def build(a):
    """Builds the drivers for today's library and for the old one."""
    old = f"{a.work}/{a.commit}"
    if not os.path.exists(f"{old}/build/libhifdm.a"):
        os.makedirs(old, exist_ok=True)
        archive = subprocess.run(["git", "archive", a.commit], check=True, stdout=subprocess.PIPE)
        subprocess.run(["tar", "x", "-C", old], input=archive.stdout, check=True)
        # The old Makefile is another project, so it does not get the jobs of the make that runs this script.
        env = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS", "BUILD")}
        run(["make", f"-j{os.cpu_count()}", "WERROR=", "build/libhifdm.a"], cwd=old, env=env)
    drivers = {}
    for name, include, library in (("before", f"{old}/include", f"{old}/build/libhifdm.a"),
                                   ("now", "include", a.library)):
        drivers[name] = f"{a.work}/finding-{name}"
        run([*make_words("CC"), *make_words("LANGUAGE"), "-O2", *make_words("PKG_CFLAGS"), "-include", "stdbool.h",
             f"-I{include}", f"{HERE}/before/finding.c", library, "-o", drivers[name], *make_words("PKG_LIBS"),
             *(["-llapack", "-lblas"] if name == "before" else [])])  # it did not load LAPACK at run time
    return drivers


def write_cases(a):
    for section, name, folder in WRITTEN:
        os.makedirs(f"{a.work}/{folder}", exist_ok=True)
        run([a.driver, section, f"{a.work}/{folder}", name])
    limits = os.path.abspath("tests/verify/data/limits")
    for x in "abc":
        with open(f"{a.work}/triangles_{x}.yaml", "w") as file:
            file.write(f"scene:\n  import: {{nodes: {limits}/triangles_{x}_nodes.csv, "
                       f"cables: {limits}/triangles_{x}_cables.csv}}\nform: {{pretension_N: 10}}\n")


def measure(a, drivers):
    """Returns {net: {who: {wanted: [rows]}}}; a row is steps, seconds, error, slack cables, status."""
    env = dict(os.environ, OPENBLAS_NUM_THREADS="1")
    if os.environ.get("OPENBLAS"):
        env["LD_LIBRARY_PATH"] = os.path.dirname(os.environ["OPENBLAS"])
    found, reference = {}, f"{a.work}/reference.txt"
    nets = {name: [word.format(work=a.work) for word in words + ALL] for name, words in NETS.items()}
    nets.update({path: [path, *ALL] for path in a.cases})
    for name, words in nets.items():
        run([drivers["now"], "reference", reference, *words])
        for _ in range(a.rounds):
            for who, driver in drivers.items():
                for line in run([driver, "measure", reference, *words], env=env).splitlines():
                    wanted, steps, seconds, error, slack, status = line.split("\t")
                    found.setdefault(name, {}).setdefault(wanted, {}).setdefault(who, []).append(
                        (int(steps), float(seconds), float(error), int(slack), status))
        print(f"  {name}", flush=True)
    return found


def write(a, found):
    folder = f"{a.out}/{re.sub(r'[^a-z0-9]+', '-', processor().lower()).strip('-')}"
    os.makedirs(folder, exist_ok=True)
    head = [f"cpu {processor()}, {os.cpu_count()} available", f"before: {a.commit}; now: {describe()}",
            f"BLAS of both {blas()}",
            f"processor time, medians of {a.rounds} interleaved rounds; load average {os.getloadavg()[0]:.2f}"]
    columns = ["net", "wanted_m", "steps_before", "time_before_s", "error_before_m", "steps_now", "time_now_s",
               "error_now_m", "n_slack", "times_as_fast", "status_before", "status_now"]
    with open(f"{folder}/before.csv", "w") as file:
        file.write("".join(f"# {row}\n" for row in head) + ",".join(columns) + "\n")
        for name, by_wanted in found.items():
            for wanted, rows in by_wanted.items():
                cells, seconds = [], {}
                for who in ("before", "now"):
                    seconds[who] = statistics.median(row[1] for row in rows[who])
                    steps, _, error, slack, status = rows[who][0]
                    cells += [str(steps), f"{seconds[who]:.4g}", "" if error != error else f"{error:.3g}"]
                cells += [str(slack), f"{seconds['before'] / seconds['now']:.2f}",
                          *(rows[who][0][4].replace(",", ";") for who in ("before", "now"))]
                file.write(",".join([name, wanted, *cells]) + "\n")
                print(f"  {name:<44} {wanted:>6} " + " ".join(f"{cell:>9}" for cell in cells[:8]))
    return f"{folder}/before.csv"


def blas():
    folder = os.path.dirname(os.environ.get("OPENBLAS", ""))
    names = [name for name in os.listdir(folder) if name.startswith("libopenblasp")] if folder else []
    return names[0] if names else "named by OPENBLAS" if folder else "of the system"


def describe():
    return run(["git", "describe", "--always", "--dirty", "--tags"]).strip()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for option in ("library", "driver", "work", "out"):
        parser.add_argument(f"--{option}", required=True)
    parser.add_argument("--commit", default="2161b94")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("cases", nargs="*")
    a = parser.parse_args()
    a.work = os.path.abspath(a.work)
    drivers = build(a)
    write_cases(a)
    print(write(a, measure(a, drivers)))


if __name__ == "__main__":
    main()
