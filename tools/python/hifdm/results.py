"""Reads result files with h5py. The attribute `h5` of a Result is the open HDF5 file. The header include/hifdm/store.h
describes the contents of a result file.

The module _renamed.py translates the names in result files of version 0.2. The class Result also reads files of version
0.2 and returns their results with the names of version 0.3."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from ._library import word
from ._renamed import Figures, Stage, new_key, new_stage, warn
from .case import Shape

_ARRAYS = ("position_m", "length_m", "tension_N", "q_N_per_m")
_LISTS = {"status": "status", "stop_reason": "stop_reason", "bound_reason": "bound_reason",
          "coupling_stop_reason": "coupling_stop"}  # figures that are codes in a file, and the lists of their words
_GROUPS = {"form": ["form"], "search": ["search", "ga/best"], "refine": ["refine", "polish"]}  # of 0.3, of 0.2
_OF_POPULATION = ("n_individual", "n_variable", "n_objective", "generations_limit", "store_every")  # in /ga of 0.2


class Result:
    """An open result file. HDF5 is not thread-safe. Do not open a result file while a run in the same process writes to
    this file."""

    def __init__(self, path: str | os.PathLike):
        import h5py  # imported here, because the rest of the package does not need it

        self.h5 = h5py.File(path, "r")

    def __reduce__(self):
        raise TypeError("a Result is an open file and cannot be copied or pickled: pass its path, or arrays of it")

    def __enter__(self) -> Result:
        return self

    def __exit__(self, *_) -> None:
        self.h5.close()

    def _group(self, stage: str):
        """Returns the HDF5 group that contains the shape of a stage, or None if the file has no shape of this stage."""
        for path in _GROUPS.get(stage) or [stage, stage.removeprefix("load_")]:
            if f"{path}/position_m" in self.h5:
                return self.h5[path]
        return None

    @property
    def stages(self) -> list[str]:
        """Returns the names of the stages that have a shape, such as "form", "search", "refine" or
        "load_cases/cold"."""
        load_cases = self.h5.get("load_cases", self.h5.get("cases", {}))
        names = [*_GROUPS, *(f"load_cases/{name}" for name in load_cases if name != "name")]
        return [Stage(name) for name in names if self._group(name)]

    def shape(self, stage: str = "form") -> Shape:
        """Returns the shape of a stage. The attribute `stages` lists the stages of the result file."""
        name = new_stage(stage)
        if name != stage:
            warn(repr(stage), repr(name))
        group = self._group(name)
        if group is None:
            raise KeyError(f"this file has no shape of '{name}'; it has {', '.join(self.stages)}")
        arrays = {array: group[array][:] for array in _ARRAYS}
        return Shape(self._figures(group), {}, arrays)

    def _figures(self, group) -> Figures:
        """Returns the attributes of an HDF5 group with the names of version 0.3. Codes are replaced by words."""
        is_search_of_0_2 = group.name == "/ga/best"
        figures = Figures()
        for name, value in (self.h5["ga"] if is_search_of_0_2 else group).attrs.items():
            if is_search_of_0_2 and name in _OF_POPULATION:
                continue
            if is_search_of_0_2 and name not in ("best_generation", "best_individual"):
                name = name.removeprefix("best_")
            name = name if name == "iterations" else new_key(name) or name
            value = value.decode() if isinstance(value, bytes) else value
            figures[name] = word(_LISTS[name], int(value)) if name in _LISTS else value
        return figures

    @property
    def end(self) -> np.ndarray:
        """[n_cable, 2] Indices of nodes."""
        return self.h5["scene/cable/end"][:]

    def _series(self, name: str) -> Any:
        return self.h5["search/population" if "search/population" in self.h5 else "ga"][name][:]

    @property
    def psi_m(self) -> np.ndarray:
        """[generation, individual] psi in the search, m. For infeasible individuals, psi is NaN."""
        return self._series("psi_m")

    @property
    def best_psi_m(self) -> np.ndarray:
        """[generation] Best psi of each generation, m."""
        return self._series("best_psi_m")


def read(path: str | os.PathLike) -> Result:
    """Opens a result file of version 0.3 or 0.2."""
    return Result(path)
