"""Damages result files and runs every command that reads one: fuzz_results.py --program build/asan/hifdm --n 5000

A run is one mutant (mutate_results.py; for a journal or a ledger, of its bytes) and one command. Each command must end
by itself within LIMIT_S. Its exit status must be in the manual and, unless it is 0, a message must name the file. A
signal, a failed assertion or a report of a sanitizer is a failure. Mutant and command follow from the seed and the
number of the run. --only NUMBER repeats one run and keeps its files."""
import argparse
import collections
import os
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import time
import zlib

import mutate_results

LIMIT_S = 60
STATUS = {0, 1, 2, 3, 4, 5, 75}
NET = """scene:
  parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, modules: [2, 3], cells_per_module: [2, 2],
    scallop: 0.1}
  EA_inner_N: 1e5
  EA_boundary_N: 1e5
"""
GA = "optimize: {population: 6, generations: %d, seed: 7, refine_steps: 3}\n"
CASES = {
    "ga": NET + GA % 4 + "surface: {frequencies_Hz: [1e9, 3e10]}\n",
    "truss": NET + "truss: {}\n" + GA % 3,
    "form": NET,
    "night": NET + (GA % 20000).replace("seed", "stagnation_generations: 20000, seed"),  # a second or more
}
STUDY = "base: ga.yaml\nsweep:\n  form.pretension_N: [8, 9, 10]\n  form.method: [hifdm]\n"


class Fuzz:
    def __init__(self, program, folder):
        self.program, self.folder = os.path.abspath(program), os.path.abspath(folder)
        self.work = os.path.join(self.folder, "work")
        self.base = os.path.join(self.folder, "base")
        self.environment = dict(os.environ, OMP_NUM_THREADS="2", TMPDIR=self.folder,
                                ASAN_OPTIONS="detect_leaks=0:exitcode=99:handle_segv=0:handle_abort=0:handle_sigfpe=0:"
                                "allocator_may_return_null=1:max_allocation_size_mb=4000",
                                UBSAN_OPTIONS="print_stacktrace=1:exitcode=99")

    def run(self, *words, cwd=None):
        """Returns (exit status, output). The status is 'late' for a command that does not end."""
        child = subprocess.Popen([self.program, *words], cwd=cwd or self.work, env=self.environment,
                                 stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 start_new_session=True)
        try:
            out, err = child.communicate(timeout=LIMIT_S)
            status = child.returncode
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            out, err = child.communicate()
            status = "late"
        return status, out.decode(errors="replace"), err.decode(errors="replace")

    # ---- what is damaged ----

    def make_base(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        os.makedirs(self.base)
        for name, text in CASES.items():
            with open(os.path.join(self.base, name + ".yaml"), "w") as file:
                file.write(text)
        with open(os.path.join(self.base, "study.yaml"), "w") as file:
            file.write(STUDY)
        for name in ("ga", "truss", "form"):
            self.demand("run", name + ".yaml", "--quiet")
        self.demand("sweep", "study.yaml", "--quiet")
        self.demand("merge", "study.yaml", "--quiet")
        self.interrupt()

    def demand(self, *words):
        status, out, err = self.run(*words, cwd=self.base)
        assert status == 0, f"{words}: {status}\n{out}{err}"

    def interrupt(self):
        """Makes night.h5, unfinished with generations, and dusk.h5, the same with a journal of further generations."""
        path, journal = (os.path.join(self.base, "night.h5" + ending) for ending in ("", ".journal"))
        for attempt in range(100):
            for name in (path, journal):
                if os.path.exists(name):
                    os.remove(name)
            if self.stop_at(journal, 10000, signal.SIGTERM) != 75:
                continue
            shutil.copy(path, os.path.join(self.base, "dusk.h5"))
            if self.stop_at(os.path.join(self.base, "dusk.h5.journal"), 10000, signal.SIGKILL, "dusk.h5") == -9:
                if size_of(os.path.join(self.base, "dusk.h5.journal")) > 1000:
                    return
        raise SystemExit("no run could be interrupted")

    def stop_at(self, journal, size, number, output="night.h5"):
        child = subprocess.Popen([self.program, "run", "night.yaml", "-o", output, "--quiet"], cwd=self.base,
                                 env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while child.poll() is None and size_of(journal) < size:
            pass
        child.send_signal(number)
        return child.wait()

    # ---- one run ----

    def prepare(self):
        """Makes a new folder. All its files are links to those of the base, until one is damaged or replaced."""
        shutil.rmtree(self.work, ignore_errors=True)
        shutil.copytree(self.base, self.work, copy_function=link_or_copy)
        os.mkfifo(os.path.join(self.work, "fifo"))

    def own(self, name):
        """Copies the files that a command may write into. Returns the path of the first."""
        for ending in ("", ".journal"):
            path = os.path.join(self.work, name + ending)
            if os.path.exists(path):
                os.remove(path)
                shutil.copy(os.path.join(self.base, name + ending), path)
        return os.path.join(self.work, name)

    def plan(self, r):
        """Returns (file to damage, kind of damage, command line)."""
        name = r.choice(["ga", "ga", "truss", "night", "dusk", "study", "point", "journal", "ledger"])
        if name == "journal":
            return "dusk.h5.journal", "journal", r.choice(
                [["recover", "dusk.h5"], ["run", "night.yaml", "-o", "dusk.h5", "--quiet"]])
        if name == "ledger":
            rows = [f for f in os.listdir(os.path.join(self.work, "study.d")) if f.endswith(".tsv")][0]
            return "study.d/" + rows, "ledger", r.choice(
                [["status", "study.yaml"], ["status", "study.yaml", "--json"], ["merge", "study.yaml", "-o", "m.h5"],
                 ["sweep", "study.yaml", "--quiet"]])
        if name == "point":
            point = sorted(f for f in os.listdir(os.path.join(self.work, "study.d")) if f.endswith(".h5"))[0]
            if r.random() < 0.5:  # the ledger does not know the point: it is begun, for all the sweep can tell
                for row in os.listdir(os.path.join(self.work, "study.d")):
                    if row.endswith(".tsv"):
                        os.remove(os.path.join(self.work, "study.d", row))
            return "study.d/" + point, "hdf5", r.choice(
                [["status", "study.yaml"], ["merge", "study.yaml", "-o", "m.h5"], ["sweep", "study.yaml", "--quiet"]])
        file = name + ".h5"
        case = "night.yaml" if name in ("night", "dusk") else name + ".yaml"
        again = ["run", case, "-o", file, "--quiet"]
        commands = [["show", file], ["show", file, "--json"], ["diff", file, "orig.h5"], ["diff", "orig.h5", file],
                    ["diff", file, file, "--rtol", "1e-9"], ["report", file, "-o", "page.html"],
                    ["export", file, "--csv", "csv"], ["export", file, "--vtk", "vtk"],
                    ["export", file, "--cutlist", "cut.csv"], ["export", file, "--csv", "csv", "--stage", "form"],
                    ["recover", file], ["evaluate", "form.yaml", "--designs", file]]
        if name == "study":
            again = ["merge", "study.yaml", "-o", file]
        weight = 6 if name in ("night", "dusk") else 2
        return file, "hdf5", r.choice(commands + [again] * weight)

    def one(self, number, seed):
        r = random.Random(f"{seed} {number}")
        self.prepare()
        file, kind, command = self.plan(r)
        path = self.own(file.replace(".journal", ""))
        if kind == "journal":
            path += ".journal"
        os.link(os.path.join(self.base, file), os.path.join(self.work, "orig.h5"))
        damage = {"hdf5": mutate_results.mutate, "journal": mutate_journal, "ledger": mutate_ledger}[kind](
            path, f"{seed} {number}")
        status, out, err = self.run(*command)
        return file, damage, command, status, out, err


def link_or_copy(source, target):
    """Makes a link; copies the lock file of a sweep, which may have only one name."""
    return (shutil.copy if os.path.basename(source) == "claims" else os.link)(source, target)


def size_of(path):
    try:
        return os.path.getsize(path)
    except FileNotFoundError:
        return 0


def mutate_bytes(data, r):
    n = len(data)
    kind = r.choice(["flip", "zero", "cut", "copy", "short", "append"])
    at, size = r.randrange(n), r.choice([1, 4, 30, 1000])
    if kind == "flip":
        for _ in range(r.choice([1, 3, 50])):
            data[r.randrange(n)] = r.randrange(256)
    elif kind == "zero":
        data[at:at + size] = bytes(len(data[at:at + size]))
    elif kind == "cut":
        del data[at:at + size]
    elif kind == "copy":
        to = r.randrange(n)
        data[to:to] = data[at:at + size]
    elif kind == "short":
        del data[at:]
    else:
        data += r.randbytes(size)
    return kind


def write(path, data):
    with open(path, "wb") as file:
        file.write(data)


def mutate_journal(path, seed):
    """Damages bytes, or records so that their checksums are right: other payloads, lengths, generations or order."""
    r = random.Random(seed)
    with open(path, "rb") as file:
        data = bytearray(file.read())
    if r.random() < 0.3:
        words = mutate_bytes(data, r)
        write(path, data)
        return "bytes: " + words
    head, records, at = data[:72], [], 72
    while at + 16 <= len(data):
        length = struct.unpack_from("<I", data, at + 4)[0]
        records.append((struct.unpack_from("<i", data, at + 12)[0], data[at + 16:at + 12 + length]))
        at += 12 + length
    kind = r.choice(["payload", "payload", "numbers", "length", "generation", "order", "many", "empty", "identity"])
    i = r.randrange(len(records))
    generation, payload = records[i]
    if kind == "payload":
        for _ in range(r.choice([1, 4, 100])):
            payload[r.randrange(8, len(payload))] = r.randrange(256)
    elif kind == "numbers":
        for _ in range(r.choice([1, 10])):
            at = r.randrange(8, len(payload) - 8)
            payload[at:at + 8] = struct.pack("<d", r.choice(mutate_results.REALS))
    elif kind == "length":
        payload[:] = payload[:r.randrange(len(payload))] if r.random() < 0.5 else payload + r.randbytes(100)
    elif kind == "generation":
        generation = r.choice([-1, 0, 2**31 - 1, -(2**31), generation + 1, 4000])
    elif kind == "order":
        r.shuffle(records)
        generation, payload = records[i]
    elif kind == "many":
        records += records * 20
    elif kind == "empty":
        payload.clear()
    else:
        head[r.randrange(8, 72)] = r.randrange(256)
    records[i] = (generation, payload)
    data = bytes(head)
    for generation, payload in records:
        body = struct.pack("<i", generation) + bytes(payload)
        data += struct.pack("<III", 0x4A444648, len(body), zlib.crc32(body)) + body
    write(path, data)
    return "records: " + kind


def mutate_ledger(path, seed):
    r = random.Random(seed)
    with open(path, "rb") as file:
        data = bytearray(file.read())
    if r.random() < 0.4:
        words = mutate_bytes(data, r)
        write(path, data)
        return "bytes: " + words
    lines = [line.split(b"\t") for line in bytes(data).split(b"\n")]
    kind = r.choice(["field", "field", "field", "column", "line", "long", "many"])
    values = [b"", b"nan", b"inf", b"-1", b"1e999", b"99999999999999999999", b"ok", b"\xff\xfe", b"\x00", b"x" * 20000,
              b"=cmd|'/c calc'!A1", b"\x1b[31m", b"0x10", b"  3", b"not_finite", b"io", b"interrupted"]
    i = r.randrange(len(lines))
    k = r.randrange(len(lines[i]))
    if kind == "field":
        lines[i][k] = r.choice(values)
    elif kind == "column":
        for line in lines:
            if k < len(line):
                del line[k]
    elif kind == "line":
        lines[i] = lines[i][:k]
    elif kind == "long":
        lines[i] += [b"1"] * 2000
    else:
        lines += lines * 50
    write(path, b"\n".join(b"\t".join(line) for line in lines))
    return "rows: " + kind


# ---- judging ----


def fault(file, command, status, out, err):
    """Returns what is wrong with the end of a run, or None."""
    if status == "late":
        return "does not end"
    report = re.search(r"(ERROR: \w+Sanitizer: [\w-]+|runtime error: [^\n]{,80}|Assertion [^\n]{,120})", err)
    if report and "ended by" not in err:
        return report.group(1)
    if status not in STATUS:
        return f"exit status {status}"
    if status == 3 and command[0] == "sweep":
        return None  # the point has failed; `hifdm status` names its file
    names = [os.path.basename(file).split(".h5")[0]] + (["study.d"] if file.endswith(".tsv") else [])
    if status not in (0, 1) and not any(name in err + out for name in names):
        return f"exit status {status} without the name of the file"
    if status not in (0, 1) and not re.search("^(error|usage|warning)", err, re.M):
        return f"exit status {status} without words"
    return None


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--program", default="build/asan/hifdm")
    options.add_argument("--n", type=int, default=5000)
    options.add_argument("--first", type=int, default=0)
    options.add_argument("--seed", default=str(int(time.time())))
    options.add_argument("--only", type=int)
    options.add_argument("--seconds", type=float, help="begin no run after this time")
    options.add_argument("--out", default="build/fuzz/results")
    o = options.parse_args()
    fuzz = Fuzz(o.program, o.out)
    fuzz.make_base()
    statuses, faults, caught = collections.Counter(), collections.Counter(), 0
    start = time.time()
    print(f"seed {o.seed}", flush=True)
    for number in [o.only] if o.only is not None else range(o.first, o.first + o.n):
        if o.seconds and time.time() - start > o.seconds:
            break
        file, damage, command, status, out, err = fuzz.one(number, o.seed)
        statuses[status] += 1
        caught += "ended by signal" in err
        if number % 250 == 249 and o.only is None:
            print(f"  {number + 1}: {dict(sorted(statuses.items(), key=str))}, {caught} survived", flush=True)
        wrong = fault(file, command, status, out, err)
        if wrong or o.only is not None:
            print(f"{number}: hifdm {' '.join(command)}  # {file}: {damage}\n  {wrong}: {status}", flush=True)
        if wrong:
            faults[re.sub(r"0x[0-9a-f]+|\d{3,}", "#", wrong)] += 1
            print("    " + "\n    ".join(err.splitlines()[:40 if o.only is not None else 14]), flush=True)
        elif o.only is not None:
            print(out[:2000] + err[:6000])
    print(f"seed {o.seed}: {sum(statuses.values())} runs in {time.time() - start:.0f} s; exit statuses "
          f"{dict(sorted(statuses.items(), key=str))}\n"
          f"{caught} crashes of HDF5 survived; {sum(faults.values())} faults")
    for wrong, n in faults.most_common():
        print(f"  {n} x {wrong}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
