"""The package hifdm computes the shape and the pretension of cable nets for mesh reflectors.

All arrays are numpy arrays. All values are in SI units. The suffix of each name is the unit of the value, as in psi_m.
If a call fails, the package raises HifdmError with the error message and the status. Example:

    import hifdm, numpy as np
    case = hifdm.open("configs/chen2022.yaml")
    shape = case.form()  # shape.psi_m, shape.position_m, shape.tension_N
    designs = case.initial + np.random.default_rng(1).uniform(-1, 1, (1000, case.n_variable))
    out = case.evaluate(designs)  # out.psi_m, on all cores
"""

from ._library import HifdmError, version as __version__
from .case import Case, Designs, HifdmWarning, Progress, Run, Shape, net, open
from .plots import plot_generations, plot_net
from .results import Result, read

__all__ = ["Case", "Designs", "HifdmError", "HifdmWarning", "Progress", "Result", "Run", "Shape", "net", "open",
           "plot_generations", "plot_net", "read"]
