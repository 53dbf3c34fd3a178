"""Faults x commands, measured: table.py --program build/hifdm [--fault WORD] [--command WORD] [--full]

Each cell does the command many times, with the fault at another place each time, and then the same command without it.
It prints the exit statuses, whether there were words, what was left on the disk, and how the same command ended
afterwards. The table in src/MANUAL.md is made from it. ENOSPC is a small tmpfs and hostile links have another owner:
both need root."""
import argparse
import collections
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
CASE = """scene:
  parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, modules: [2, 3], cells_per_module: [2, 2],
    scallop: 0.1}
  EA_inner_N: 1e5
  EA_boundary_N: 1e5
optimize: {population: 20, generations: %d, seed: 7, stagnation_generations: 1000000, polish_iterations: 3}
"""
LIMIT_S = 60
# command: words, what it makes, what may change on the way
COMMANDS = {
    "run": (["run", "c.yaml", "-o", "out/a.h5", "--quiet"], "a.h5"),
    "sweep": (["sweep", "s.yaml", "--dir", "out/s.d", "--quiet"], "s.d"),
    "merge": (["merge", "s.yaml", "--dir", "s.d", "-o", "out/m.h5"], "m.h5"),
    "recover": (["recover", "out/n.h5"], "n.h5"),
    "export": (["export", "r.h5", "--csv", "out/csv", "--vtk", "out/vtk"], "csv"),
    "report": (["report", "r.h5", "-o", "out/r.html"], "r.html"),
    "show": (["show", "r.h5"], None),
    "status": (["status", "s.yaml", "--dir", "s.d"], None),
}


class Table:
    def __init__(self, program, folder, full):
        self.program, self.folder, self.full = os.path.abspath(program), Path(folder).resolve(), full
        self.base, self.work, self.library = self.folder / "base", self.folder / "work", self.folder / "machine.so"
        shutil.rmtree(self.folder, ignore_errors=True)
        self.base.mkdir(parents=True)
        subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-w", HERE / "machine.c", "-o", self.library, "-ldl"],
                       check=True)
        (self.base / "c.yaml").write_text(CASE % 60)
        (self.base / "small.yaml").write_text(CASE % 20)
        (self.base / "s.yaml").write_text("base: small.yaml\nsweep:\n  form.pretension_N: [8, 9, 10]\n")
        for words in (["run", "c.yaml", "-o", "r.h5", "--quiet"], ["sweep", "s.yaml", "--quiet"]):
            subprocess.run([self.program, *words], cwd=self.base, check=True)
        (self.base / "out").mkdir()
        self.begin_night()

    def begin_night(self):
        """n.h5: a run killed while its journal holds generations."""
        path = self.base / "n.h5"
        for n in range(20, 2000, 20):
            for name in (path, Path(f"{path}.journal")):
                name.unlink(missing_ok=True)
            self.call(["run", "c.yaml", "-o", "n.h5", "--quiet"], self.base, f"kill {n} w n.h5")
            journal = Path(f"{path}.journal")
            if path.exists() and journal.exists() and journal.stat().st_size > 3000:
                return
        sys.exit("no run could be killed")

    def call(self, words, cwd, fault="", limit=""):
        """(exit status, what was said); -9 or -15 for a signal, "late" for one that does not end."""
        environment = dict(os.environ, OMP_NUM_THREADS="2")
        shell = f"{limit}; exec \"$0\" \"$@\"" if limit else "exec \"$0\" \"$@\""
        if fault:
            shell = "export LD_PRELOAD=\"$MACHINE\"; " + shell
            environment.update(FAULT=fault, MACHINE=str(self.library))
        child = subprocess.Popen(["/bin/sh", "-c", shell, self.program, *words], cwd=cwd, env=environment,
                                 stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 start_new_session=True)
        try:
            out, err = child.communicate(timeout=LIMIT_S)
            return child.returncode, (err or out).decode(errors="replace")
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            child.communicate()
            return "late", ""

    def fresh(self):
        shutil.rmtree(self.work, ignore_errors=True)
        shutil.copytree(self.base, self.work)
        for ending in ("", ".journal"):
            shutil.copy(self.base / f"n.h5{ending}", self.work / "out")

    def left(self):
        """What is in out/, in words."""
        words = set()
        for path in sorted(p for p in (self.work / "out").rglob("*") if p.is_file() and not p.is_symlink()):
            name = str(path.relative_to(self.work / "out"))
            if name.startswith("n.h5") and self.command != "recover":
                continue
            if path.name.startswith(".") and path.name.endswith(".tmp"):
                words.add("a temporary file")
            elif path.suffix == ".journal":
                words.add("journal")
            elif path.suffix == ".h5":
                words.add(self.state_of(path))
            elif path.suffix == ".html":
                words.add("whole page" if path.read_text().rstrip().endswith("</html>") else "half a page")
            elif path.suffix in (".csv", ".hdf"):
                words.add(f"{len(list(path.parent.parent.rglob('*.csv')) + list(path.parent.parent.rglob('*.hdf')))} "
                          "files of the export")
            elif path.suffix == ".tsv":
                words.add("rows")
        return ", ".join(sorted(words)) or "nothing"

    def state_of(self, path):
        if path.name == "m.h5":
            status, _ = self.call(["report", str(path), "-o", str(self.folder / "t.html"), "--force"], self.folder)
            return "whole merge" if status == 0 else "what cannot be read"
        if self.call(["show", str(path), "--json"], self.folder)[0] not in (0, 3):
            return "what cannot be read"
        finished = subprocess.run(["/usr/bin/python3", "-c", "import h5py, sys; print(h5py.File(sys.argv[1], 'r')"
                                   ".attrs['finished'])", path], capture_output=True, text=True).stdout.strip()
        return "whole result" if finished in ("1", "True") else "begun result"

    # ---- faults: each yields (exit status, words) of a command, and leaves what is there without the fault ----

    def places(self, most):
        n = most if self.full else min(most, 12)
        return sorted({1 + round(i * (most - 1) / max(n - 1, 1)) for i in range(n)})

    def count(self, letters):
        """How many of these calls the command makes."""
        low, high = 1, 1
        while high < 100000:
            self.fresh()
            if self.call(self.words, self.work, f"kill {high} {letters} {self.work}")[0] != -signal.SIGKILL:
                break
            low, high = high, 2 * high
        while low + 1 < high:
            middle = (low + high) // 2
            self.fresh()
            dead = self.call(self.words, self.work, f"kill {middle} {letters} {self.work}")[0] == -signal.SIGKILL
            low, high = (middle, high) if dead else (low, middle)
        return low

    def by_library(self, what, letters):
        for n in self.places(self.count(letters)):
            self.fresh()
            yield self.call(self.words, self.work, f"{what} {n} {letters} {self.work}")

    def by_limit(self, limits):
        for limit in limits:
            self.fresh()
            yield self.call(self.words, self.work, limit=limit)

    def full_disk(self):
        out = self.work / "out"
        for kb in (8, 24, 40, 64, 100, 160, 260, 400, 700, 1000):
            self.fresh()
            subprocess.run(["mount", "-t", "tmpfs", "-o", "size=60m", "none", out], check=True)
            try:
                if self.command == "recover":
                    for name in ("n.h5", "n.h5.journal"):
                        shutil.copy(self.base / name, out)
                used = sum(p.stat().st_size for p in out.iterdir())
                subprocess.run(["mount", "-o", f"remount,size={kb + used // 1024 + 4}k", out], check=True)
                result = self.call(self.words, self.work)
                subprocess.run(["mount", "-o", "remount,size=60m", out], check=True)
                if result[0] != 0:
                    yield result
            finally:
                subprocess.run(["umount", out], check=True)

    def damaged(self):
        names = {"run": ["out/a.h5", "out/a.h5.journal"], "sweep": None, "merge": None, "status": None,
                 "recover": ["out/n.h5", "out/n.h5.journal"]}.get(self.command, ["r.h5"])
        r = random.Random(1)
        for i in range(60 if self.full else 24):
            self.fresh()
            if self.command == "run":
                for ending in ("", ".journal"):
                    shutil.copy(self.base / f"n.h5{ending}", self.work / f"out/a.h5{ending}")
            if self.command == "sweep":
                shutil.copytree(self.work / "s.d", self.work / "out/s.d")
                for rows in (self.work / "out/s.d").glob("*.tsv"):
                    rows.unlink()
            files = [self.work / name for name in names or []]
            if self.command == "sweep":
                files = sorted((self.work / "out/s.d").glob("*.h5"))
            if self.command in ("merge", "status"):
                files = sorted((self.work / "s.d").glob("*.tsv"))
            path = r.choice(files)
            data = bytearray(path.read_bytes())
            if i % 3 == 0:
                del data[r.randrange(len(data)):]
            else:
                for _ in range(1 if i % 3 == 1 else 200):
                    data[r.randrange(min(len(data), 20000))] = r.randrange(256)
            path.write_bytes(data)
            yield self.call(self.words, self.work)

    def hostile(self):
        self.fresh()
        out, victim = self.work / "out", self.work / "victim"
        victim.write_text("precious")
        made = COMMANDS[self.command][1]
        if self.command in ("show", "status"):
            name, victim = (self.work / "r.h5", self.work / "t.h5") if self.command == "show" else (
                self.work / "s.d", self.work / "t.d")
            name.rename(victim)
        elif self.command == "recover":
            name, victim = out / "n.h5", self.work / "n.h5"
            name.unlink()
        else:
            name = out / made
            if made in ("csv", "s.d"):
                victim.unlink()
                victim.mkdir()
        name.symlink_to(victim)
        os.chown(name, 65534, 65534, follow_symlinks=False)
        before = digest(victim)
        result = self.call(self.words, self.work)
        if self.command not in ("show", "status"):
            assert digest(victim) == before, "the file behind the link was touched"
        name.unlink()
        if self.command in ("show", "status"):
            victim.rename(name)
        if self.command == "recover":
            shutil.copy(self.base / "n.h5", name)
        yield result

    # ---- one cell ----

    def cell(self, fault, command):
        self.command, self.words = command, COMMANDS[command][0]
        makes = COMMANDS[command][1] is not None
        results = {
            "kill -9": lambda: self.by_library("kill", "wso" if makes else "ro"),
            "SIGTERM": lambda: self.by_library("term", "wso" if makes else "ro"),
            "ENOSPC": self.full_disk if makes else lambda: iter(()),
            "EIO": lambda: self.by_library("5", "wsr"),
            "EMFILE": lambda: self.by_limit([f"ulimit -n {n}" for n in range(4, 16)]),
            "memory": lambda: self.by_limit([f"ulimit -v {1024 * mb}" for mb in range(36, 141, 8)]),
            "damaged file": self.damaged,
            "hostile link": self.hostile,
        }[fault]()
        seen, silent, warned, again = collections.defaultdict(collections.Counter), 0, 0, collections.Counter()
        for status, said in results:
            silent += status not in (0, -9, -15) and not any(w in said for w in ("error: ", "librar"))
            warned += status == 0 and "warning" in said
            seen[status][self.left()] += 1
            if status != 0:
                status, said = self.call(self.words, self.work)
                again[status] += 1
                again["a temporary file stayed"] += "temporary" in self.left()
        print(f"{fault:13} {command:8} " + "; ".join(f"{s}: {dict(left)}" for s, left in seen.items()) +
              (f", WITHOUT WORDS {silent}" if silent else "") + (f", {warned} warned" if warned else "") +
              f" | again {dict(+again)}", flush=True)


def digest(path):
    if path.is_dir():
        return sorted(os.listdir(path))
    return path.read_bytes()


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--program", default="build/hifdm")
    options.add_argument("--out", default="build/fault-table")
    options.add_argument("--fault", default="")
    options.add_argument("--command", default="")
    options.add_argument("--full", action="store_true", help="every place of a fault instead of a dozen")
    o = options.parse_args()
    table = Table(o.program, o.out, o.full)
    start = time.time()
    for fault in ("kill -9", "SIGTERM", "ENOSPC", "EIO", "EMFILE", "memory", "damaged file", "hostile link"):
        for command in COMMANDS:
            if o.fault in fault and o.command in command:
                table.cell(fault, command)
    print(f"{time.time() - start:.0f} s")


if __name__ == "__main__":
    main()
