"""Processes: results and exceptions of workers arrive, and objects of one process are refused in another."""
import concurrent.futures
import copy
import multiprocessing
import os
import pickle
import unittest

import numpy as np

from common import SMALL, main, near, same_bits, source, temp

import hifdm

HANG_S = 200  # for a test that fails in place of one that hangs


def evaluate(path):
    """Runs in a worker. Returns the figures of one design, or raises what hifdm raises."""
    case = hifdm.open(path)
    return case.evaluate(near(case, 1)), case.form()


def paths():
    return temp("small.yaml", SMALL), temp("wrong.yaml", SMALL + "form: {pretention_N: 1}\n")


class Across(unittest.TestCase):
    """Must be the first class of this script, because a process that has used hifdm cannot be forked."""

    def check(self, work):
        """Checks work(path), which returns what a worker returns for it."""
        good, wrong = paths()
        with self.assertRaises(hifdm.HifdmError) as caught:
            work(wrong)
        self.assertEqual(caught.exception.status, "bad_case")
        self.assertIn("wrong.yaml:3:8: pretention_N: unknown key; did you mean 'pretension_N'?", str(caught.exception))
        designs, shape = work(good)
        self.assertEqual(designs.feasible.tolist(), [True])
        self.assertEqual(shape.status, "ok")

    def test_a_pool(self):
        for start in ("fork", "spawn"):
            with self.subTest(start), multiprocessing.get_context(start).Pool(2) as pool:
                self.check(lambda path: pool.apply_async(evaluate, (path,)).get(HANG_S))

    def test_an_executor(self):
        for start in ("fork", "spawn"):
            context = multiprocessing.get_context(start)
            with self.subTest(start), concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as executor:
                self.check(lambda path: executor.submit(evaluate, path).result(HANG_S))


class Pickles(unittest.TestCase):
    def again(self, value):
        """Returns copies of a value: by each protocol of pickle, and by copy."""
        by_pickle = [pickle.loads(pickle.dumps(value, protocol)) for protocol in range(pickle.HIGHEST_PROTOCOL + 1)]
        return [*by_pickle, copy.copy(value), copy.deepcopy(value)]

    def test_errors_and_warnings(self):
        error = hifdm.HifdmError("not_converged", "no shape")
        error.point = 7
        for other in self.again(error):
            self.assertEqual((type(other), other.status, str(other), other.point),
                             (hifdm.HifdmError, "not_converged", "no shape", 7))
        for other in self.again(hifdm.HifdmWarning("slack")):
            self.assertEqual((type(other), str(other)), (hifdm.HifdmWarning, "slack"))
        for other in self.again(hifdm.Progress("form", 1, 2, 3, 0.5, 0.25)):
            self.assertEqual(other, hifdm.Progress("form", 1, 2, 3, 0.5, 0.25))

    def test_results(self):
        case = hifdm.open(paths()[0])
        shape, designs, run = case.form(), case.evaluate(near(case, 3)), case.run()
        for other in self.again(shape):
            self.assertEqual(repr(other.figures), repr(shape.figures))  # NaN is no number's equal
            self.assertTrue(same_bits(other.tension_N, shape.tension_N))
            self.assertEqual(repr(other), repr(shape))
        for other in self.again(designs):
            self.assertEqual(other.names, designs.names)
            self.assertTrue(same_bits(other.table, designs.table))
            self.assertTrue(same_bits(other.psi_m, designs.psi_m))
        for other in self.again(run):
            self.assertEqual((repr(other.figures), other.status, other.file, repr(other)),
                             (repr(run.figures), run.status, run.file, repr(run)))

    def test_what_belongs_to_its_process(self):
        case = hifdm.open(paths()[0], ["optimize.generations=1", "optimize.population=4"])
        case.run(temp("result.h5"), restart=True)
        with hifdm.read(temp("result.h5")) as result:
            for value, words in ((case, "open it in each process"), (result, "pass its path")):
                for make in (pickle.dumps, copy.copy, copy.deepcopy):
                    with self.assertRaisesRegex(TypeError, "cannot be copied or pickled: " + words):
                        make(value)
        self.assertEqual(case.form().status, "ok")  # and still works

    def test_a_pool_after_hifdm_was_used(self):
        """Checks that the workers refuse and that their exception arrives."""
        hifdm.open(paths()[0]).form()
        with multiprocessing.get_context("fork").Pool(1) as pool, self.assertRaises(hifdm.HifdmError) as caught:
            pool.apply_async(evaluate, paths()[:1]).get(HANG_S)
        self.assertEqual(caught.exception.status, "bad_usage")

    def test_every_class_is_here(self):
        told = {"Case", "Designs", "HifdmError", "HifdmWarning", "Progress", "Result", "Run", "Shape"}
        self.assertEqual({name for name in hifdm.__all__ if isinstance(getattr(hifdm, name), type)}, told)


if __name__ == "__main__":
    main()
