"""Translates the names of version 0.2 into the names of version 0.3. Version 0.3 accepts the names of version 0.2 with
a DeprecationWarning. Version 0.4 will reject the names of version 0.2."""

from __future__ import annotations

import sys
import warnings
from typing import Any

ATTRIBUTES = {  # by class
    "Case": {"base": "initial", "genes": "variables", "gene_units": "variable_units",
             "gene_leader": "variable_leader", "n_gene": "n_variable", "theoretical_m": "target_position_m"},
    "Shape": {"goals": "objectives"},
    "Designs": {"goal_names": "objective_names"},
}
STAGES = {"optimize": "search", "polish": "refine"}  # phases of a run have the same names
KEYS = {  # of figures in a Shape, a Run or a result file
    **STAGES, "cases": "load_cases", "goals": "objectives",
    "n_gene": "n_variable", "form_wall_s": "wall_s", "max_displacement_m": "deflection_max_m",
    "coupling_max_displacement_m": "coupling_deflection_max_m", "least_N": "min_N", "largest_N": "max_N",
    "base_psi_m": "initial_psi_m", "independent_genes": "independent_variables", "lm_iterations": "steps",
    "optimize_stop": "algorithm_stop", "optimize_wall_s": "wall_s", "optimize_cpu_s": "cpu_s",
    "polish_iterations": "steps", "polish_stop": "algorithm_stop", "polish_evaluations": "evaluations",
    "polish_is_result": "is_result", "polish_n_at_lower": "n_at_lower", "polish_n_at_upper": "n_at_upper",
    "polish_is_at_cap": "is_at_cap", "polish_n_at_limit": "n_at_limit", "polish_wall_s": "wall_s",
    "least_tension_N": "tension_min_N", "largest_tension_N": "tension_max_N", "move_rms_m": "displacement_rms_m",
    "largest_member_N": "member_force_max_N", "least": "min", "largest": "max",
    "base": "initial", "iterations": "steps",  # the last two: of a front and its points
}


def new_key(key: str) -> str | None:
    """Returns the new name of a quantity, a stage or an objective, or None if the name has not changed."""
    if key.startswith("goal_"):
        return "objective_" + key[len("goal_"):].replace("_displacement", "_deflection")
    return KEYS.get(key)


def new_stage(stage: str) -> str:
    """Returns the new name of a stage or a phase. For a load case, the new name is "load_cases/NAME"."""
    return "load_" + stage if stage.startswith("cases/") else STAGES.get(stage, stage)


def user_level() -> int:
    """Returns the `stacklevel` for a warning that refers to the calling line of the user's program."""
    level = 2
    while level < 12 and sys._getframe(level).f_globals.get("__name__", "").startswith(("hifdm.", "collections.abc")):
        level += 1
    return level


def warn(old: str, new: str) -> None:
    warnings.warn(f"{old} is now {new}; version 0.4 will refuse the old name", DeprecationWarning,
                  stacklevel=user_level())


def old_attribute(owner: Any, name: str) -> Any:
    """Returns the attribute that had the given name in version 0.2. Raises AttributeError if version 0.2 had no
    attribute with the given name."""
    kind = type(owner).__name__
    new = ATTRIBUTES[kind].get(name)
    if new is None:
        raise AttributeError(f"a {kind} has no attribute {name!r}")
    warn(f"{kind}.{name}", f"{kind}.{new}")
    return getattr(owner, new)


class Figures(dict):
    """Quantities by name. If a program uses a name of version 0.2, Python issues a DeprecationWarning."""

    def __missing__(self, key: str) -> Any:
        new = new_key(key) if isinstance(key, str) else None
        if new not in self:
            raise KeyError(key)
        warn(repr(key), repr(new))
        return self[new]


class Stage(str):
    """Represents the name of a stage or a phase of a run. A comparison with the old name of the stage also returns
    True, but issues a DeprecationWarning."""

    def __eq__(self, other: Any) -> bool:
        is_equal = str.__eq__(self, other)
        if is_equal is False and isinstance(other, str) and str.__eq__(self, new_stage(other)):
            warn(repr(str(other)), repr(str(self)))
            return True
        return is_equal

    def __ne__(self, other: Any) -> bool:
        is_equal = self.__eq__(other)
        return is_equal if is_equal is NotImplemented else not is_equal

    __hash__ = str.__hash__
