"""What table.py measures: the commands (ROWS), the faults (FAULTS), and a Bench that applies a fault to a command."""
import os
import random
import re
import shutil
import signal
import subprocess
from pathlib import Path

from attack_files import attributes_of, rows_of

HERE = Path(__file__).resolve().parent
LIMIT_S = 60  # a command that takes longer hangs
SCENE = """scene:
  parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, modules: [2, 3], cells_per_module: [2, 2],
    scallop: 0.1}
  EA_inner_N: 1e5
  EA_boundary_N: 1e5
"""
GA = "optimize: {population: 20, generations: %d, seed: 7, refine: false%s}\n"
LM = "optimize: {seed: 7, method: lm, refine_steps: 4%s}\n"
OBJECTIVES = ", front: [{figure: psi}, {figure: ratio, set: boundary}]"
STATES = """cables:
  - {expansion_per_K: -1e-6}
load_cases:
  - {name: cold, temperature_K: -100, part: net}
  - {name: hot, temperature_K: 100, part: net}
"""
FIELD = "surface: {frequencies_Hz: [1e9], pattern: {theta_deg: [-2, 2], n_theta: 11}}\n"
SAMPLES = "tolerance: {sigma_cut_m: 1e-4, samples: 3000}\n"
ADJUST = """tolerance: {sigma_cut_m: 1e-3, samples: 100}
adjust: {set: inner, range_m: 0.002, step_m: 1e-4, max_adjustments: 2, sigma_m: 1e-4}
"""
FILES = {
    "form.yaml": SCENE,
    "ga.yaml": SCENE + GA % (30, ""),
    "nsga.yaml": SCENE + GA % (20, OBJECTIVES),
    "lm.yaml": SCENE + LM % "",
    "more.yaml": SCENE + "optimize: {seed: 7, method: lm, refine_steps: 1}\n",
    "front.yaml": SCENE + LM % (OBJECTIVES + ", front_points: 4"),
    "states.yaml": SCENE + STATES,
    "field.yaml": SCENE + FIELD,
    "samples.yaml": SCENE + SAMPLES,
    "all.yaml": SCENE + "truss: {E_Pa: 2e9}\nform: {pretension_N: 20}\n" + STATES + SAMPLES +
    "optimize: {population: 8, generations: 8, seed: 7, method: ga+lm, refine_steps: 2}\n",
    "adjust.yaml": SCENE + ADJUST,
    "s.yaml": "base: ga.yaml\nsweep:\n  form.pretension_N: [8, 9, 10]\n",
}


class Row:
    """A stage or a command. reads: patterns below the folder, of the files from which a `damaged file` is chosen."""

    def __init__(self, name, words, out=None, reads=()):
        self.name, self.words, self.out, self.reads = name, words.split(), out, reads
        self.is_stage = self.words[0] in ("run", "tolerance")
        self.writes = out is not None


def stage(name, case, command="run", more=""):
    begun = ("out/a.h5", "out/*.journal")
    return Row(name, f"{command} {case}.yaml -o out/a.h5 --quiet{more}", "a.h5", begun)


ROWS = [
    stage("form-finding", "form"),
    stage("search by GA", "ga"),
    stage("search by NSGA-II", "nsga"),
    stage("refinement by LM", "lm"),
    Row("`run --more`", "run more.yaml -o out/c.h5 --more 60 --quiet", "c.h5", ("out/c.h5", "out/*.journal")),
    stage("front by LM", "front"),
    stage("load cases", "states"),
    stage("far field", "field"),
    stage("`tolerance`", "samples", "tolerance"),
    stage("`tolerance --task`", "samples", "tolerance", " --task 0 --tasks 2"),
    stage("all stages", "all"),
    Row("`sweep`", "sweep s.yaml --dir out/s.d --quiet", "s.d", ("out/s.d/*.h5",)),
    Row("`merge`", "merge s.yaml --dir s.d -o out/m.h5", "m.h5", ("s.d/*.tsv",)),
    Row("`recover`", "recover out/n.h5", "n.h5", ("out/n.h5", "out/n.h5.journal")),
    Row("`export`", "export r.h5 --csv out/csv --vtk out/vtk", "csv", ("r.h5",)),
    Row("`report`", "report r.h5 -o out/r.html", "r.html", ("r.h5",)),
    Row("`adjust`", "adjust adjust.yaml --measured m.csv --result j.h5 -o out/moves.csv --quiet", "moves.csv",
        ("j.h5",)),
    Row("`evaluate`", "evaluate ga.yaml --designs d.csv -o out/e.csv --quiet", "e.csv"),
    Row("`new`", "new out/fresh.yaml", "fresh.yaml"),
    Row("`check`", "check ga.yaml"),
    Row("`show`", "show r.h5", None, ("r.h5",)),
    Row("`diff`", "diff r.h5 r.h5", None, ("r.h5",)),
    Row("`status`", "status s.yaml --dir s.d", None, ("s.d/*.tsv",)),
    Row("`explain`", "explain psi"),
    Row("`schema`", "schema"),
    Row("`help`", "help run"),
    Row("`version`", "version"),
]

# What each section of a case and each method of the search makes run: table.py holds them against `hifdm schema`.
SECTIONS = {"title": None, "scene": None, "cables": None, "nodes": None, "truss": "all stages",
            "coupling": "all stages", "form": "form-finding", "optimize": "search by GA", "surface": "far field",
            "tolerance": "`tolerance`", "requirements": "`tolerance`", "load_cases": "load cases", "adjust": "`adjust`",
            "sweep": "`sweep`"}
FILLER = "filler"  # takes the room of a full disk
# The restarts of `auto` write nothing, so it has the stages of ga+lm.
METHODS = {"ga": "search by GA", "lm": "refinement by LM", "ga+lm": "all stages", "auto": "all stages"}


KEPT = re.compile(r"\.h5\.\d+\.h5$")  # a whole result that could not get its name


def is_temporary(path):
    return path.name.startswith(".") and path.name.endswith(".tmp")


class Bench:
    """A folder in which one command after the other runs with faults."""

    def __init__(self, program, folder, library, most):
        self.program, self.folder, self.library, self.most = program, Path(folder), library, most
        self.base, self.work, self.wrong = self.folder.parent / "base", self.folder / "work", []

    # ---- what is there before a fault ----

    def call(self, words, cwd=None, fault="", limit="", **more):
        """Returns (exit status, output). The status is negative for a signal, and "hangs" for a command that does not
        end."""
        environment = dict(os.environ, OMP_NUM_THREADS="2", **more)
        shell = (f"{limit}; " if limit else "") + 'exec "$0" "$@"'
        if fault:
            shell = 'export LD_PRELOAD="$MACHINE"; ' + shell
            environment.update(FAULT=fault, MACHINE=str(self.library))
        child = subprocess.Popen(["/bin/sh", "-c", shell, self.program, *words], cwd=cwd or self.work,
                                 env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, start_new_session=True)
        try:
            out, err = child.communicate(timeout=LIMIT_S)
            return child.returncode, (err or out).decode(errors="replace")
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            child.communicate()
            return "hangs", ""

    def make_base(self):
        """Makes the inputs of all commands. All benches of a parent folder share them."""
        shutil.rmtree(self.base, ignore_errors=True)
        (self.base / "out").mkdir(parents=True)
        for name, text in FILES.items():
            (self.base / name).write_text(text)
        for words in ("run all.yaml -o r.h5 --quiet", "run more.yaml -o c.h5 --quiet",
                      "run adjust.yaml -o j.h5 --quiet", "sweep s.yaml --quiet",
                      "export j.h5 --csv nodes", "evaluate ga.yaml --template d.csv"):
            status, said = self.call(words.split(), self.base)
            if status != 0:
                raise SystemExit(f"{words}: {status}\n{said}")
        self.write_measured()
        self.begin_unfinished()

    def write_measured(self):
        """Writes m.csv: the nodes of the design, some of them slightly displaced."""
        lines = (self.base / "nodes/nodes.csv").read_text().splitlines()
        at = [lines[0].split(",").index(word) for word in ("id", "x_m", "y_m", "z_m")]
        with open(self.base / "m.csv", "w", encoding="ascii") as file:
            file.write("id,x_m,y_m,z_m\n")
            for i, line in enumerate(lines[1:]):
                cell = [line.split(",")[k] for k in at]
                file.write(f"{cell[0]},{cell[1]},{cell[2]},{float(cell[3]) + (i % 5 - 2) * 2e-4!r}\n")

    def begin_unfinished(self):
        """Makes n.h5 by a run that is killed while its journal has generations that the file does not have."""
        journal = self.base / "n.h5.journal"
        for n in range(20, 2000, 10):
            for path in self.base.glob("*n.h5*"):
                path.unlink()
            self.call(["run", "ga.yaml", "-o", "n.h5", "--quiet"], self.base, f"kill {n} w {self.base}/n.h5.journal")
            if (self.base / "n.h5").exists() and journal.exists() and journal.stat().st_size > 3000:
                return
        raise SystemExit("no run could be killed")

    def take(self, row):
        """Makes the undisturbed output of a row, in the folder ref."""
        self.row, self.reference = row, self.folder / "ref"
        self.folder.mkdir(exist_ok=True)
        shutil.rmtree(self.reference, ignore_errors=True)
        self.fresh()
        status, said = self.call(row.words)
        if status != 0:
            raise SystemExit(f"{' '.join(row.words)}: {status}\n{said}")
        shutil.copytree(self.work / "out", self.reference)

    def fresh(self):
        shutil.rmtree(self.work, ignore_errors=True)
        shutil.copytree(self.base, self.work)
        self.put_in()

    def put_in(self):
        if "--more" in self.row.words:
            shutil.copy(self.base / "c.h5", self.work / "out")
        if self.row.words[0] == "recover":
            for ending in ("", ".journal"):
                shutil.copy(self.base / f"n.h5{ending}", self.work / "out")

    # ---- what is there after it ----

    def files(self, folder):
        return sorted(p for p in folder.rglob("*") if p.is_file() and not p.is_symlink() and p.name != FILLER)

    def state_of(self, path):
        """Returns the state of an HDF5 file in words; `damaged file` if it cannot be read."""
        if path.name == "m.h5" or path.suffix == ".hdf":
            status = self.call(["diff", str(path), str(path)], self.folder)[0]
            return "its files" if status in (0, 1) else "damaged file"
        status, said = self.call(["show", str(path)], self.folder)
        if status not in (0, 3):
            return "damaged file"
        return "unfinished result" if said.startswith("unfinished: ") else "finished result"

    def left(self, compares):
        """Returns what is in out/, in words."""
        words = set()
        for path in self.files(self.work / "out"):
            name = path.relative_to(self.work / "out")
            if is_temporary(path):
                words.add("temporary file")
            elif path.suffix == ".journal":
                words.add("journal")
            elif KEPT.search(path.name):
                words.add("finished result under another name")
            elif path.suffix == ".h5":
                words.add(self.state_of(path))
            elif path.suffix == ".tsv":
                words.add("rows")
            elif path.name != "claims":
                is_right = not compares or self.is_same(path, self.reference / name)
                words.add("its files" if is_right else "damaged file")
        return words or {"nothing"}

    def is_same(self, path, other):
        if not other.exists():
            return False
        if path.suffix in (".h5", ".hdf") and path.name != "m.h5":  # times are in them
            status = self.call(["diff", str(path), str(other)], self.folder)[0]
            return status == 0 and attributes_of(path) == attributes_of(other)
        return path.read_bytes() == other.read_bytes()

    def tell_wrong(self, what, fault, said=""):
        self.wrong.append(f"{fault}, {self.row.name}: {what}: {said.strip()[:300]}")

    def compare(self, fault):
        """Checks that the files are those of an undisturbed command, to the bit, and no others."""
        here, there = (
            {p.relative_to(folder) for p in self.files(folder)
             if p.suffix not in (".tsv", "") and not is_temporary(p) and not KEPT.search(p.name)}
            for folder in (self.work / "out", self.reference))
        for name in sorted(here ^ there):
            self.tell_wrong(f"{name} is {'left over' if name in here else 'missing'}", fault)
        for name in sorted(here & there):
            if not self.is_same(self.work / "out" / name, self.reference / name):
                self.tell_wrong(f"{name} is not that of an undisturbed command", fault)
        if rows_of(self.work / "out", finished=True) != rows_of(self.reference, finished=True):
            self.tell_wrong("the rows are not those of an undisturbed command", fault)

    def afterwards(self, fault, compares):
        """Runs the same command without the fault and returns its outcome in a word."""
        status, said = self.call(self.row.words)
        if any(is_temporary(p) for p in self.files(self.work / "out")):
            self.tell_wrong("the same command leaves a temporary file", fault, said)
        if status == 0:
            if compares:
                self.compare(fault)
            return "completes"
        option = re.search(r"--(force|restart|retry failed)\b", said)
        return f"{status}, `{option.group()}` helps" if status in (3, 5) and option else str(status)

    # ---- the faults: each yields (exit status, words) of a command that had it at another place ----

    def places(self, n):
        most = min(n, self.most)
        return sorted({1 + round(i * (n - 1) / max(most - 1, 1)) for i in range(most)})

    def at_call(self, what, n, letters):
        """Returns ((exit status, output), number of these calls on files of the folder that the command made)."""
        tally = self.folder / "tally"
        tally.unlink(missing_ok=True)
        self.fresh()
        result = self.call(self.row.words, fault=f"{what} {n} {letters} {self.work}", TALLY=str(tally))
        return result, max([int(n) for n in tally.read_text().split()], default=0) if tally.exists() else 0

    def count(self, letters):
        return self.at_call("0", 10 ** 9, letters)[1]

    def at_calls(self, what, letters):
        for n in self.places(self.count(letters)):
            result, n_made = self.at_call(what, n, letters)
            if result[0] != 0 or n_made >= n:  # else it came that far in the first run alone, with other threads
                yield result

    def each_call(self, what, letters):
        for letter in letters:
            yield from self.at_calls(what, letter)

    def with_limit(self, limits):
        for limit in self.places(len(limits)):
            self.fresh()
            yield self.call(self.row.words, limit=f"ulimit {limits[limit - 1]}")

    def mounted(self, free_kB):
        """Mounts a file system on out/, with this much free space, or read-only (None)."""
        out = self.work / "out"
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16m", "none", out], check=True)
        try:
            self.put_in()
            if free_kB is None:
                subprocess.run(["mount", "-o", "remount,bind,ro", out], check=True)
            else:
                room = os.statvfs(out)
                (out / FILLER).write_bytes(bytes(room.f_bavail * room.f_bsize - 1024 * free_kB))
            result = self.call(self.row.words)
            if free_kB is None:
                subprocess.run(["mount", "-o", "remount,bind,rw", out], check=True)
            else:
                (out / FILLER).unlink()
            yield result
        finally:
            subprocess.run(["umount", "--lazy", out], check=True)  # a reader on its way out keeps it busy

    def full_disk(self):
        """Yields outcomes at levels of free space, from none to the size of all files and as much again for temporary
        files."""
        whole_kB = sum(p.stat().st_size for p in self.files(self.reference)) // 1024 + 4
        for i in range(self.most):
            self.fresh()
            yield from self.mounted(2 * whole_kB * i // self.most // 4 * 4)

    def read_only(self):
        self.fresh()
        yield from self.mounted(None)

    def damaged(self):
        r = random.Random(1)
        for i in range(3 * self.most):
            self.fresh()
            if self.row.is_stage:
                shutil.copytree(self.begun(), self.work / "out", dirs_exist_ok=True)
            if self.row.words[0] == "sweep":
                shutil.copytree(self.work / "s.d", self.work / "out/s.d")
                for rows in (self.work / "out/s.d").glob("*.tsv"):
                    rows.unlink()
            path = r.choice([p for pattern in self.row.reads for p in sorted(self.work.glob(pattern))])
            data = bytearray(path.read_bytes())
            if i % 3 == 0:
                del data[r.randrange(len(data)):]
            else:
                for _ in range(1 if i % 3 == 1 else 200):
                    data[r.randrange(min(len(data), 20000))] = r.randrange(256)
            path.write_bytes(data)
            yield self.call(self.row.words)

    def begun(self):
        """Returns a folder with what SIGTERM in the middle of a stage leaves, or else with its finished result."""
        folder = self.folder / "begun"
        if not folder.exists() or self.begun_of != self.row:
            calls = self.count("w")
            for n in (calls * k // 8 + 1 for k in range(4, 8)):
                self.fresh()
                self.call(self.row.words, fault=f"term {n} w {self.work}")
                if self.files(self.work / "out"):
                    break
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(self.work / "out" if self.files(self.work / "out") else self.reference, folder)
            self.begun_of = self.row
            self.fresh()
            shutil.copytree(folder, self.work / "out", dirs_exist_ok=True)
        return folder

    def hostile_link(self):
        self.fresh()
        victim, name = self.work / "victim", self.work / "out" / self.row.out
        if self.row.words[0] == "recover" or "--more" in self.row.words:
            victim = self.work / ("n.h5" if self.row.words[0] == "recover" else "c.h5")
            name.unlink()
        elif self.row.out in ("csv", "s.d"):
            victim.mkdir()
        else:
            victim.write_text("precious")
        name.symlink_to(victim)
        os.chown(name, 65534, 65534, follow_symlinks=False)
        before = sorted(os.listdir(victim)) if victim.is_dir() else victim.read_bytes()
        result = self.call(self.row.words)
        after = sorted(os.listdir(victim)) if victim.is_dir() else victim.read_bytes()
        if before != after:
            self.tell_wrong("what the link leads to was changed", "hostile link")
        name.unlink()
        self.put_in()
        yield result

    # ---- one cell ----

    def bring_back(self):
        gone = self.work / "out.gone"
        if gone.exists():
            shutil.rmtree(self.work / "out", ignore_errors=True)
            gone.rename(self.work / "out")

    def cell(self, fault):
        """Returns (exit statuses, what remains, what the same command does) of one fault in the current row."""
        exits, remains, after = set(), set(), set()
        does = FAULTS[fault]
        for status, said in does.make(self):
            self.bring_back()
            exits.add(str(128 - status) if isinstance(status, int) and status < 0 else str(status))
            if status not in (0, -signal.SIGKILL, -signal.SIGTERM) and "error: " not in said and "librar" not in said:
                self.tell_wrong(f"exit status {status} without words", fault, said)
            if status == "hangs" or isinstance(status, int) and status < 0 and -status not in does.signals:
                self.tell_wrong(f"ended by {status}", fault, said)
            if self.row.writes:
                left = self.left(does.compares)
                remains |= left
                if "damaged file" in left and fault != "damaged file":
                    self.tell_wrong("half a file has its name", fault, said)
            if status != 0 or does.repeats:
                after.add(self.afterwards(fault, does.compares))
            elif self.row.writes and does.compares:
                self.compare(fault)
        if does.ends_well and exits and status != 0:
            self.tell_wrong(f"the mildest ends with {status}", fault, said)
        return exits, remains, after


class Fault:
    def __init__(self, make, applies=lambda row: row.writes, compares=True, signals=(), repeats=False,
                 ends_well=False):
        self.make, self.applies, self.compares, self.signals = make, applies, compares, signals
        self.ends_well = ends_well  # its last place does no harm
        self.repeats = repeats  # the same command is given again although the first one succeeded


def everywhere(row):
    return True


def reads_files(row):
    return row.writes or row.reads or row.words[0] == "check"


def writes_itself(row):
    """Returns true for commands that write by calls of our own. The others write by the C library, whose own calls no
    fault but a full disk makes fail."""
    return row.is_stage or row.words[0] in ("sweep", "merge", "recover", "export")


def letters(row, to_write, to_read):
    return to_write if row.writes else to_read


# From what is too little for LAPACK to more than every command needs: with the last one each of them must succeed.
MEMORY_MB = (*range(36, 141, 8), *range(160, 500, 40), 1000)

FAULTS = {
    "`kill -9`": Fault(lambda b: b.at_calls("kill", letters(b.row, "wso", "ro")), reads_files, signals=(9,)),
    "SIGTERM": Fault(lambda b: b.at_calls("term", letters(b.row, "wso", "ro")), reads_files, signals=(15,)),
    "full disk (ENOSPC)": Fault(Bench.full_disk),
    "quota (EDQUOT of writes)": Fault(lambda b: b.at_calls("122", "w"), writes_itself),
    "file size (`ulimit -f`)": Fault(
        lambda b: b.with_limit([f"-f {n}" for n in (0, 1, 8, 24, 40, 64, 100, 200, 400)])),
    "EIO of reads, writes and syncs": Fault(lambda b: b.at_calls("5", "wsr"), reads_files),
    "`rename`, `link`, `ftruncate`, `close` fail (EIO)": Fault(lambda b: b.each_call("5", "mltc")),
    "`unlink` fails (EACCES)": Fault(lambda b: b.at_calls("13", "u"), repeats=True),
    "descriptors (`ulimit -n`)": Fault(lambda b: b.with_limit([f"-n {n}" for n in range(4, 16)]), everywhere),
    "memory (`ulimit -v`)": Fault(lambda b: b.with_limit([f"-v {1024 * mb}" for mb in MEMORY_MB]), everywhere,
                                  ends_well=True),
    "read-only file system": Fault(Bench.read_only),
    "folder vanishes": Fault(lambda b: b.at_calls("vanish", "wso"), repeats=True),
    "damaged file": Fault(Bench.damaged, lambda row: bool(row.reads), compares=False),
    "link of another user": Fault(Bench.hostile_link),
}
