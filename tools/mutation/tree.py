"""A copy of the sources that is built once, and then again with one edit after the other, and the suites that run in
it."""

import hashlib
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

TICKS = os.sysconf("SC_CLK_TCK")
INSTALL_S = 60  # s of processor time; the installation runs the program, and an edit may have made an endless loop
ASLEEP_S = 60  # s; a suite that uses no processor time for so long hangs
FLAGS = ["WERROR=-Werror=incompatible-pointer-types -Werror=int-conversion -Werror=implicit-function-declaration "
         "-Werror=return-type", "CFLAGS=-O1"]
LIMITS = ["sh", "-c", 'ulimit -v 8000000; exec "$@"', "sh"]  # kB, for edits that take memory without end
SANITIZED = ["SANITIZE=address,undefined", "WERROR=", "CFLAGS=-O1 -g"]
SANITIZERS = {"ASAN_OPTIONS": "detect_leaks=1:detect_stack_use_after_return=1:quarantine_size_mb=16:"
                              "hard_rss_limit_mb=6000"}  # the address space of sanitizers has no limit
SLOWER = 6  # factor of time with sanitizers, at most
running = set()  # sessions that this process has begun


def copy_sources(top, tree):
    """Copies the files that git tracks or would track, so that uncommitted tests count, and nothing that was built."""
    files = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=top, check=True,
                           capture_output=True, text=True).stdout.split("\0")
    for name in filter(None, files):
        if (top / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            if not (tree / name).exists() or (tree / name).read_bytes() != (top / name).read_bytes():
                shutil.copyfile(top / name, tree / name)
                shutil.copymode(top / name, tree / name)
    for path in tree.rglob("*"):  # a test that was removed must not be built
        name = str(path.relative_to(tree))
        if path.suffix in (".c", ".h") and not name.startswith("build/") and name not in files:
            path.unlink()
    (tree / ".describe").write_text("mutants\n")


def state_of(files):
    """Returns a checksum of the contents of files."""
    digest = hashlib.sha256()
    for path in files:
        digest.update(str(path.name).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def cpu_of_session(session):
    """Returns the processor seconds of the processes of a session and of their children that have ended, and whether
    all processes sleep."""
    total, asleep = 0.0, True
    for entry in os.scandir("/proc"):
        if not entry.name.isdigit():
            continue
        try:
            with open(f"/proc/{entry.name}/stat", "rb") as file:
                fields = file.read().rpartition(b")")[2].split()
        except OSError:
            continue
        if int(fields[3]) != session:
            continue
        total += sum(int(f) for f in fields[11:15]) / TICKS
        asleep = asleep and fields[0] in (b"S", b"Z", b"T")
    return total, asleep


def end(session):
    """Ends all processes of a session, also those in groups of their own."""
    for _ in range(3):
        for entry in os.scandir("/proc"):
            if entry.name.isdigit():
                try:
                    with open(f"/proc/{entry.name}/stat", "rb") as file:
                        fields = file.read().rpartition(b")")[2].split()
                    if int(fields[3]) == session and fields[0] != b"Z":
                        os.kill(int(entry.name), signal.SIGKILL)
                except OSError:
                    pass


def run(command, cwd, log, cpu_limit_s, environment=None, limits=LIMITS):
    """Runs a command in a session of its own. Returns ("passed", "failed", "too long" or "hangs", processor s).

    The limit is processor time, not time by the clock, so it holds on a busy machine. A command hangs if all its
    processes sleep for a minute."""
    with open(log, "ab") as file:
        child = subprocess.Popen([*limits, *command], cwd=cwd, stdin=subprocess.DEVNULL, stdout=file,
                                 stderr=subprocess.STDOUT, env={**os.environ, **(environment or {})},
                                 start_new_session=True)
    running.add(child.pid)
    used, last_used, last_time, wait = 0.0, -1.0, time.monotonic(), 0.02
    try:
        while True:
            time.sleep(wait)
            wait = min(1.2 * wait, 0.5)
            ended, status, usage = os.wait4(child.pid, os.WNOHANG)
            if ended:
                child.returncode = os.waitstatus_to_exitcode(status)
                used = max(used, usage.ru_utime + usage.ru_stime)
                return "passed" if child.returncode == 0 else "failed", used
            now, asleep = cpu_of_session(child.pid)
            used = max(used, now)
            if used > last_used or not asleep:
                last_used, last_time = used, time.monotonic()
            if used > cpu_limit_s:
                return "too long", used
            if time.monotonic() - last_time > ASLEEP_S:
                return "hangs", used
    finally:
        end(child.pid)
        child.wait()
        running.discard(child.pid)


class Tree:
    """The copy of one worker. `pristine` holds the objects without an edit, which are restored after each edit."""

    def __init__(self, top, path, sanitized=False):
        self.top, self.path, self.log = top, path, path.parent / f"{path.name}.log"
        self.sanitized, self.flags = sanitized, SANITIZED if sanitized else FLAGS
        self.build, self.pristine = path / "build", path / "build" / "pristine"
        self.is_prepared = False

    def copy(self, other):
        """Copies what was built in another tree. Times are kept, so nothing is compiled again."""
        shutil.rmtree(self.path, ignore_errors=True)
        shutil.copytree(other.path, self.path, symlinks=True)

    def make(self, *targets, cpu_limit_s=3600, log=None):
        environment = {"BUILD": "build", "MAKEFLAGS": "", **(SANITIZERS if self.sanitized else {})}
        return run(["make", "-s", *self.flags, *(str(t) for t in targets)], self.path, log or self.log, cpu_limit_s,
                   environment, [] if self.sanitized else LIMITS)[0] == "passed"

    def linked(self):
        return ["build/hifdm", "build/tests/run_tests", "build/prefix/lib/pkgconfig/hifdm.pc"]

    def prepare(self, jobs=1):
        """Copies, builds, and keeps the objects. Objects that were built for the same sources are used again."""
        self.path.mkdir(parents=True, exist_ok=True)
        copy_sources(self.top, self.path)
        self.forget_links()
        if not self.make(f"-j{jobs}", *self.linked()):
            raise SystemExit(f"the sources do not build: {self.log}")
        shutil.rmtree(self.pristine, ignore_errors=True)
        self.pristine.mkdir(parents=True)
        shutil.copy2(self.build / "hifdm", self.pristine)
        self.users = {}
        for o in sorted(self.build.rglob("*.o")):
            (self.pristine / o.relative_to(self.build)).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(o, self.pristine / o.relative_to(self.build))
            for name in o.with_suffix(".d").read_text().replace("\\\n", " ").split(":")[1].split() \
                    if o.with_suffix(".d").exists() else []:
                self.users.setdefault(name, []).append(o)
        self.is_prepared = True

    def forget_links(self):
        for name in ("hifdm", "tests/run_tests", "libhifdm.a", "libhifdm.so", "prefix/lib/pkgconfig/hifdm.pc"):
            (self.build / name).unlink(missing_ok=True)

    def apply(self, edit, text, log):
        """Builds with the edit. Returns "built", "does not compile", "same code", or "does not install". In the last
        case the program is broken, because it cannot write its own manual page."""
        source = self.path / edit.path
        self.kept = (source, source.read_text(), source.stat().st_mtime_ns)
        source.write_text(text)
        self.changed = self.users.get(edit.path, [])
        if not self.make(*(o.relative_to(self.path) for o in self.changed), log=log):
            return "does not compile"
        if all(o.read_bytes() == (self.pristine / o.relative_to(self.build)).read_bytes() for o in self.changed):
            return "same code"
        self.forget_links()
        if not self.make(*self.linked()[:2], log=log):
            return "does not compile"
        return "built" if self.make(*self.linked(), log=log, cpu_limit_s=INSTALL_S) else "does not install"

    def revert(self):
        source, text, time_ns = self.kept
        source.write_text(text)
        os.utime(source, ns=(time_ns, time_ns))
        for o in self.changed:
            shutil.copy2(self.pristine / o.relative_to(self.build), o)
        self.forget_links()

    def test(self, suite, log, cpu_limit_s):
        shutil.rmtree(self.build / "tmp", ignore_errors=True)
        (self.build / "tmp").mkdir(parents=True)
        environment = test_environment(self.path, self.build, "-fsanitize=address,undefined" if self.sanitized else "")
        if self.sanitized:
            return run([self.build / "tests/run_tests", f"={suite}"], self.path, log, SLOWER * cpu_limit_s,
                       {**environment, **SANITIZERS}, [])
        return run([self.build / "tests/run_tests", f"={suite}"], self.path, log, cpu_limit_s, environment)


def test_environment(sources, build, flags=""):
    """Returns the environment that `make test` sets, without limits by the clock, because ours is one of processor
    time."""
    return {"HIFDM": str(build / "hifdm"), "HIFDM_SOURCE_DIR": str(sources), "HIFDM_PREFIX": str(build / "prefix"),
            "HIFDM_CC": f"cc {flags}".strip(), "TMPDIR": str(build / "tmp"), "CK_DEFAULT_TIMEOUT": "3000",
            "CK_TIMEOUT_MULTIPLIER": "10", "PYTHON": os.environ.get("PYTHON", "/usr/bin/python3")}
