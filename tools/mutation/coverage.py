"""Finds which suites execute which line. One build with gcov serves all suites; each suite runs alone and has its own
counts."""

import json
import os
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor

from mutation.tree import FLAGS, copy_sources, run, state_of, test_environment

# Children that end by _exit would lose their counts.
EXIT = """#ifndef HF_COVERAGE_EXIT
#define HF_COVERAGE_EXIT
void __gcov_dump(void);
_Noreturn void hf_end(int status) __asm__("_exit");
static inline _Noreturn void hf_coverage_exit(int status)
{
    __gcov_dump();
    hf_end(status);
}
#define _exit(status) hf_coverage_exit(status)
#endif
"""
SUITE_CPU_S = 1800  # s; with counters all suites take less


def suites_of(top):
    """Returns the names of all suites, in the order in which they run."""
    text = (top / "tests/suites.list.h").read_text()
    rows = re.findall(r"^(?:SUITE|MIRROR)\((\w+), (\w+)(?:, (\w+))?\)", text, re.M)
    return ["/".join(part for part in row if part) for row in rows]


def state_of_suite(top, suite):
    """Returns a checksum of the tests of a suite. Shared files of the tests change too little of the map to measure it
    again."""
    folder, _, name = suite.rpartition("/")
    return state_of([top / f"tests/{folder}/test_{name}.c"])


class Coverage:
    """The map of one state of the sources, below `work`. Measurements of the same state are used again."""

    def __init__(self, top, work, state, say):
        self.top, self.work, self.say = top, work / "coverage", say
        self.tree, self.build = self.work / "tree", self.work / "tree/build"
        self.table = self.work / "suites.json"
        self.lines, self.functions = {}, {}
        known = json.loads(self.table.read_text()) if self.table.exists() else {}
        if known.get("state") != state:
            shutil.rmtree(self.work / "counts", ignore_errors=True)
            shutil.rmtree(self.work / "lines", ignore_errors=True)
            known = {"state": state, "suites": {}}
        self.known, self.measured = known, known["suites"]

    def measure(self, suites, jobs):
        """Runs the suites that have not run since their tests changed, `jobs` at a time."""
        states = {s: state_of_suite(self.top, s) for s in suites}
        missing = [s for s in suites if self.measured.get(s, {}).get("state") != states[s]]
        missing.sort(key=lambda s: s != "cli/transcripts")  # the longest first, so that no thread waits for it
        self._build(jobs)
        with ThreadPoolExecutor(jobs) as pool:
            for suite, (outcome, cpu_s) in zip(missing, pool.map(self._count, missing)):
                self.measured[suite] = {"state": states[suite], "cpu_s": round(cpu_s, 2)}
                self.table.write_text(json.dumps(self.known, indent=1) + "\n")
                self.say(f"coverage of {suite}: {outcome}, {cpu_s:.1f} s")
        self.suites = suites
        self.cpu_s = {s: self.measured[s]["cpu_s"] for s in suites}
        self.states = {s: states[s] for s in suites}

    def _build(self, jobs):
        self.tree.mkdir(parents=True, exist_ok=True)
        copy_sources(self.top, self.tree)
        header = self.work / "exit.h"
        if not header.exists() or header.read_text() != EXIT:  # all objects depend on it
            header.write_text(EXIT)
        flags = [f for f in FLAGS if not f.startswith("CFLAGS")] + \
                [f"CFLAGS=-O1 --coverage -include {self.work}/exit.h"]
        targets = ["build/hifdm", "build/tests/run_tests", "build/prefix/lib/pkgconfig/hifdm.pc"]
        if run(["make", "-s", f"-j{jobs}", *flags, *targets], self.tree, self.work / "build.log", 7200,
               {"BUILD": "build", "MAKEFLAGS": ""})[0] != "passed":
            raise SystemExit(f"the sources do not build with gcov: {self.work}/build.log")
        self.objects = {}  # objects of each source
        for d in (self.build / "src").rglob("*.d"):
            for name in d.read_text().replace("\\\n", " ").split(":")[1].split():
                self.objects.setdefault(name, []).append(d.with_suffix(".o").relative_to(self.build))

    def _counts(self, suite):
        return self.work / "counts" / suite.replace("/", "-")

    def _count(self, suite):
        counts = self._counts(suite)
        shutil.rmtree(counts, ignore_errors=True)
        tmp = self.build / "tmp" / suite.replace("/", "-")
        shutil.rmtree(tmp, ignore_errors=True)
        tmp.mkdir(parents=True)
        log = self.work / f"{suite.replace('/', '-')}.log"
        log.unlink(missing_ok=True)
        environment = {**test_environment(self.tree, self.build, "--coverage"), "TMPDIR": str(tmp),
                       "GCOV_PREFIX": str(counts), "GCOV_PREFIX_STRIP": str(len(self.build.parts) - 1)}
        return run([self.build / "tests/run_tests", f"={suite}"], self.tree, log, SUITE_CPU_S, environment)

    def suites_at(self, path, line):
        """Returns the suites that execute a line. A line without code of its own, such as the second line of a
        statement, belongs to the code before it in its function. Code outside of functions, such as a table, belongs to
        all suites that execute anything of the file. For a header without code these are the suites that execute
        anything of a file that includes it."""
        lines = self._lines_of(path)
        first = max((a for a, b in self.functions[path] if a <= line <= b), default=None)
        before = [n for n in lines if first is not None and first <= n <= line]
        if before:
            return lines[max(before)]
        paths = [path] if lines else [p for p in self.objects if p.endswith(".c") and p.startswith("src/") and
                                      set(self.objects[p]) & set(self.objects.get(path, []))]
        there = {s for p in paths for here in self._lines_of(p).values() for s in here}
        return [s for s in self.suites if s in there]

    def _lines_of(self, path):
        if path not in self.lines:
            self.lines[path] = self._read(path)
        return self.lines[path]

    def _read(self, path):
        """Returns {line: [suite, ...]} of a source, from the counts of all objects that include it."""
        cache = self.work / "lines" / f"{path.replace('/', '-')}.json"
        if cache.exists():
            table = json.loads(cache.read_text())
            if table["suites"] == self.states:
                self.functions[path] = table["functions"]
                return {int(n): s for n, s in table["lines"].items()}
        lines, functions = {}, set()
        for suite in self.suites:
            there = [o for o in self.objects.get(path, []) if (self._counts(suite) / o.with_suffix(".gcda")).exists()]
            for n, count in self._lines(suite, path, there, functions):
                here = lines.setdefault(n, [])
                if count > 0 and (not here or here[-1] != suite):
                    here.append(suite)
        cache.parent.mkdir(parents=True, exist_ok=True)
        self.functions[path] = sorted(functions)
        cache.write_text(json.dumps({"suites": self.states, "lines": lines, "functions": self.functions[path]}))
        return lines

    def _lines(self, suite, path, objects, functions):
        if not objects:
            return
        for o in objects:
            note = self._counts(suite) / o.with_suffix(".gcno")
            if not note.exists():
                os.link(self.build / o.with_suffix(".gcno"), note)
        out = subprocess.run(["gcov", "--json-format", "--stdout",
                              *(str(self._counts(suite) / o.with_suffix(".gcda")) for o in objects)],
                             cwd=self.tree, check=True, capture_output=True, text=True).stdout
        for text in out.splitlines():
            for file in json.loads(text)["files"]:
                if file["file"] == path:
                    functions.update((f["start_line"], f["end_line"]) for f in file["functions"])
                    for row in file["lines"]:
                        yield row["line_number"], row["count"]
