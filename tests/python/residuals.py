"""Residual blocks of designs: their bits in the program, derivatives against differences, products, what is refused,
and least squares of scipy on the flagship."""
import csv
import unittest
from importlib.util import find_spec

import numpy as np

from common import SMALL, evaluate_by_program, main, near, same_bits, source, temp

import hifdm

GOALS = "optimize: {variables: [{set: all, vary: tension, range: 20 %}], objective: [{figure: psi}, " \
        "{figure: tension, set: boundary, target: 12, weight: 0.1}], " \
        "limits: [{figure: tension, set: all, bounds: [9.9, 11]}]}\n"
FLAGSHIP = source("configs/chen2022.yaml")


class Residuals(unittest.TestCase):
    def test_bits_are_those_of_the_program(self):
        for path in (temp("goals.yaml", SMALL + GOALS), source("configs/straight-edges-truss.yaml")):
            case, table = hifdm.open(path), temp("residuals.csv")
            designs = near(case, 2)
            evaluate_by_program(path, case, designs, "--residuals", table)
            with open(table, encoding="utf-8", newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(len(rows), 2 * sum(case.blocks.values()))
            for k, design in enumerate(designs):
                for name, n_row in case.blocks.items():
                    stored = [row for row in rows if row["id"] == str(k + 1) and row["block"] == name]
                    self.assertEqual(len(stored), n_row)
                    self.assertTrue(same_bits([float(row["value"]) for row in stored], case.residuals(design, name)))
                    self.assertTrue(same_bits([[float(row[name]) for name in case.variables] for row in stored],
                                              case.residual_jacobian(design, name)))

    def test_blocks(self):
        case = hifdm.open(temp("goals.yaml", SMALL + GOALS))
        design, names = near(case, 1)[0], ["objective_0_psi", "objective_1_tension_boundary"]
        self.assertEqual(list(case.blocks), [*names, "position_m", "tension_N"])
        out, shape = case.evaluate(design[np.newaxis]), case.shape(design)
        self.assertEqual(out.status[0], "out_of_limits")
        self.assertAlmostEqual(np.linalg.norm(case.residuals(design, names[1])),
                               0.1 * out["objective_1_tension_boundary"][0], delta=1e-8)
        self.assertTrue(same_bits(case.residuals(design), case.residuals(design, names)))
        self.assertTrue(np.allclose(case.residuals(design, "position_m").reshape(-1, 3), shape.position_m, atol=1e-9))
        self.assertTrue(np.allclose(case.residuals(design, "tension_N"), shape.tension_N, atol=1e-6))

    def test_order_and_products(self):
        case = hifdm.open(temp("goals.yaml", SMALL + GOALS))
        design, order = near(case, 1)[0], ["tension_N", "objective_1_tension_boundary", "tension_N"]
        for function in (case.residuals, case.residual_jacobian):
            self.assertTrue(same_bits(function(design, order), np.concatenate([function(design, n) for n in order])))
        jacobian = case.residual_jacobian(design, order)
        vector = np.random.default_rng(2).uniform(-1, 1, len(jacobian))
        size = np.abs(vector) @ np.abs(jacobian)
        self.assertTrue((np.abs(case.vjp(design, vector, order) - vector @ jacobian) <= 1e-12 * size).all())
        self.assertEqual(case.residuals(design, []).shape, (0,))
        self.assertFalse(case.vjp(design, np.empty(0), []).any())

    def test_gradient_is_that_of_psi(self):
        case = hifdm.open(FLAGSHIP)
        design = near(case, 1)[0]
        residual = case.residuals(design)
        self.assertAlmostEqual(np.linalg.norm(residual), case.shape(design).psi_m, delta=1e-12)
        gradient = case.vjp(design, residual) / np.linalg.norm(residual)
        self.assertTrue(np.allclose(gradient, case.jacobian(design[np.newaxis])[0, 0], rtol=1e-9, atol=1e-12))

    def test_scipy_reaches_the_optimum(self):
        if not find_spec("scipy"):
            print("skipped: least squares of scipy: no scipy")
            return
        from scipy.optimize import least_squares
        case = hifdm.open(FLAGSHIP)
        found = least_squares(lambda design: 1e3 * case.residuals(design), case.initial,
                              lambda design: 1e3 * case.residual_jacobian(design), bounds=(case.lower, case.upper))
        self.assertTrue(found.success)
        self.assertTrue((found.x >= case.lower).all() and (found.x <= case.upper).all())
        out = case.evaluate(found.x[np.newaxis])
        self.assertEqual(out.status[0], "ok")
        self.assertEqual(f"{1e3 * out.psi_m[0]:.4f}", "4.2834")

    def test_what_is_refused(self):
        case = hifdm.open(temp("goals.yaml", SMALL + GOALS))
        design, n = near(case, 1)[0], sum(list(case.blocks.values())[:2])
        with self.assertRaisesRegex(ValueError, "there is no block 'psi'; there are objective_0_psi, objective_1"):
            case.residuals(design, "psi")
        with self.assertRaisesRegex(ValueError, rf"vector has shape \({n + 1},\); expected .* shape \({n},\)"):
            case.vjp(design, np.ones(n + 1))
        for function in (case.residuals, case.residual_jacobian, lambda bad: case.vjp(bad, np.ones(n))):
            with self.assertRaisesRegex(TypeError, "design is of type list"):
                function(list(design))
            with self.assertRaisesRegex(hifdm.HifdmError, f"design 0: {case.variables[0]} must be a finite number"):
                function(-design)
        seeded = hifdm.open(FLAGSHIP, ["optimize.rule=seeded"])
        with self.assertRaisesRegex(hifdm.HifdmError, "no derivatives under optimize.rule seeded"):
            seeded.residuals(seeded.initial)

    def test_a_design_without_a_shape(self):
        variables = [{"set": "boundary", "vary": "support_xyz", "range": 0.1}]
        case = hifdm.open(temp("small.yaml", SMALL), {"optimize.variables": variables})
        far = case.initial + 1e300
        with self.assertRaisesRegex(hifdm.HifdmError, "has no residuals: .* nearer to the initial") as caught:
            case.residuals(far)
        self.assertEqual(caught.exception.status, case.evaluate(far[np.newaxis]).status[0])
        self.assertTrue(np.isfinite(case.residual_jacobian(case.initial)).all())


if __name__ == "__main__":
    main()
