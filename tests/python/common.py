"""Shared by the scripts here: the program, cases, and random designs. Each script runs as `script.py FOLDER`."""
import csv
import os
import subprocess
import sys
import unittest
import warnings

import numpy as np

import hifdm

PROGRAM = os.environ["HIFDM"]
SOURCES = os.environ.get("HIFDM_SOURCE_DIR", ".")
FOLDER = sys.argv[1]
SMALL = ("scene:\n  parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, modules: [2, 3], "
         "cells_per_module: [2, 2], scallop: 0.1}\n")
warnings.simplefilter("ignore", hifdm.HifdmWarning)


def source(path):
    return os.path.join(SOURCES, path)


def temp(name, text=None):
    path = os.path.join(FOLDER, name)
    if text is not None:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    return path


def program(*arguments, status=0):
    """Runs the program and returns its standard output."""
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False)
    if done.returncode != status:
        raise AssertionError(f"{arguments}: status {done.returncode}: {done.stderr}")
    return done.stdout


def near(case, n, seed=1, part=0.02):
    """Returns designs [n, n_variable] around the initial design."""
    random = np.random.default_rng(seed).uniform(-1, 1, (n, case.n_variable))
    return case.initial * (1 + part * random) + np.where(case.initial == 0, 1e-3 * random, 0)


def evaluate_by_program(path, case, designs, *more):
    """Returns the rows of `hifdm evaluate` as dictionaries; with `more` also its derivatives."""
    table, results = temp("designs.csv"), temp("results.csv")
    with open(table, "w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([case.variables, *[[repr(float(x)) for x in row] for row in designs]])
    program("evaluate", path, "--designs", table, "-o", results, "--force", "--quiet", *more)
    with open(results, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def same_bits(a, b):
    """Returns true if all values are equal, with NaN equal to NaN."""
    return np.array_equal(np.asarray(a, float), np.asarray(b, float), equal_nan=True)


def main():
    unittest.main(argv=sys.argv[:1], verbosity=0, warnings="ignore")
