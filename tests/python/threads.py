"""Several threads of Python at the same time, and very many calls."""
import os
import threading
import time
import unittest

import numpy as np

from common import SMALL, main, near, same_bits, source, temp

import hifdm


def work(path, overrides, n_round):
    """Returns all results of a case as one list of arrays."""
    case = hifdm.open(path, overrides)
    found = [case.form().position_m, case.initial]
    for seed in range(n_round):
        designs = near(case, 40, seed)
        found += [case.evaluate(designs).table, case.jacobian(designs[:2]), case.shape(designs[3]).tension_N]
    found.append(np.array([case.run()["form"]["psi_m"]]))
    return found


def resident_kB():
    with open("/proc/self/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))


class Threads(unittest.TestCase):
    def test_two_cases_at_once(self):
        short = {"optimize.generations": 2, "optimize.refine_steps": 1}
        cases = [(source("configs/chen2022.yaml"), short, 6), (source("configs/straight-edges-truss.yaml"), short, 3)]
        alone = [work(*case) for case in cases]
        for _ in range(3):
            beside = [None] * len(cases)

            def put(k, beside=beside):
                beside[k] = work(*cases[k])

            threads = [threading.Thread(target=put, args=(k,)) for k in range(len(cases))]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            for one, other in zip(alone, beside):
                self.assertEqual(len(one), len(other))
                for a, b in zip(one, other):
                    self.assertTrue(same_bits(a, b))

    def test_two_threads_with_one_case(self):
        """Checks that the threads wait for each other."""
        case = hifdm.open(temp("small.yaml", SMALL))
        designs = near(case, 50)
        whole, wrong = case.evaluate(designs).table, []

        def check(k):
            for _ in range(100):
                if not same_bits(case.evaluate(designs[k::4].copy()).table, whole[:, k::4]):
                    wrong.append(k)
                if not same_bits(case.shape(designs[k]).psi_m, whole[1, k]):
                    wrong.append(k)

        threads = [threading.Thread(target=check, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_the_interpreter_goes_on(self):
        """Checks that another thread of Python continues while a batch runs: the GIL is released."""
        case = hifdm.open(source("configs/reflector.yaml"), threads=1)
        designs, beats, is_over = near(case, 300), [], threading.Event()
        case.form()

        def beat():
            while not is_over.is_set():
                beats.append(time.monotonic())
                time.sleep(0.001)

        thread = threading.Thread(target=beat)
        thread.start()
        start = time.monotonic()
        while time.monotonic() - start < 1 or len(beats) < 20:  # on a machine that is busy it may take longer
            begin = time.monotonic()
            case.evaluate(designs)
            end = time.monotonic()
        inside = sum(begin < moment < end for moment in beats)
        is_over.set()
        thread.join()
        self.assertGreater(inside, 0, (begin, end))


class Memory(unittest.TestCase):
    def test_very_many_batches_leak_nothing(self):
        case = hifdm.open(temp("tiny.yaml", SMALL), {"scene.parabolic_cylinder.modules": "[1,1]"}, threads=1)
        designs = near(case, 2)

        def rounds(n):
            for _ in range(n):
                case.evaluate(designs)
            return resident_kB()

        before = rounds(10_000)
        self.assertLess(rounds(100_000) - before, 1000)  # 10 bytes a call

    def test_cases_leak_nothing(self):
        path = temp("small.yaml", SMALL + "optimize: {population: 4, generations: 1}\n")

        def rounds(n):
            for _ in range(n):
                case = hifdm.open(path, threads=1)
                case.evaluate(near(case, 2))
                case.jacobian(near(case, 2))
                case.run()
                try:
                    hifdm.open(path, ["form.stop=no"])
                except hifdm.HifdmError:
                    pass
            return resident_kB()

        resident = [rounds(60) for _ in range(6)]  # what the threads of runs leave to malloc settles first
        self.assertLess(np.diff(resident).min(), 60 * 10, resident)  # kB; a case of this net has some 200


if __name__ == "__main__":
    main()
