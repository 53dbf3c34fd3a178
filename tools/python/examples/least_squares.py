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


def psi_mm(design):
    out = case.evaluate(design[np.newaxis])
    return out.psi_m * 1e3 if out.feasible[0] else [1e3]  # so large that scipy takes the step back


def slopes(design):
    return case.jacobian(design[np.newaxis])[0] * 1e3


found = least_squares(psi_mm, case.initial, slopes, bounds=(case.lower, case.upper), max_nfev=30)
print(f"psi {psi_mm(case.initial)[0]:.4f} -> {found.fun[0]:.4f} mm in {found.nfev} evaluations")
