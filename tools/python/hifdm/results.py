"""Result files as a thin layer over h5py. `h5` is the open file; include/hifdm/store.h lists its contents."""

from __future__ import annotations

import os

import numpy as np

from ._library import word
from .case import Shape

_WORDS = ("status", "stop_reason", "bound_reason")  # figures that are codes in a file
_STAGES = {"form": "form", "optimize": "ga/best", "polish": "polish"}


class Result:
    """An open result file. Open it when its run has ended, or in another process, because HDF5 is not thread-safe."""

    def __init__(self, path: str | os.PathLike):
        import h5py  # imported here, because the rest of the package does not need it

        self.h5 = h5py.File(path, "r")

    def __reduce__(self):
        raise TypeError("a Result is an open file and cannot be copied or pickled: pass its path, or arrays of it")

    def __enter__(self) -> Result:
        return self

    def __exit__(self, *_) -> None:
        self.h5.close()

    @property
    def stages(self) -> list[str]:
        """The stages with a shape: "form", "optimize", "polish", then the load cases as "cases/cold"."""
        states = [f"cases/{name}" for name, item in self.h5.get("cases", {}).items() if "position_m" in item]
        return [name for name, group in _STAGES.items() if group in self.h5] + states

    def shape(self, stage: str = "form") -> Shape:
        """Returns the arrays of a stage as hifdm.Shape, with the attributes of its group as figures."""
        group = self.h5[_STAGES.get(stage, stage)]
        arrays = {name: group[name][:] for name in ("position_m", "length_m", "tension_N", "q_N_per_m")}
        figures = {name: word(name, int(value)) if name in _WORDS else value for name, value in group.attrs.items()}
        return Shape(figures, {}, arrays)

    @property
    def end(self) -> np.ndarray:
        """[n_cable, 2] Indices of nodes."""
        return self.h5["scene/cable/end"][:]

    @property
    def psi_m(self) -> np.ndarray:
        """[generation, individual] psi in the genetic algorithm, m; NaN for infeasible individuals."""
        return self.h5["ga/psi_m"][:]

    @property
    def best_psi_m(self) -> np.ndarray:
        """[generation] Best psi, m."""
        return self.h5["ga/best_psi_m"][:]


def read(path: str | os.PathLike) -> Result:
    """Opens a result file."""
    return Result(path)
