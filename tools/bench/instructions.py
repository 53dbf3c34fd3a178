#!/usr/bin/env python3
"""Counts the machine instructions of three cases on one thread and compares them with results/bench/instructions.csv.

    instructions.py --program build/hifdm --work build/instructions --table results/bench/instructions.csv [--record]

`make bench-instructions` runs the script in this way. RECORD=yes writes the table, CASES="reflector 41x49" selects
cases. callgrind, a tool of valgrind, counts by shared object: the program itself, and its libraries. valgrind has no
AVX-512, so the program chooses its AVX2 kernels; the table lists them. The BLAS is the reference BLAS, if Debian's
package of it is installed.

The limit of 2 % holds for the program's own instructions, and for "computing": these and the libraries that compute.
Both repeat to 0.01 %. HDF5 and libc do not, because the number of publications depends on the time that a run takes.

Other compilers and libraries give other counts. If one of them differs from that of the table, this script builds the
commit of the table from the history of git and counts it here. These counts then replace those of the table."""
import argparse
import concurrent.futures
import csv
import glob
import os
import re
import subprocess
import sys
from pathlib import Path

LIMIT = 0.02
CYLINDER = "scene.parabolic_cylinder."
# The last case is "41x49 f=5" of the benchmark (tools/bench/scene.c).
CASES = {
    "chen2022": ["configs/chen2022.yaml"],
    "reflector": ["configs/reflector.yaml"],
    "41x49": ["configs/reflector.yaml", "--set", CYLINDER + "focal_length_m=5",
              "--set", CYLINDER + "cells_per_module=[4,4]"],
}
# Shared objects by the beginning of their file name; all others are "other". "start" is the dynamic loader, whose count
# grows with the number of libraries that HDF5 itself needs.
OBJECTS = {
    "hifdm": ["hifdm"],
    "lapack": ["liblapack", "libblas", "libopenblas"],
    "gsl": ["libgsl"],
    "m": ["libm."],
    "hdf5": ["libhdf5", "libz.", "libsz", "libaec"],
    "c": ["libc."],
    "start": ["ld-linux"],
}
COMPUTING = ["hifdm", "lapack", "gsl", "m"]
COLUMNS = [*OBJECTS, "other", "computing", "total"]
COMPARED = ["hifdm", "computing"]


def run(command, **keywords):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **keywords)
    if done.returncode != 0:
        raise SystemExit(f"{done.stdout[-4000:]}\ninstructions: {' '.join(command)}: exit status {done.returncode}")
    return done.stdout


def of_object(path):
    name = os.path.basename(path)
    return next((o for o, heads in OBJECTS.items() if any(name.startswith(head) for head in heads)), "other")


def read_profile(path):
    """Returns the counts by object, and the file names of the libraries. A line of cost counts for the object that was
    given last. The line after "calls=" is left out, because it repeats the cost of the called function. A name is
    written in full where its number appears first."""
    count, names, isas = dict.fromkeys(COLUMNS, 0), {}, set()
    which, is_call, summary = "other", False, None
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            name = re.match(r"c?(ob|fn)=(\(\d+\)) ?(.*)", line)
            if name:
                text = names.setdefault((name[1], name[2]), name[3])
                if line.startswith("ob="):
                    which = of_object(text)
                if name[1] == "fn":
                    isas.update(re.findall(r"_(portable|avx2|avx512)\b", text))
            elif line.startswith("calls="):
                is_call = True
            elif line.startswith(("summary:", "totals:")):
                summary = int(line.split()[1])
            elif line[0].isdigit() or line[0] in "+-*":
                if not is_call:
                    count[which] += int(line.split()[1])
                is_call = False
    count["total"] = sum(count.values())
    count["computing"] = sum(count[o] for o in COMPUTING)
    if count["total"] != summary:
        raise SystemExit(f"instructions: {path}: {count['total']} instructions read, {summary} counted by callgrind")
    if not isas:
        raise SystemExit(f"instructions: {path}: no kernel ran")
    objects = {os.path.basename(os.path.realpath(text)) for (kind, _), text in names.items() if kind == "ob"}
    return count, isas, objects


def environment():
    """Returns the environment. With all of these variables the program does not start itself a second time. callgrind
    would not follow it."""
    env = dict(os.environ, OMP_NUM_THREADS="1", OMP_WAIT_POLICY="passive", GOMP_SPINCOUNT="2000",
               OPENBLAS_NUM_THREADS="1", LC_ALL="C")
    reference = glob.glob("/usr/lib/*/lapack/liblapack.so.3") + glob.glob("/usr/lib/*/blas/libblas.so.3")
    if reference:
        env["LD_LIBRARY_PATH"] = ":".join(os.path.dirname(path) for path in reference)
    return env


def measure(program, work, name):
    """Runs the program once under callgrind. A result of the run before would be read, which counts as well."""
    profile, result = f"{work}/{name}.callgrind", Path(f"{work}/{name}.h5")
    result.unlink(missing_ok=True)
    run(["valgrind", "--quiet", "--tool=callgrind", f"--callgrind-out-file={profile}", program, "run", *CASES[name],
         "--threads", "1", "--quiet", "-o", result], env=environment())
    return read_profile(profile)


def measure_all(program, work, cases):
    """Returns counts by case, the kernels that ran, and the files of the libraries."""
    os.makedirs(work, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(lambda name: measure(os.path.abspath(program), work, name), cases))
    counts = {name: count for name, (count, _, _) in zip(cases, found)}
    return counts, "+".join(sorted(set().union(*(f[1] for f in found)))), set().union(*(f[2] for f in found))


def make_word(name):
    return run(["make", "-s", f"print-{name}"]).strip()


def machine(isas, objects):
    """Returns what the counts depend on besides the sources, as rows of the head of the table."""
    libraries = sorted(o for o in objects if of_object(o) in ("lapack", "gsl", "hdf5"))
    libc = run(["ldd", "--version"]).splitlines()[0].split()[-1]
    return {
        "compiler": make_word("COMPILER"),
        "flags": " ".join(make_word(name) for name in ("CFLAGS", "LANGUAGE", "CODEGEN")),
        "valgrind": run(["valgrind", "--version"]).strip().removeprefix("valgrind-"),
        "kernels": isas,
        "libraries": " ".join([f"libc.so.{libc}", *libraries]),
    }


def differ(key, one, other):
    """Returns true if the two values differ. A library that only one of them uses is no difference, because the program
    may stop using it."""
    if key != "libraries" or one is None or other is None:
        return one != other
    versions = [dict(name.split(".so", 1) for name in text.split()) for text in (one, other)]
    return any(versions[0][name] != versions[1][name] for name in versions[0].keys() & versions[1].keys())


def read_table(path):
    with open(path, newline="", encoding="utf-8") as file:
        lines = file.read().splitlines()
    head = dict(re.match(r"# (\w+): (.*)", line).groups() for line in lines if line.startswith("# "))
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return head, {row.pop("case"): {k: int(v) for k, v in row.items()} for row in rows}


def write_table(path, head, counts):
    with open(path, "w", encoding="utf-8") as file:
        file.write("".join(f"# {key}: {value}\n" for key, value in head.items()))
        file.write(",".join(["case", *COLUMNS]) + "\n")
        for name, count in counts.items():
            file.write(",".join([name, *(str(count[c]) for c in COLUMNS)]) + "\n")


def build_before(work, commit):
    """Returns the program of a commit, built from the history of git; None if there is no history."""
    folder = f"{work}/{commit}"
    archive = subprocess.run(["git", "archive", commit], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    if archive.returncode != 0:
        return None
    os.makedirs(folder, exist_ok=True)
    subprocess.run(["tar", "x", "-C", folder], input=archive.stdout, check=True)
    # The old Makefile is another project, so it does not get the jobs of the make that runs this script.
    env = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS", "BUILD")}
    run(["make", f"-j{os.cpu_count()}", "WERROR=", f"CC={make_word('CC')}", f"CFLAGS={make_word('CFLAGS')}",
         "build/hifdm"], cwd=folder, env=env)
    return f"{folder}/build/hifdm"


def skip(why):
    print(f"skipped: bench-instructions: {why}")
    if os.environ.get("HIFDM_SKIPPED"):
        with open(os.environ["HIFDM_SKIPPED"], "a", encoding="utf-8") as file:
            file.write(f"bench-instructions: {why}\n")


def compare(counts, before, commit):
    """Prints counts and ratios. Returns the names of the cases that need too many instructions."""
    too_many = []
    print(f"{'case':<12}{'object':<8}{'instructions':>16}{commit:>16}{'ratio':>9}")
    for name, count in counts.items():
        for column in COLUMNS:
            n, old = count[column], before[name][column]
            ratio = n / old if old else float("inf") if n else 1.0
            mark = ""
            if column in COMPARED and ratio > 1 + LIMIT:
                too_many.append(f"{name} ({column})")
                mark = f"  more than {LIMIT:.0%} above"
            print(f"{name:<12}{column:<8}{n:>16}{old:>16}{ratio:>9.4f}{mark}")
    return too_many


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True)
    parser.add_argument("--table", required=True)
    parser.add_argument("--record", action="store_true", help="write the table instead of comparing with it")
    parser.add_argument("cases", nargs="*", help=f"some of {', '.join(CASES)}")
    a = parser.parse_args()
    cases = a.cases or list(CASES)
    counts, isas, objects = measure_all(a.program, a.work, cases)
    here = machine(isas, objects)
    if a.record:
        commit = run(["git", "describe", "--always", "--dirty"]).strip()
        write_table(a.table, {"commit": commit, **here}, counts)
        print(a.table)
        return 0
    head, before = read_table(a.table)
    changed = [key for key, value in here.items() if differ(key, value, head.get(key))]
    if changed:
        for key in changed:
            print(f"{key}: {here[key]} (in the table: {head.get(key)})")
        print(f"{head['commit']} is built and counted on this machine")
        old = build_before(a.work, head["commit"])
        if not old:
            skip(f"{' and '.join(changed)} differ from the table, and {head['commit']} is not in the history here")
            return 0
        before, _, _ = measure_all(old, f"{a.work}/before", cases)
    too_many = compare(counts, before, head["commit"])
    if too_many:
        print(f"instructions: more than {LIMIT:.0%} above {head['commit']}: {', '.join(too_many)}", file=sys.stderr)
    return 1 if too_many else 0


if __name__ == "__main__":
    sys.exit(main())
