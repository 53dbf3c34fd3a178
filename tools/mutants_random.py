#!/usr/bin/env python3
"""Makes N edits at random lines of src and lists those that the tests do not notice.

    tools/mutants_random.py --seed 4cdb071a --n 200

The edits depend on the seed and on the sources alone (tools/mutation/edits.py). Each edit is made in a worker's copy of
the working tree below build/mutants-random, which is compiled and linked again as far as needed. A draw is repeated if
it does not compile, if it leaves the object code unchanged, or if it was drawn before. The suites that execute the line
(tools/mutation/coverage.py) run, the most promising first, until one fails or --cpu seconds are used. A suite also
catches the edit if it uses more than 20 s plus three times its processor time, or if all its processes sleep for a
minute. If none failed, the suites run once more with the sanitizers of `make asan`, for a quarter of the time, unless
--plain is given. An edit that no suite executes survives.

Edits of tests/mutants_equivalent.txt change no result, for the reason given there. If such an edit is drawn, the
results of all configs/ are compared, bit by bit (of studies every fourth point). These edits are left out of the
percentage and must be at most 15 % of N.

Every draw is a line in build/mutants-random/SEED.log. The survivors follow there with their edits."""

import argparse
import difflib
import math
import os
import re
import shutil
import signal
import sys
import threading
import time
from pathlib import Path

from mutation.coverage import Coverage, suites_of
from mutation.edits import Draws, tokens_of
from mutation.listed import read_mutants
from mutation.tree import Tree, end, run, running, state_of

TOP = Path(__file__).resolve().parent.parent
EQUIVALENT_MOST = 0.15


class Log:
    def __init__(self, path):
        self.lock, self.file = threading.Lock(), open(path, "w")

    def __call__(self, line):
        with self.lock:
            print(line, flush=True)
            self.file.write(line + "\n")
            self.file.flush()


class Order:
    """The order of the suites: the probability that a suite notices the edit over its processor time, both as measured
    or estimated."""

    def __init__(self, coverage):
        self.coverage = coverage

    def __call__(self, path, line):
        def worth(suite):
            return self.chance(path, suite) / (0.2 + self.coverage.cpu_s[suite])
        return sorted(self.coverage.suites_at(path, line), key=lambda s: (-worth(s), s))

    @staticmethod
    def chance(path, suite):
        _, room, file = path.split("/")
        parts, name = suite.split("/"), re.sub(r"(_part|_kernel)?\.[ch]$", "", file)
        if suite == "cli/transcripts":  # all that the program prints and stores
            return 0.9 if room in ("app", "out", "run", "store", "case") else 0.2
        if parts[-1] == name or name == f"cmd_{parts[-1]}":
            return 0.6
        if name.startswith(parts[-1]) or parts[-1].startswith(name) or parts[-1] in name.split("_"):
            return 0.3
        if len(parts) == 3 and parts[1] == room or parts[0] == "cli" and room in ("app", "out", "run"):
            return 0.15
        return 0.05


class Runner:
    def __init__(self, options, log):
        self.o, self.log, self.lock = options, log, threading.Condition()
        self.work = TOP / os.environ.get("BUILD", "build") / "mutants-random"
        self.draws = Draws(TOP, int(options.seed, 16))
        self.sanitized, self.sanitized_lock = Tree(TOP, self.work / "sanitized", True), threading.Lock()
        self.equivalent = {}
        for m in read_mutants(TOP, "tests/mutants_equivalent.txt"):
            text = self.draws.sources[m.path].text
            self.equivalent[m.path, words_of(m.edited(text))] = m
        self.next, self.n_valid, self.n_running = 0, 0, 0
        self.seen, self.rows, self.base, self.spent_s = set(), {}, {}, 0.0

    @staticmethod
    def state_of_sources():
        return state_of(sorted(p for d in ("src", "include") for p in (TOP / d).glob("**/*") if p.is_file()))

    def measure(self):
        self.state = self.state_of_sources()
        self.coverage = Coverage(TOP, self.work, self.state, self.log)
        suites = [s for s in suites_of(TOP) if not self.o.suite or any(w in s for w in self.o.suite)]
        suites = [s for s in suites if not any(w in s for w in self.o.without)]
        self.coverage.measure(suites, self.o.jobs)
        self.order = Order(self.coverage)

    def take(self):
        """Returns the next draw that is needed, or None. Draws are made in their order, so that their set does not
        depend on how fast each is tried."""
        with self.lock:
            while self.n_valid < self.o.n and self.n_valid + self.n_running >= self.o.n:
                self.lock.wait()
            if self.n_valid >= self.o.n:
                return None
            k, self.next, self.n_running = self.next, self.next + 1, self.n_running + 1
            return k

    def give(self, k, row):
        with self.lock:
            self.n_running -= 1
            self.n_valid += row is not None
            if row:
                self.rows[k] = row
            self.lock.notify_all()

    def work_off(self, tree):
        try:
            if not tree.is_prepared:
                tree.prepare()
            while (k := self.take()) is not None:
                self.give(k, self.try_draw(k, tree))
        except BaseException as error:  # the other workers must not wait for this one
            self.log(f"a worker ended: {error!r}")
            os.kill(os.getpid(), signal.SIGTERM)
            raise

    def try_draw(self, k, tree):
        edit = self.draws.edit(k)
        if edit is None:
            path, line = self.draws.line_of(k)
            self.log(f"draw {k}: {path}:{line}: no edit is possible at this line")
            return None
        source, start = self.draws.sources[edit.path], time.monotonic()
        what = f"draw {k}: {edit.path}:{edit.line}: {edit.kind}: {shown(source.text[edit.start:edit.end])} -> " \
               f"{shown(edit.new)}"
        with self.lock:
            was_seen = edit in self.seen
            self.seen.add(edit)
        if was_seen:
            self.log(f"{what}: drawn before")
            return None
        log = self.work / "logs" / f"{self.o.seed}-{k}.log"
        log.unlink(missing_ok=True)
        text = source.edited(edit)
        try:
            built = tree.apply(edit, text, log)
            if built not in ("built", "does not install"):
                self.log(f"{what}: {built}")
                return None
            outcome, by, cpu_s = self.judge(edit, text, tree, log) if built == "built" else \
                ("caught", "the installation", 0.0)
        finally:
            tree.revert()
        self.log(f"{what}: {outcome}{' by ' + by if by else ''}, {cpu_s:.1f} s of processor time, "
                 f"{time.monotonic() - start:.0f} s")
        with self.lock:
            self.spent_s += cpu_s
        return outcome, by, edit, text

    def judge(self, edit, text, tree, log):
        listed = self.equivalent.get((edit.path, words_of(text)))
        if listed:
            differs = self.differing_config(tree, log)
            return (f"SURVIVED: listed as equivalent, but {differs} differs" if differs else "equivalent"), "", 0.0
        outcome, by, spent_s = self.try_suites(edit, text, tree, log, self.o.cpu)
        if self.o.plain or not outcome.startswith("SURVIVED") or "no suite" in outcome:
            return outcome, by, spent_s
        with self.sanitized_lock:
            if not self.sanitized.is_prepared:
                self.sanitized.prepare(self.o.jobs)
            try:
                if self.sanitized.apply(edit, text, log) != "built":
                    return outcome, by, spent_s
                last, by, more_s = self.try_suites(edit, text, self.sanitized, log, self.o.cpu / 4)
            finally:
                self.sanitized.revert()
        return (outcome if last.startswith("SURVIVED") else f"{last} with sanitizers"), by, spent_s + more_s

    def try_suites(self, edit, text, tree, log, most_s):
        spent_s, suites = 0.0, self.order(edit.path, edit.line)
        for suite in suites:
            if self.base.get((tree.sanitized, suite)) is False:
                continue
            if spent_s > most_s:
                return "SURVIVED for as long as it had", "", spent_s
            outcome, cpu_s = tree.test(suite, log, 20 + 3 * self.coverage.cpu_s[suite])
            spent_s += cpu_s
            if outcome != "passed" and self.passes_without(suite, edit, tree, text, log):
                by = suite if outcome != "failed" else f"{suite} ({who_failed(log)})"
                return "caught" if outcome == "failed" else f"caught ({outcome})", by, spent_s
        return "SURVIVED" if suites else "SURVIVED: no suite executes the line", "", spent_s

    def passes_without(self, suite, edit, tree, text, log):
        """Returns whether a suite that failed passes without the edit. This is found once for each suite and kind of
        tree."""
        key = (tree.sanitized, suite)
        if key not in self.base:
            tree.revert()
            base = self.work / "logs" / f"base-{suite.replace('/', '-')}.log"
            base.unlink(missing_ok=True)
            built = tree.make(*tree.linked(), log=base)
            outcome = tree.test(suite, base, 60 + 5 * self.coverage.cpu_s[suite])[0] if built else "does not build"
            self.base[key] = outcome == "passed"
            if outcome != "passed":
                self.log(f"{suite} fails without an edit, too, and is left out: {base}")
            tree.apply(edit, text, log)
        return self.base[key]

    def differing_config(self, tree, log):
        """Returns the first case of configs/ whose result has other bits with the edit that is built; None if all are
        equal."""
        program = tree.build / "hifdm"
        for case in sorted((TOP / "configs").glob("*.yaml")):
            with self.lock:  # the results without an edit are made once
                expected = self.work / "expected" / self.state / case.stem
                if not expected.exists():
                    made = expected.with_name(case.stem + ".part")  # a result that was interrupted is made again
                    if not make_result(tree.pristine / "hifdm", case, made, log):
                        return f"{case.name} without the edit"
                    made.rename(expected)
            found = tree.build / "tmp" / case.stem
            if not make_result(program, case, found, log):
                return case.name
            files = sorted(expected.glob("*.h5"))
            if not files or any(run([tree.pristine / "hifdm", "diff", file, found / file.name], TOP, log, 600)[0]
                                != "passed" for file in files):
                return case.name
        return None

    def check_equivalents(self):
        """Returns whether all edits that are listed as equivalent keep all bits. Each edit is built and compared."""
        tree, holds, self.state = Tree(TOP, self.work / "tree-0"), True, self.state_of_sources()
        tree.prepare(self.o.jobs)
        for m in self.equivalent.values():
            log = self.work / "logs" / f"equivalent-{m.name}.log"
            log.unlink(missing_ok=True)
            try:
                built = tree.apply(m, m.edited(self.draws.sources[m.path].text), log)
                differs = self.differing_config(tree, log) if built == "built" else None
            finally:
                tree.revert()
            holds = holds and built in ("built", "same code") and not differs
            self.log(f"{m.name}: {differs + ' differs' if differs else built + ', all bits kept'}")
        return holds

    def summary(self):
        rows = [self.rows[k] for k in sorted(self.rows)]
        caught = sum(row[0].startswith("caught") for row in rows)
        equivalent = sum(row[0] == "equivalent" for row in rows)
        for outcome, _, edit, text in rows:
            if outcome.startswith("SURVIVED"):
                self.log(f"{edit.path}:{edit.line}: {outcome}")
                for line in changed_lines(self.draws.sources[edit.path].text, text):
                    self.log(f"    {line}")
        judged = len(rows) - equivalent
        self.log(f"seed {self.o.seed}: {len(rows)} edits of {self.next} draws, {caught} caught, "
                 f"{judged - caught} survived, {equivalent} equivalent: {100 * caught / max(judged, 1):.1f} % caught; "
                 f"{self.spent_s / max(len(rows), 1):.0f} s of processor time per edit")
        if equivalent > EQUIVALENT_MOST * len(rows):
            self.log(f"more than {100 * EQUIVALENT_MOST:.0f} % are listed as equivalent")
        return equivalent <= EQUIVALENT_MOST * len(rows) and caught >= math.ceil(self.o.enough * judged)


def make_result(program, case, folder, log):
    """Runs a case. Of a study it runs every fourth point, and the figures are in the merge. All points would take
    minutes for each edit."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    is_study = re.search(r"^sweep:", case.read_text(), re.M)
    commands = [[program, "sweep", case, "--dir", folder, "--task", "0", "--tasks", "4", "--quiet"],
                [program, "merge", case, "--dir", folder, "-o", folder / "merge.h5", "--quiet"]] if is_study else \
        [[program, "run", case, "-o", folder / "result.h5", "--quiet"]]
    return all(run(command, TOP, log, 3600)[0] == "passed" for command in commands)


def words_of(text):
    return tuple(t.text for t in tokens_of(text))


def shown(text):
    return "'" + re.sub(r"\s+", " ", text) + "'"


def changed_lines(old, new):
    lines = difflib.unified_diff(old.split("\n"), new.split("\n"), n=0, lineterm="")
    return [line for line in lines if line[:1] in "+-" and line[:3] not in ("+++", "---") and line.strip() != "+"]


def who_failed(log):
    found = re.findall(r":[FE]:[^:]*:([^:]*):", log.read_text(errors="replace"))
    return found[0] if found else "its runner ended"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--equivalent", action="store_true", help="instead: do those that are listed keep all bits?")
    parser.add_argument("--seed", default="0", help="hexadecimal, for instance the first eight digits of a commit")
    parser.add_argument("--n", type=int, default=200, help="edits that compile and change the code")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--suite", nargs="*", help="only suites whose name contains a word")
    parser.add_argument("--without", nargs="*", default=[], help="no suites whose name contains a word")
    parser.add_argument("--plain", action="store_true", help="without the sanitizers")
    parser.add_argument("--cpu", type=float, default=150, help="processor seconds after which an edit has survived")
    parser.add_argument("--enough", type=float, default=0.9, help="the part to catch for exit status 0")
    o = parser.parse_args()
    work = TOP / os.environ.get("BUILD", "build") / "mutants-random"
    (work / "logs").mkdir(parents=True, exist_ok=True)
    log = Log(work / f"{'equivalent' if o.equivalent else o.seed}.log")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    start = time.monotonic()
    try:
        runner = Runner(o, log)
        if o.equivalent:
            sys.exit(0 if runner.check_equivalents() else 1)
        runner.measure()
        trees = [Tree(TOP, work / f"tree-{k}") for k in range(o.jobs)]
        trees[0].prepare(o.jobs)
        for tree in trees[1:]:
            tree.copy(trees[0])
        threads = [threading.Thread(target=runner.work_off, args=(t,), daemon=True) for t in trees]
        for t in threads:
            t.start()
        for t in threads:
            while t.is_alive():
                t.join(1)
        is_enough = runner.summary()
        log(f"{time.monotonic() - start:.0f} s")
    finally:
        for session in list(running):
            end(session)
    sys.exit(0 if is_enough else 1)


if __name__ == "__main__":
    main()
