"""Least squares of scipy with exact derivatives: finds the tensions with the minimum psi within the bounds of the case.

    python3 tools/python/examples/least_squares.py configs/chen2022.yaml
"""
import sys

import numpy as np
from scipy.optimize import least_squares

import hifdm

if len(sys.argv) < 2:
    sys.exit("usage:" + __doc__.split("\n\n")[1].rstrip())
case = hifdm.open(sys.argv[1])


def residuals_mm(design):
    return case.residuals(design) * 1e3


def jacobian_mm(design):
    return case.residual_jacobian(design) * 1e3


def psi_mm(design):
    return np.linalg.norm(residuals_mm(design))


found = least_squares(residuals_mm, case.initial, jacobian_mm, bounds=(case.lower, case.upper))
print(f"psi {psi_mm(case.initial):.4f} -> {psi_mm(found.x):.4f} mm in {found.nfev} evaluations")
