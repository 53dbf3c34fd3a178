"""Names of version 0.2: each row of the table "Python" in src/manual/renames.md works with a DeprecationWarning, and
result files with the old names are read. The example of the README of 0.2.0 runs on files of this version."""
import os
import re
import subprocess
import sys
import unittest
import warnings

import h5py
import numpy as np

from common import SMALL, main, near, program, same_bits, source, temp

import hifdm

CASE = SMALL.replace("scene:\n", "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n") + """\
optimize: {population: 6, generations: 2, method: ga+lm, goals: [{goal: psi}, {goal: ratio, set: all, weight: 1e-3}]}
cables: [{expansion_per_K: -1e-6}]
cases: [{name: cold, temperature_K: -50}]
tolerance: {samples: 20, sigma_cut_m: 5e-5}
"""
# In the README of version 0.2.0, commit 4cdb071.
EXAMPLE = """\
import h5py
f = h5py.File("results/chen2022.h5")
psi = f["ga/psi_m"][:]              # [generation, individual]
shape = f["ga/best/position_m"][:]  # [node, xyz]
ids = f["scene/node/id"].asstr()[:]
best_m = f["ga"].attrs["best_psi_m"]
"""
# Attributes of /form and of load cases that only this version has. The groups that moved are not copied.
NEW_ATTRIBUTES = ["has_search", "has_refine", "n_variable", "wall_s", "tension_min_N", "tension_max_N",
                  "displacement_rms_m", "member_force_max_N", "coupling_deflection_max_m"]
NEW_GROUPS = ["search", "variable", "refine", "load_cases", "objective"]


def with_old_names(path, name):
    """Makes a file with the names of version 0.2 alone, from what a file of this version has under these names."""
    with h5py.File(path) as new, h5py.File(temp(name), "w") as old:
        for key in new:
            if key not in NEW_GROUPS + ["VTKHDF"]:
                new.copy(new[key], old, key, expand_soft=True)
        for key, value in new.attrs.items():
            old.attrs[key] = value
        old.attrs["format_version"] = np.int32(2)
        if "goals" in old:
            del old["goals/search"], old["goals/refine"]
        for group in (old, old["form"], *(old["cases"].values() if "cases" in old else ())):
            for attribute in NEW_ATTRIBUTES:
                if attribute in group.attrs:
                    del group.attrs[attribute]
    return temp(name)


def rows_of_the_manual():
    """Returns the rows of the table "Python" as texts: old name, with old value if there is one, and new name."""
    with open(source("src/manual/renames.md"), encoding="utf-8") as file:
        section = file.read().split("\n## Python\n")[1].split("\n## ")[0]
    cells = [[cell.strip(" `") for cell in line.split("|")[1:4]] for line in section.splitlines() if "`" in line and
             line.startswith("|")]
    return [(f"{old} {value}".strip(), new) for old, value, new in cells]


class Names(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.path, cls.seen = temp("renamed.yaml", CASE), []
        cls.case = hifdm.open(cls.path)
        cls.run_ = cls.case.run(temp("renamed.h5"), restart=True, progress=cls.seen.append)
        cls.shape = cls.case.form()
        cls.designs = cls.case.evaluate(near(cls.case, 3))
        cls.checked = []

    def check(self, row, find, wanted, *words):
        """Checks the value that find() returns, and that it warns once, here, with these words."""
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = find()
        self.assertEqual([warning.category for warning in caught], [DeprecationWarning], row)
        self.assertEqual(caught[0].filename, __file__, row)
        for word in (*words, "version 0.4 will refuse the old name"):
            self.assertIn(word, str(caught[0].message), row)
        if isinstance(wanted, np.ndarray) and wanted.dtype.kind == "f":
            self.assertTrue(same_bits(found, wanted), row)
        else:
            self.assertEqual(np.asarray(found).tolist() if isinstance(wanted, np.ndarray) else found,
                             wanted.tolist() if isinstance(wanted, np.ndarray) else wanted, row)
        self.checked.append(row)

    def test_every_row_of_the_manual(self):
        for owner, old, new in ((self.case, "base", "initial"), (self.case, "genes", "variables"),
                                (self.case, "gene_units", "variable_units"),
                                (self.case, "gene_leader", "variable_leader"), (self.case, "n_gene", "n_variable"),
                                (self.case, "theoretical_m", "target_position_m"),
                                (self.shape, "goals", "objectives"), (self.designs, "goal_names", "objective_names")):
            kind = type(owner).__name__
            row = f"{kind}.{old}", f"{kind}.{new}"
            self.check(row, lambda owner=owner, old=old: getattr(owner, old), getattr(owner, new), *row)
        row = "Designs.goal_N_FIGURE_SET", "Designs.objective_N_FIGURE_SET"
        self.check(row, lambda: self.designs.goal_1_ratio_all, self.designs.objective_1_ratio_all, "goal_1_ratio_all",
                   "objective_1_ratio_all")
        for old, new in (("optimize", "search"), ("polish", "refine"), ("cases", "load_cases")):
            row = f'Run["{old}"]', f'Run["{new}"]'
            self.check(row, lambda old=old: self.run_[old], self.run_[new], repr(old), repr(new))
        for old, new in (("optimize", "search"), ("polish", "refine")):
            phase = next(now.phase for now in self.seen if now.phase == new)
            self.check((f'Progress.phase "{old}"', f'"{new}"'), lambda phase=phase, old=old: phase == old, True,
                       repr(old), repr(new))
        with self.run_.read() as result:
            for old, new in (("optimize", "search"), ("polish", "refine"), ("cases/cold", "load_cases/cold")):
                row = f'Result.stages, Result.shape "{old}"'.replace("cold", "NAME"), f'"{new}"'.replace("cold", "NAME")
                self.check(row, lambda result=result, old=old: old in result.stages, True, repr(old), repr(new))
                self.check(row, lambda result=result, old=old: result.shape(old).tension_N,
                           result.shape(new).tension_N, repr(old), repr(new))
        self.assertEqual({(old.replace("`, `", ", "), new) for old, new in rows_of_the_manual()}, set(self.checked))

    def test_figures_and_items(self):
        """Checks old names of figures in dictionaries, and of columns."""
        for words, find, wanted in (
                (("'base_psi_m'", "'initial_psi_m'"), lambda: self.run_["search"]["base_psi_m"],
                 self.run_["search"]["initial_psi_m"]),
                (("'lm_iterations'", "'steps'"), lambda: self.run_["refine"]["lm_iterations"],
                 self.run_["refine"]["steps"]),
                (("'goals'", "'objectives'"), lambda: self.run_["form"]["goals"], self.run_["form"]["objectives"]),
                (("'least_N'", "'min_N'"), lambda: self.run_["form"]["sets"]["edge"]["least_N"],
                 self.run_["form"]["sets"]["edge"]["min_N"]),
                (("'move_rms_m'", "'displacement_rms_m'"), lambda: self.run_["load_cases"]["cold"]["move_rms_m"],
                 self.run_["load_cases"]["cold"]["displacement_rms_m"]),
                (("'goal_0_psi'", "'objective_0_psi'"), lambda: self.shape.objectives["goal_0_psi"],
                 self.shape.objectives["objective_0_psi"]),
                (("'goal_0_psi'", "'objective_0_psi'"), lambda: self.designs["goal_0_psi"],
                 self.designs["objective_0_psi"]),
                (("'optimize'", "'search'"), lambda: self.run_.get("optimize"), self.run_["search"]),
                (("'optimize'", "'search'"), lambda: "optimize" in self.run_, True)):
            self.check(words, find, wanted, *words)

    def test_names_that_never_were(self):
        for find, words in ((lambda: self.case.bases, "a Case has no attribute 'bases'"),
                            (lambda: self.shape.goal, "there is no goal; there are status"),
                            (lambda: self.designs.goal_7_psi, "there is no goal_7_psi; there are status")):
            with self.assertRaisesRegex(AttributeError, words):
                find()
        for find in (lambda: self.run_["form"]["lm_iterations"], lambda: self.run_["form"]["base"]):
            with self.assertRaises(KeyError):
                find()
        phase = next(now.phase for now in self.seen if now.phase == "search")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertTrue(phase != "polish" and phase != 1 and hash(phase) == hash("search"))
            self.assertEqual(f"{phase} {phase!r}", "search 'search'")

    def test_a_user_sees_the_warning(self):
        """Checks that Python shows the warning without an option, with the line of the script."""
        script = temp("user.py", "import hifdm, sys\ncase = hifdm.open(sys.argv[1])\nprint(len(case.base))\n")
        done = subprocess.run([sys.executable, script, self.path], capture_output=True, text=True, check=True)
        self.assertIn("user.py:3: DeprecationWarning: Case.base is now Case.initial; ", done.stderr)


class Files(unittest.TestCase):
    def test_example_of_the_readme_of_0_2_0(self):
        found = []
        program("run", source("configs/chen2022.yaml"), "-o", temp("new.h5"), "--restart", "--quiet",
                "--set", "optimize.generations=3", "--set", "optimize.population=10")
        for path in (temp("new.h5"), with_old_names(temp("new.h5"), "old.h5")):
            names, before = {}, os.getcwd()
            os.makedirs(temp("results"), exist_ok=True)
            os.replace(path, temp("results/chen2022.h5"))
            try:
                os.chdir(temp(""))
                exec(compile(EXAMPLE, "README of 0.2.0", "exec"), names)
            finally:
                os.chdir(before)
            names["f"].close()
            found.append(names)
            os.replace(temp("results/chen2022.h5"), path)
        for name in ("psi", "shape", "ids", "best_m"):
            new, old = found[0][name], found[1][name]
            self.assertEqual((np.shape(new), np.asarray(new).dtype), (np.shape(old), np.asarray(old).dtype), name)
            self.assertEqual(np.asarray(new).tobytes() if name != "ids" else new.tolist(),
                             np.asarray(old).tobytes() if name != "ids" else old.tolist(), name)
        with hifdm.read(temp("new.h5")) as result:
            self.assertTrue(same_bits(found[0]["psi"], result.h5["search/population/psi_m"][:]))
            self.assertTrue(same_bits(found[0]["shape"], result.h5["search/position_m"][:]))
            self.assertEqual(found[0]["best_m"], result.h5["search"].attrs["psi_m"])
            self.assertEqual(found[0]["psi"].shape, (3, 10))

    def test_old_names_alone(self):
        hifdm.open(temp("renamed.yaml", CASE)).run(temp("renamed.h5"), restart=True)
        old_path = with_old_names(temp("renamed.h5"), "renamed-old.h5")
        with hifdm.read(temp("renamed.h5")) as new, hifdm.read(old_path) as old:
            self.assertEqual(new.stages, ["form", "search", "refine", "load_cases/cold"])
            self.assertNotIn("search", old.h5)
            self.assertNotIn("search", old.h5["goals"])
            self.assertEqual(old.stages, new.stages)
            self.assertTrue(same_bits(new.psi_m, old.psi_m) and same_bits(new.best_psi_m, old.best_psi_m))
            for stage in new.stages:
                a, b = new.shape(stage), old.shape(stage)
                self.assertTrue(same_bits(a.position_m, b.position_m) and same_bits(a.tension_N, b.tension_N), stage)
                figures = {name: str(value) for name, value in a.figures.items() if name != "algorithm"}
                self.assertEqual(figures, {name: str(value) for name, value in b.figures.items()}, stage)
                self.assertEqual(a.stop_reason, "converged")
                old_names = [name for name in figures if re.match("best_psi|polish_|least_|largest_|n_gene", name)]
                self.assertFalse(old_names)

    def test_a_file_of_0_1_0(self):
        made = temp("0.1.0.h5")
        subprocess.run([sys.executable, source("tests/cli/old_result.py"), "file",
                        source("tests/cli/data/result-0.1.0.json"), made], check=True)
        with hifdm.read(made) as result:
            self.assertEqual(result.stages, ["form", "search", "refine", "load_cases/cold"])
            search, refined, cold = (result.shape(stage) for stage in result.stages[1:])
            self.assertEqual(search.psi_m, result.h5["ga"].attrs["best_psi_m"])
            self.assertEqual(search.wall_s, result.h5["ga"].attrs["optimize_wall_s"])
            self.assertEqual(refined.psi_m, result.h5["polish"].attrs["psi_m"])
            self.assertEqual(refined.steps, result.h5["polish"].attrs["polish_iterations"])
            self.assertEqual(cold.tension_max_N, result.h5["cases/cold"].attrs["largest_tension_N"])
            self.assertEqual((refined.stop_reason, search.stop_reason, cold.stop_reason, refined.coupling_stop_reason),
                             ("direct", "converged", "converged", "converged"))  # words of today
            self.assertEqual(result.best_psi_m[-1], search.psi_m)
            with self.assertRaisesRegex(KeyError, "no shape of 'load_cases/hot'; it has form, search, refine, load_"):
                result.shape("load_cases/hot")


if __name__ == "__main__":
    main()
