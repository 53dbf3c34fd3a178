"""Runs the code in README.md and src/MANUAL.md that uses our package."""
import os
import re
import unittest

from common import main, source, temp

import hifdm


def pieces(path):
    """Returns the indented pieces that import hifdm."""
    with open(source(path), encoding="utf-8") as file:
        found = re.findall(r"(?:^    .*\n)+", file.read(), flags=re.M)
    ours = [piece for piece in found if re.search("^    import hifdm", piece, flags=re.M)]
    return [re.sub("^    ", "", piece, flags=re.M) for piece in ours]


def run(piece):
    """Runs a piece in a folder with the configs and returns the names that it defines."""
    names, before = {}, os.getcwd()
    if not os.path.exists(temp("configs")):
        os.symlink(os.path.abspath(source("configs")), temp("configs"))
    try:
        os.chdir(temp(""))
        exec(compile(piece, "documents", "exec"), names)
    finally:
        os.chdir(before)
    return names


class Documents(unittest.TestCase):
    def test_manual(self):
        piece, = pieces("src/MANUAL.md")
        names = run(piece)
        case, out = names["case"], names["out"]
        self.assertEqual(out.psi_m.shape, (1000,))
        self.assertGreater(out.feasible.sum(), 900)
        self.assertEqual(names["slopes"].shape, (1, 1, case.n_variable))
        self.assertIsInstance(names["run"], hifdm.Run)
        self.assertLess(names["run"]["search"]["psi_m"], case.form().psi_m)

    def test_readme(self):
        for piece in pieces("README.md"):
            run(piece)


if __name__ == "__main__":
    main()
