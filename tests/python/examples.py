"""Runs every example of tools/python/examples and checks its output."""
import glob
import os
import re
import subprocess
import sys
import unittest
from importlib.util import find_spec

from common import main, program, source, temp

import hifdm

CASE = source("configs/chen2022.yaml")


def example(name, *arguments):
    """Returns the output of an example; None if a module is missing."""
    path = source(f"tools/python/examples/{name}.py")
    with open(path, encoding="utf-8") as file:
        needed = set(re.findall(r"^(?:import|from) (\w+)", file.read(), flags=re.M))
    for module in sorted(needed):
        if not find_spec(module):
            print(f"skipped: example {name}.py: no {module}")
            return None
    done = subprocess.run([sys.executable, "-W", "ignore", path, *arguments], capture_output=True, text=True,
                          check=False)
    if done.returncode or done.stderr:
        raise AssertionError(f"{name}: {done.stdout}{done.stderr}")
    return done.stdout


def numbers(text):
    return [float(word) for word in re.findall(r"(?<![\w.])-?\d+\.?\d*(?:e-?\d+)?(?![\w.])", text)]


class Examples(unittest.TestCase):
    def test_none_is_forgotten(self):
        there = {os.path.basename(path)[:-3] for path in glob.glob(source("tools/python/examples/*.py"))}
        self.assertEqual(there, {"least_squares", "ask_tell", "table", "net_of_arrays", "run_and_read"})

    def finds_optimum(self, name):
        """Checks that a search gets most of the way to the optimum of Levenberg-Marquardt, which has the same bounds.
        Examples print four decimals."""
        before, after = numbers(example(name, CASE))[:2]
        optimum = hifdm.open(CASE, {"optimize.method": "lm"}).run()["refine"]["psi_m"] * 1e3
        self.assertGreaterEqual(after, optimum - 6e-5)
        self.assertLess(after - optimum, 0.1 * (before - optimum))

    def test_least_squares(self):
        self.finds_optimum("least_squares")

    def test_ask_tell(self):
        self.finds_optimum("ask_tell")

    def test_table(self):
        said = example("table", CASE)
        if said is not None:
            self.assertRegex(said, r"ok +1000\.0")
            self.assertEqual(len(said.split("differ most:\n")[1].splitlines()), 5)

    def draws(self, path):
        """Checks that a file is a whole PNG with content."""
        with open(path, "rb") as file:
            content = file.read()
        self.assertEqual(content[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(len(content), 10_000)

    def pictures(self, name):
        if find_spec("matplotlib"):
            return [temp(name)]
        print(f"skipped: {name}: no matplotlib")
        return []

    def test_net_of_arrays(self):
        picture = self.pictures("net.png")
        said = numbers(example("net_of_arrays", *picture))
        self.assertEqual(said[:2], [81, 112])
        self.assertLess(said[2], 1e-9)
        # its z balances 5 N: 4 chains of 20 N would give 5 N with slopes of 1/16, the nodes around it move as well
        self.assertLess(said[3], -30)
        for path in picture:
            self.draws(path)

    def test_run_and_read(self):
        picture = self.pictures("generations.png")
        said = example("run_and_read", CASE, temp("read.h5"), *picture)
        program("run", CASE, "-o", temp("program.h5"), "--quiet", "--restart", "--set", "optimize.generations=40")
        program("diff", temp("read.h5"), temp("program.h5"))
        self.assertIn("generation 40 of 40", said)
        self.assertIn("form, search, refine", said)
        for path in picture:
            self.draws(path)


if __name__ == "__main__":
    main()
