"""Random faults against the commands of attack_cases.py. Exit status 1 if a promise is broken.

    tests/fault/attack.py --program build/hifdm --seed N --kills 200 --calls 500 --flips 5000
    tests/fault/attack.py --program build/hifdm --seed N --only flips:37     repeats one case and prints the output

kills  A command that writes gets SIGKILL at a random moment. Files that were there before must be whole. The same
       command, or the same with --force where its file is there already, must then end with 0. Its files must be those
       of an undisturbed run, and no temporary file may remain.
calls  The n-th call of a random function of the system, or of memory, threads or processes, fails once (attack.c).
       For a quarter of the commands that write, SIGKILL follows. The command must give its usual exit status and
       result, or end with 5 and an error message. Then the same holds as for kills.
flips  One bit of a result, journal, ledger, merge or table is wrong, and a command reads it. The exit status must be
       a documented one, with a message that names a file. With 0, a figure may differ only if no checksum covers the
       bit, and `hifdm diff` must find each changed value. A file that is only read, or refused, must not change.

Kills and calls that struck nothing do not count. Cases are drawn until as many as asked for have struck.

Each case follows from the seed, its kind and its number. The moments of kills also depend on the machine, and so does
the content of files with times and of the result of a killed run. Cases and commands are in attack_cases.py. The script
needs x86-64, cc and h5py."""
import argparse
import collections
import concurrent.futures
import errno
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

import attack_cases as cases
from attack_files import has_changed, is_temporary, lapack_of, names_in, open_ranges, records_of, rows_of

HERE = Path(__file__).resolve().parent
LIMIT_S = 60  # a command that takes longer hangs
CALLS = re.findall(r'^ {4}\{"(\w+)"', (HERE / "attack.c").read_text(), re.M)
BY_BYTES = 64  # of the name of the library that made the call
COMMANDS = {**cases.WRITERS, **cases.OTHERS}
MISSED = ("ended before the kill", "not reached")
HDF5_CRASH = "HDF5 crashed when its set-up got no memory"
Told = collections.namedtuple("Told", "status out err")
Whole = collections.namedtuple("Whole", "told folder seconds counts")  # what an undisturbed command did


class Place:
    """A folder with all inputs, in which commands run. Its folder out/ is made again for each case."""

    def __init__(self, o, folder, base=None):
        self.o, self.folder, self.out, self.log, self.base = o, folder, folder / "out", [], base
        if base:
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(base, folder, ignore=shutil.ignore_patterns("out"))
        self.inputs = self.state_of_inputs()

    def state_of_inputs(self):
        return {p: (p.stat().st_mtime_ns, p.stat().st_size) for p in self.folder.rglob("*")
                if p.is_file() and self.out not in p.parents and p.name != "counts"}

    def prepare(self, before):
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir()
        for name, of in before.items():
            if of.startswith("-> "):
                (self.out / name).symlink_to(of[3:].format(point=min(self.folder.glob("s.d/*.h5")).name))
            else:
                (shutil.copytree if (self.folder / of).is_dir() else shutil.copy)(self.folder / of, self.out / name)

    def call(self, words, kill_s=None, attack=None):
        environment = dict(os.environ, OMP_NUM_THREADS="2")
        if attack:  # without the last two the program begins by starting itself again, where no handler is yet
            (self.folder / "counts").write_bytes(bytes(8 * (len(CALLS) + 1) + BY_BYTES))
            environment.update(LD_PRELOAD=str(self.o.library), ATTACK=attack, OMP_WAIT_POLICY="passive",
                               ATTACK_COUNTS=str(self.folder / "counts"), GOMP_SPINCOUNT="2000")
        child = subprocess.Popen([self.o.program, *words.split()], cwd=self.folder, env=environment,
                                 stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 start_new_session=True)
        try:
            if kill_s is not None:
                time.sleep(kill_s)
                child.kill()  # a copy of the program that lived on would hold the pipes
            out, err = child.communicate(timeout=LIMIT_S)
            told = Told(child.returncode, out.decode(errors="replace"), err.decode(errors="replace"))
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            told = Told("hangs", *(text.decode(errors="replace") for text in child.communicate()))
        self.log.append(f"{words} [{attack}]: {told.status}\n{told.out}{told.err}")
        return told

    def counts(self):
        data = (self.folder / "counts").read_bytes()
        counts = dict(zip([*CALLS, "struck"], struct.unpack_from(f"<{len(CALLS) + 1}q", data)))
        return {**counts, "by": data[-BY_BYTES:].split(b"\0")[0].decode()}

    def whole(self, folder, words, before, counts=False):
        """Runs the command undisturbed and keeps a copy of its files."""
        counted = {}
        if counts:
            self.prepare(before)
            self.call(words, attack="none 0 0")
            counted = self.counts()
        self.prepare(before)
        begin_s = time.time()
        told = self.call(words)
        seconds = time.time() - begin_s
        shutil.copytree(self.out, folder, symlinks=True)
        return Whole(told, folder, seconds, counted)

    # ---- what is wrong, as a list of words ----

    def is_same(self, path, other):
        if path.is_symlink() or other.is_symlink():
            return path.is_symlink() and other.is_symlink()
        if path.suffix == ".journal":
            return records_of(path) == records_of(other)
        if path.read_bytes() == other.read_bytes():
            return True
        return path.suffix == ".h5" and path.name != "m.h5" and self.call(f"diff {path} {other}").status == 0

    def differences(self, whole, skips=lambda name: False):
        """Returns the differences between out/ and the files of the undisturbed command."""
        here, there = ({n for n in names_in(folder) if not skips(n)} for folder in (self.out, whole.folder))
        wrong = [f"{name} is {'left' if name in here else 'missing'}" for name in sorted(here ^ there)]
        return wrong + [f"{name} is not that of the undisturbed command" for name in sorted(here & there)
                        if not self.is_same(self.out / name, whole.folder / name)]

    def losses(self, before, whole):
        """Returns the files that are neither whole nor unchanged, and earlier files that are missing."""
        wrong, earlier = [], [self.folder / of for of in before.values() if (self.folder / of).is_file()]
        for path in (self.out / name for name in sorted(names_in(self.out))):
            if is_temporary(path.name) or path.suffix == ".journal" or path.is_symlink() or any(
                    path.read_bytes() == p.read_bytes() for p in earlier):
                continue
            other = whole.folder / path.relative_to(self.out)
            is_result = path.suffix == ".h5" and path.name != "m.h5" and whole.told.status != 5
            if not (self.call(f"show {path}").status in (0, 3) if is_result else
                    other.exists() and self.is_same(path, other)):
                wrong.append(f"half of {path.name} has its name")
        for name, of in before.items():
            if not (self.out / name).exists() and not of.startswith("-> ") and not name.endswith(".journal"):
                wrong.append(f"{name}, which was there before, is gone")
        kept = [self.out / "a.h5", self.out / "a.h5.before-restart"]
        if "a.h5" in before and not any(p.exists() and p.read_bytes() == earlier[0].read_bytes() for p in kept):
            if not self.is_same(kept[0], whole.folder / "a.h5"):
                wrong.append("the earlier result is lost")
        return wrong

    def again(self, words, whole, is_told=False):
        """Runs the same command without a fault and returns what is wrong. is_told: a message said that the earlier
        result remains."""
        told = self.call(words)
        if told.status == 5 != whole.told.status and "--force" in told.err and not words.startswith(("run", "merge")):
            told = self.call(words + " --force")
        if is_told and told.status == 5 and "before-restart" in told.err:
            return []
        wrong = self.differences(whole)
        if told.status != whole.told.status:
            wrong = [f"{told.status}: {told.err.strip()[:300]}"]
        elif (whole.folder / "s.d").exists() and rows_of(self.out) != rows_of(whole.folder):
            wrong.append("the rows are not those of the undisturbed sweep")
        return [f"the same command afterwards: {w}" for w in wrong]


class Attack:
    """The three kinds of cases. Each returns what it did, the outcome, and what is wrong."""

    def __init__(self, o, root):
        self.o, self.root, self.ranges = o, root, {}
        self.base = Place(o, root / "base")
        self.make_base(self.base.folder)
        place = Place(o, root / "measured", self.base.folder)
        self.whole = {}
        for i, (name, (words, before, status)) in enumerate(COMMANDS.items()):
            self.whole[name] = place.whole(root / f"ref/{i}", words, before, counts=True)
            if self.whole[name].told.status != status:
                raise SystemExit(f"{words}: {self.whole[name].told}")

    def make_base(self, base):
        (base / "out").mkdir()
        for name, text in cases.FILES.items():
            (base / name).write_text(text)
        for words in cases.BASE:
            told = self.base.call(words)
            if told.status != 0:
                raise SystemExit(f"{words}: {told}")
        shutil.copytree(base / "s.d", base / "bare.d", ignore=shutil.ignore_patterns("*.tsv"))
        head, row = (line.split(",") for line in (base / "d.csv").read_text().splitlines())
        designs = [head, row]
        for i in (1, 2, 3):
            designs.append([row[0] + str(i), *(repr(float(x) * (1 + 0.01 * i)) for x in row[1:])])
        nodes = [line.split(",")[:4] for line in (base / "nodes.csv").read_text().splitlines()]
        measured = nodes[:1] + [[*n[:3], repr(float(n[3]) + i % 5 * 2e-4)] for i, n in enumerate(nodes[1:])]
        for name, table in (("d.csv", designs), ("m.csv", measured)):
            (base / name).write_text("".join(",".join(line) + "\n" for line in table))
        result, journal = base / "n.h5", base / "n.h5.journal"
        while not (result.exists() and journal.exists() and journal.stat().st_size > 3000):
            for path in base.glob("*n.h5*"):
                path.unlink()
            self.base.call(cases.KILLED, kill_s=random.uniform(0.02, 0.2))

    def kills(self, place, r):
        name = r.choice(list(cases.WRITERS))
        words, before, _ = COMMANDS[name]
        moment_s = r.uniform(0, 1.1) * self.whole[name].seconds
        place.prepare(before)
        told = place.call(words, kill_s=moment_s)
        wrong = [] if told.status in (0, -9) else [f"ended with {told.status} before the kill: {told.err[:300]}"]
        left = sorted({"a temporary file" if is_temporary(n) else "a journal" if n.endswith(".journal") else "files"
                       for n in names_in(place.out)})
        wrong += place.losses(before, self.whole[name]) + place.again(words, self.whole[name])
        outcome = f"killed, left {' and '.join(left) or 'nothing'}" if told.status else MISSED[0]
        return f"{name}, after {1e3 * moment_s:.1f} ms", outcome, wrong

    def calls(self, place, r):
        name = r.choice(list(COMMANDS))
        words, before, status = COMMANDS[name]
        whole = self.whole[name]
        call = r.choice([c for c in CALLS if whole.counts[c]])
        error = r.choice(cases.ERRORS.get(call, cases.DEFAULT_ERRORS).split())
        n = r.choice([r.randint(1, whole.counts[call]), int(whole.counts[call] ** r.random())])
        kill_s = r.uniform(0.1, 1.5) * whole.seconds if name in cases.WRITERS and r.random() < 0.25 else None
        place.prepare(before)
        told = place.call(words, kill_s, f"{call} {n} {getattr(errno, error)}")
        counts, wrong = place.counts(), []
        outcome = "refused with words" if told.status == 5 else "same result"
        is_own = call in ("open", "stat") and "Permission denied" in told.err  # the user may not read the case
        if kill_s is not None and told.status == -9:
            outcome = "killed then"
        elif "libhdf5" in counts["by"] and told.status == -11:
            outcome = HDF5_CRASH
        elif told.status not in (status, 5) and not (told.status == 2 and is_own):
            wrong.append(f"exit status {told.status}: {told.err.strip()[:300]}")
        elif told.status != status and "error: " not in told.err:
            wrong.append(f"exit status {told.status} without words: {told.err[:300]!r}")
        elif told.status == 5 and status != 5 and not counts["struck"]:
            wrong.append(f"exit status 5 without a fault: {told.err.strip()[:300]}")
        elif told.status == status and status != 5:  # what could not be removed; the same command does it
            wrong += place.differences(whole, lambda n: n.endswith(".journal") or "cannot remove" in told.err and (
                is_temporary(n) or "before-restart" in n))
            if told.out != whole.told.out and name != "check":  # its time differs
                wrong.append(f"exit status {status}, but what is printed differs: {told.out[:200]!r}")
        wrong += place.losses(before, whole)
        for kept in re.findall(r"this run's result is (\S+\.h5)", told.err):
            (place.folder / kept).unlink()
        wrong += place.again(words, whole, "cannot remove the earlier result" in told.err)
        return (f"{name}, {call} {n} of {whole.counts[call]}, {error}{', then a kill' if kill_s else ''}",
                outcome if counts["struck"] else MISSED[1], wrong)

    def flips(self, place, r):
        source = r.choices(list(cases.DAMAGED), [len(d[2]) + 2 for d in cases.DAMAGED.values()])[0]
        pattern, before, commands = cases.DAMAGED[source]
        place.prepare(before)
        path = r.choice(sorted(place.out.glob(pattern)))
        name, (top, *rest) = str(path.relative_to(place.out)), path.relative_to(place.out).parts
        original = "/".join([before[top], *rest])
        words = r.choice(commands).format(f"out/{name}", original)
        if (words, name) not in place.known:
            folder = self.root / f"ref/{place.folder.name}-{len(place.known)}"
            place.known[words, name] = place.whole(folder, words, before)
            place.prepare(before)
        data, is_hdf5 = bytearray(path.read_bytes()), name.endswith(".h5")
        if is_hdf5 and original not in self.ranges:
            self.ranges[original] = open_ranges(place.folder / original)
        ranges = self.ranges[original] if is_hdf5 else [] if name.endswith(".journal") else [(0, len(data), "")]
        spots = (r.randrange(len(data)) for _ in range(1000))
        if is_hdf5 and r.random() < 0.6:  # most bytes are values
            at = next((s for s in spots if not any(low <= s < high for low, high, _ in ranges)), 0)
        else:
            at = next(spots)
        bit = r.randrange(8)
        data[at] ^= 1 << bit
        path.write_bytes(data)
        inside = [of for low, high, of in ranges if low <= at < high]
        told = place.call(words)
        wrong = judge_flip(place, source, words, place.known[words, name], told, path, bytes(data), inside)
        outcome = "not noticed" if inside else "same result"
        outcome = {0: outcome, 1: "found by diff"}.get(told.status, "refused with words")
        where = "no checksum" if inside else "with a checksum"
        return f"{source}, {name} byte {at} bit {bit} ({where}), {words}", f"{where}: {outcome}", wrong

    def one(self, kind, number, place):
        place.log.clear()
        done, outcome, wrong = getattr(self, kind)(place, random.Random(f"{self.o.seed} {kind} {number}"))
        if place.state_of_inputs() != place.inputs:
            wrong.append("an input was changed")
            place.__init__(self.o, place.folder, place.base)
        return kind, number, done, outcome, wrong


def judge_flip(place, source, words, whole, told, path, data, inside):
    """Returns what is wrong with the end of a command that read a damaged file."""
    command, wrong, is_table = words.split()[0], [], path.suffix == ".csv"
    may_write = command in ("run", "recover", "sweep", "tolerance") or source == "merge" and command == "merge"
    allowed = {0, 5} | {"diff": {1}, "sweep": {3}, "adjust": {2}}.get(command, set())
    allowed |= {2, 3, 4} if is_table else set()
    is_exact = not inside or may_write and source in ("ledger", "merge")
    is_kept = path.exists() and path.read_bytes() == data
    is_told = command == "recover" and "is damaged" in told.err  # what a damaged journal had counts for nothing
    if told.status not in allowed:
        wrong.append(f"exit status {told.status}: {told.err.strip()[:300]}")
    elif told.status in (2, 4, 5) and not re.search(r"error: [^\n]*(out/|\.h5|\.csv|\.yaml|s\.d)", told.err):
        wrong.append(f"exit status {told.status} without words that name a file: {told.err[:300]!r}")
    elif not inside and told.status == 1:
        wrong.append(f"a checksum should have found: {told.out[:300]}")
    elif told.status == whole.told.status and not is_told and is_exact:
        wrong += place.differences(whole, lambda n: is_kept and n == str(path.relative_to(place.out)))
        if told.out != whole.told.out:
            wrong.append(f"exit status {told.status}, but what is printed differs: {told.out[:200]!r}")
        if source == "point" and command == "sweep" and rows_of(place.out) != rows_of(whole.folder):
            wrong.append("the rows are not those of the undisturbed sweep")
    if command == "diff" and told.status == 0 and any(of and has_changed(place.folder, words, of) for of in inside):
        wrong.append("`hifdm diff` finds no difference")
    if not is_kept and (not may_write or told.status == 5):
        wrong.append("the damaged file was changed")
    return wrong + [f"{n} is left" for n in names_in(place.out) if is_temporary(n)]


def machine(o, root):
    """Returns what was attacked, how, and on which machine."""
    said = subprocess.run([o.program, "version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]
    processor = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M)
    return [f"{said}; attack.py --seed {o.seed} --kills {o.kills} --calls {o.calls} --flips {o.flips}",
            f"{processor.group(1) if processor else 'unknown'}, {os.cpu_count()} cores; Linux {os.uname().release}; "
            f"{lapack_of(root / 'base/r.h5')}", ""]


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", default="build/hifdm")
    options.add_argument("--out", default="build/attack", help="the folder to work in")
    options.add_argument("--seed", type=lambda text: int(text, 0), default=int(time.time()))
    for kind, n in (("kills", 200), ("calls", 500), ("flips", 5000)):
        options.add_argument(f"--{kind}", type=int, default=n)
    options.add_argument("--jobs", type=int, default=2)
    options.add_argument("--log", help="a file for what is printed")
    options.add_argument("--only", help="KIND:NUMBER")
    o = options.parse_args()
    root, start = Path(o.out).resolve(), time.time()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    shutil.rmtree(root, ignore_errors=True)
    for folder in ("base", "ref"):
        (root / folder).mkdir(parents=True)
    o.library = root / "attack.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-w", HERE / "attack.c", "-o", o.library, "-ldl"], check=True)
    o.program = shutil.copy(o.program, root / "hifdm")  # a build meanwhile does not disturb
    attack = Attack(o, root)
    if o.only:
        o.jobs = 1
    places = [Place(o, root / str(i), root / "base") for i in range(o.jobs)]
    for place in places:
        place.known = {}

    def work(i):
        if o.only:
            kind, number = o.only.split(":")
            return [attack.one(kind, int(number), places[i])]
        found = []
        for kind in ("kills", "calls", "flips"):
            struck, number = 0, i
            while struck < len(range(i, getattr(o, kind), o.jobs)):
                found.append(attack.one(kind, number, places[i]))
                struck, number = struck + (found[-1][3] not in MISSED), number + o.jobs
        return found

    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        found = [case for part in pool.map(work, range(o.jobs)) for case in part]
    lines = machine(o, root)
    for kind, number, done, outcome, wrong in found:
        lines += [f"violation: seed {o.seed}, {kind}:{number}, {done}: {' '.join(words.split())}" for words in wrong]
        if o.only:
            lines += [f"{kind}:{number}, {done}: {outcome}", *places[0].log]
    lines += [f"{kind}  {n:5}  {outcome}"
              for (kind, outcome), n in sorted(collections.Counter((case[0], case[3]) for case in found).items())]
    n_wrong, n_struck = sum(bool(case[4]) for case in found), sum(case[3] not in MISSED for case in found)
    lines.append(f"{n_struck} cases, {n_wrong} with violations, {time.time() - start:.0f} s")
    print("\n".join(lines))
    if o.log:
        Path(o.log).write_text("\n".join(lines) + "\n")
    sys.exit(1 if n_wrong else 0)


if __name__ == "__main__":
    main()
