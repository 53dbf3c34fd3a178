"""Checks faults x stages and commands: the table of src/manual/faults.md against the program.

    table.py --check            checks that the table has a row for each stage, command and fault; measures nothing
    table.py --check --measure  also measures few points of each fault, which must end as in the table (3 minutes)
    table.py --check --full     measures many points
    table.py --write [--full]   measures and writes the table; --fault and --row WORD measure some cells again

A full disk is a small tmpfs, and another mount is read-only. The script therefore needs root, or user namespaces."""
import argparse
import collections
import concurrent.futures
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import faults
from attack_files import lapack_of

BEGIN, END = "<!-- tests/fault/table.py --write: begin -->", "<!-- tests/fault/table.py --write: end -->"
HEAD = "| fault | stage or command | exit status | what remains | the same command afterwards |"
WRITES_NOTHING = "writes nothing"
NO_CALL = "no such call"
PLACES = {"reduced": 3, "full": 24}


def cells():
    return [(fault, row) for fault, f in faults.FAULTS.items() for row in faults.ROWS if f.applies(row)]


# ---- the table as text ----

def order(words):
    """Sorts words: `nothing` and `completes` first, then numbers by size and words alphabetically."""
    return sorted(words, key=lambda w: (w not in ("nothing", "completes"), not w[0].isdigit(),
                                        int(re.match(r"\d+", w).group()) if w[0].isdigit() else 0, w))


def columns(outcome, row):
    exits, remains, after = outcome
    if not exits:
        return NO_CALL, "-", "-"
    return (" or ".join(order(exits)), " or ".join(order(remains)) if row.writes else WRITES_NOTHING,
            " or ".join(order(after)) or "not needed")


def text_of(outcomes, measured_with):
    """Returns the table. Rows of the same fault with the same outcome share a line."""
    lines = [measured_with, "", HEAD, "|---|---|---|---|---|"]
    for fault in faults.FAULTS:
        alike = collections.OrderedDict()
        for row in faults.ROWS:
            if (fault, row.name) in outcomes:
                alike.setdefault(columns(outcomes[fault, row.name], row), []).append(row.name)
        lines += [f"| {fault} | {'; '.join(names)} | {' | '.join(cell)} |" for cell, names in alike.items()]
    return "\n".join(lines)


def read(manual):
    """Reads the table of the manual. Returns {(fault, row): outcome} and the line that says what it was measured
    with."""
    text = manual.read_text(encoding="utf-8")
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        sys.exit(f"{manual}: has no place for the table: {BEGIN}")
    lines = text[text.index(BEGIN) + len(BEGIN):text.index(END)].strip().split("\n")
    outcomes = {}
    for line in lines:
        cell = [c.strip() for c in line.strip("|").split("|")]
        if not line.startswith("|") or len(cell) != 5 or line == HEAD or cell[0].startswith("--"):
            continue
        for name in cell[1].split("; "):
            if (cell[0], name) in outcomes:
                sys.exit(f"{manual}: the table has two rows of {cell[0]}, {name}")
            outcomes[cell[0], name] = tuple(set(c.split(" or ")) - {WRITES_NOTHING, NO_CALL, "not needed", "-"}
                                            for c in cell[2:])
    return outcomes, lines[0]


def write(manual, outcomes, measured_with):
    text = manual.read_text(encoding="utf-8")
    begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    manual.write_text(f"{text[:begin]}\n{text_of(outcomes, measured_with)}\n{text[end:]}", encoding="utf-8")


# ---- the table against the program ----

def said_by(program, *words):
    return subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout


def missing_rows(program):
    """Returns what the program has and ROWS does not have."""
    names, wrong = {row.name for row in faults.ROWS}, []
    covered = {row.words[0] for row in faults.ROWS}
    commands = re.findall(r"^  hifdm (\w+)", said_by(program, "help"), re.M)
    schema = said_by(program, "schema")
    sections = re.findall(r"^(\w+):", schema, re.M)
    methods = re.search(r"# (.*)\n  method: ga$", schema, re.M).group(1).split(" | ")
    if len(commands) < 10 or len(sections) < 10:
        wrong.append("hifdm help and hifdm schema do not list commands and sections as they did")
    wrong += [f"the command `{c}` has no row in tests/fault/faults.py" for c in commands if c not in covered]
    for what, found, known in (("section", sections, faults.SECTIONS), ("method", methods, faults.METHODS)):
        wrong += [f"the {what} `{w}` is not in tests/fault/faults.py" for w in found if w not in known]
        wrong += [f"the {what} `{w}` has no row in tests/fault/faults.py: {known[w]}" for w in found
                  if w in known and known[w] and known[w] not in names]
    return wrong


def wrong_table(outcomes, manual, measured_with):
    """Returns how the rows of the manual differ from those of the script."""
    wanted = {(fault, row.name) for fault, row in cells()}
    wrong = [f"{manual}: no row of {fault}, {name}" for fault, name in sorted(wanted - set(outcomes))]
    wrong += [f"{manual}: {fault}, {name} is no cell of tests/fault/faults.py"
              for fault, name in sorted(set(outcomes) - wanted)]
    text = manual.read_text(encoding="utf-8")
    if not wrong and text_of(outcomes, measured_with) != text[text.index(BEGIN) + len(BEGIN):text.index(END)].strip():
        wrong.append(f"{manual}: the table is not as `table.py --write` writes it")
    for word in ("LAPACK", "file system"):
        if word not in measured_with:
            wrong.append(f"{manual}: the table does not name the {word} that it was measured with")
    return wrong


def differences(outcomes, measured):
    """Returns what was measured and is not in the table."""
    wrong = []
    for (fault, name), outcome in measured.items():
        for what, seen, known in zip(("exit status", "left", "the same command"), outcome,
                                     outcomes.get((fault, name), (set(), set(), set()))):
            wrong += [f"{fault}, {name}: {what}: {word}: is not in the manual" for word in order(seen - known)]
    return wrong


# ---- measuring ----

def measured_with(program, folder):
    """Returns a line about the machine."""
    blas = [os.path.realpath(p) for p in Path("/etc/alternatives").glob("libblas.so.3-*")]
    named = ", ".join([lapack_of(folder / "base/r.h5"), *("/".join(p.split("/")[-2:]) for p in blas)])
    kind = subprocess.run(["findmnt", "-n", "-o", "FSTYPE", "-T", folder], capture_output=True, text=True,
                          check=True).stdout.strip()
    version = said_by(program, "version").split()[1]
    return (f"Measured with hifdm {version} on {os.uname().machine}; LAPACK and BLAS: {named}; "
            f"file system: {kind}, and tmpfs where it is full or read-only.")


def measure_row(program, folder, row, chosen, most, library):
    bench = faults.Bench(program, folder, library, most)
    outcomes = {}
    bench.take(row)
    for fault in chosen:
        outcomes[fault, row.name] = bench.cell(fault)
        print(f"{fault:50} {row.name:20} " + " | ".join(columns(outcomes[fault, row.name], row)), flush=True)
    return outcomes, bench.wrong


def measure(program, folder, chosen, most):
    """Returns {(fault, row): outcome}, and what is wrong whatever the table says."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    if most == PLACES["reduced"]:  # many small files: in memory
        subprocess.run(["mount", "-t", "tmpfs", "none", folder], check=True)
    library = folder / "machine.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-w", faults.HERE / "machine.c", "-o", library, "-ldl"],
                   check=True)
    program = shutil.copy(program, folder / "hifdm")  # a build meanwhile does not disturb
    faults.Bench(program, folder / "0", library, most).make_base()
    outcomes, wrong = {}, []
    rows = [row for row in faults.ROWS if any(r is row for _, r in chosen)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        jobs = [pool.submit(measure_row, program, folder / str(i), row, [f for f, r in chosen if r is row], most,
                            library) for i, row in enumerate(rows)]
        for job in jobs:
            more, faults_found = job.result()
            outcomes.update(more)
            wrong += faults_found
    return outcomes, wrong


def in_own_mounts():
    """Starts the script again where it may mount; the mounts end with it. Returns False if the machine allows no
    mounts."""
    if "HIFDM_FAULT_TABLE" in os.environ:
        return True
    os.environ["HIFDM_FAULT_TABLE"] = "1"
    how = ["unshare", *(["--user", "--map-root-user"] if os.geteuid() else []), "--mount", "--"]
    test = subprocess.run([*how, "mount", "-t", "tmpfs", "none", "/mnt"], capture_output=True, text=True, check=False)
    if test.returncode != 0:
        tell_skipped(f"tests/fault/table.py: this machine lets nobody mount: {test.stderr.strip()}")
        return False
    os.execvp(how[0], [*how, sys.executable, *sys.argv])


def tell_skipped(words):
    print(f"skipped: {words}")
    if os.environ.get("HIFDM_SKIPPED"):
        with open(os.environ["HIFDM_SKIPPED"], "a", encoding="utf-8") as file:
            file.write(words + "\n")


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--program", default="build/hifdm")
    options.add_argument("--manual", default=str(faults.HERE.parent.parent / "src/manual/faults.md"))
    options.add_argument("--out", default="build/fault-table")
    for name in ("--check", "--write", "--measure", "--full"):
        options.add_argument(name, action="store_true")
    options.add_argument("--add", action="store_true", help="with --write: to what the table has already")
    options.add_argument("--fault", default="")
    options.add_argument("--row", default="")
    o = options.parse_args()
    start, manual, program = time.time(), Path(o.manual), os.path.abspath(o.program)
    measures = (not o.check or o.measure or o.full) and in_own_mounts()
    outcomes, machine = read(manual)
    wrong = missing_rows(program)
    if o.check:
        wrong += wrong_table(outcomes, manual, machine)
    if measures:
        chosen = [(fault, row) for fault, row in cells() if o.fault in fault and o.row in row.name]
        if os.environ.get("HIFDM_FAULT_TABLE") and not can_chown(Path(o.out)):
            tell_skipped("tests/fault/table.py: links of another user: needs root")
            chosen = [(fault, row) for fault, row in chosen if fault != "link of another user"]
        folder = Path(o.out).resolve()
        measured, more = measure(program, folder, chosen, PLACES["full" if o.full else "reduced"])
        wrong += more
        if o.write:
            wanted = {(fault, row.name) for fault, row in cells()}
            for key in measured.keys() & outcomes.keys() if o.add else ():
                measured[key] = tuple(a | b for a, b in zip(measured[key], outcomes[key]))
            merged = {key: outcome for key, outcome in {**outcomes, **measured}.items() if key in wanted}
            write(manual, merged, measured_with(program, folder))
        else:
            wrong += differences(outcomes, measured)
    for line in wrong:
        print(f"wrong: {line}", file=sys.stderr)
    print(f"{len(cells())} cells, {len(wrong)} wrong, {time.time() - start:.0f} s")
    sys.exit(1 if wrong else 0)


def can_chown(folder):
    folder.mkdir(parents=True, exist_ok=True)
    trial = folder / "owner"
    trial.write_text("")
    try:
        os.chown(trial, 65534, 65534)
        return True
    except OSError:
        return False
    finally:
        trial.unlink()


if __name__ == "__main__":
    main()
