#!/usr/bin/env python3
"""Makes the mutants of tests/mutants.txt one at a time and lists those that `make test` does not notice.

Each mutant is one edit at one place of the sources, in clones of HEAD under build/mutants; the user's tree is not
touched. The suites of the affected room run first, up to the first that fails. At the end, mutants that survived them
meet all suites. The table is build/mutants/table.txt.

    tools/mutants.py                   all mutants, as many at a time as there are cores
    tools/mutants.py WORD...           those whose name, file or suites contain a word
    tools/mutants.py --list            only lists the names
    tools/mutants.py --check           checks that every edit still applies, of mutants_equivalent.txt, too
"""

import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

from mutation.listed import read_mutants
from mutation.tree import end, run as run_alone, running

TOP = Path(__file__).resolve().parent.parent
WORK = Path(os.environ.get("BUILD", "build"))
WORK = (WORK if WORK.is_absolute() else TOP / WORK) / "mutants"
# s by the clock for a test, and of processor time for all tests. A mutant that hangs is noticed by them, too.
TEST_S, SUITES_S = 300, 7200
ENOUGH = 0.95


def suites(mutant):
    """Returns the suites that the row of a mutant names, or else those of its room."""
    room = mutant.path.split("/")[1]
    return mutant.words or [f"unit/{room}/", f"property/{room}/"]


def run(tree, log, *command, **environment):
    """Returns true if the command succeeds within its processor time."""
    log.unlink(missing_ok=True)
    return run_alone(command, tree, log, SUITES_S, {"BUILD": "build", "WERROR": "", **environment})[0] == "passed"


def test(tree, log, words):
    return run(tree, log, "make", "-s", "test", f"SUITE={' '.join(words)}", HIFDM_TEST_STOP="1",
               HIFDM_TEST_JOBS="2", CK_DEFAULT_TIMEOUT=str(TEST_S))


def who_failed(log):
    """Returns the test that noticed the mutant, as check names it. A time limit does not count, because on a busy
    machine it may not be due to the mutant."""
    by = "a run that did not end"
    for line in log.read_text(errors="replace").splitlines():
        found = re.search(r":[FE]:[^:]*:([^:]*):", line)
        if found and "Test timeout expired" not in line:
            return "caught", found[1]
        if found:
            by = found[1]
    return "timed out", by


def try_mutant(mutant, words, tree):
    source, log = tree / mutant.path, tree.parent / f"{mutant.name}.log"
    text = source.read_text()
    source.write_text(mutant.edited(text))
    try:
        if not run(tree, log, "make", "-s", "compile-all", "-j1"):
            return "does not compile", ""
        return ("lives so far" if words else "SURVIVED", "") if test(tree, log, words) else who_failed(log)
    finally:
        source.write_text(text)


def make_tree(k):
    tree = WORK / f"tree-{k}"
    shutil.rmtree(tree, ignore_errors=True)
    subprocess.run(["git", "clone", "-q", "--shared", TOP, tree], check=True)
    if not run(tree, WORK / f"tree-{k}.log", "make", "-s", "compile-all"):
        sys.exit(f"HEAD does not compile: {WORK}/tree-{k}.log")
    return tree


def work_off(queue, results, lock, k):
    tree = make_tree(k)
    while True:
        with lock:
            if not queue:
                return
            mutant, words = queue.pop(0)
        start = time.monotonic()
        outcome, by = try_mutant(mutant, words, tree)
        with lock:
            if outcome == "lives so far":
                queue.append((mutant, []))
                print(f"{outcome:16} {time.monotonic() - start:5.0f} s  {mutant.name}", flush=True)
                continue
            line = f"{outcome:16} {time.monotonic() - start:5.0f} s  {mutant.name:40} {mutant.path:32} {by}"
            results.append((outcome, mutant.name))
            print(line, flush=True)
            with open(WORK / "table.txt", "a") as table:
                table.write(line + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("word", nargs="*")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--no-base", action="store_true", help="do not ask whether HEAD itself passes")
    o = parser.parse_args()
    mutants = read_mutants(TOP, "tests/mutants.txt")
    chosen = [m for m in mutants if not o.word or any(w in f"{m.name} {m.path} {m.words}" for w in o.word)]
    if o.check:
        read_mutants(TOP, "tests/mutants_equivalent.txt")
    if o.list or o.check:
        for m in chosen if o.list else []:
            print(m.name, m.path)
        print(f"{len(chosen)} mutants")
        return
    WORK.mkdir(parents=True, exist_ok=True)
    (WORK / "table.txt").write_text("")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    if not o.no_base and not test(make_tree(0), WORK / "base.log", []):
        sys.exit(f"the tests fail without a mutant: {WORK}/base.log")
    queue, results, lock = [(m, suites(m)) for m in chosen], [], threading.Lock()
    threads = [threading.Thread(target=work_off, args=(queue, results, lock, k), daemon=True) for k in range(o.jobs)]
    try:
        for t in threads:
            t.start()
        for t in threads:
            t.join()
    finally:
        for pid in list(running):
            end(pid)
    caught = sum(outcome == "caught" for outcome, _ in results)
    for outcome, name in results:
        if outcome != "caught":
            print(f"{outcome}: {name}")
    print(f"{caught} of {len(results)} caught")
    sys.exit(0 if results and caught >= ENOUGH * len(results) else 1)


if __name__ == "__main__":
    main()
