"""Defines the classes for cases, shapes, designs and runs. A case can evaluate designs and execute complete runs."""

from __future__ import annotations

import ctypes
import json
import os
import threading
import warnings
import weakref
from typing import TYPE_CHECKING, Any, Callable, Iterator, Mapping, NamedTuple, Sequence

import numpy as np

from ._library import HifdmError, Observer, c_text, lib, pointer, status_word, text_list, wanted, word
from ._renamed import ATTRIBUTES, Figures, Stage, new_key, old_attribute, user_level, warn

Overrides = Mapping[str, Any] | Sequence[str]
_process = {"pid": os.getpid(), "is_used": False}


class HifdmWarning(UserWarning):
    """A warning of the library."""


class Progress(NamedTuple):
    """The progress of a run."""

    phase: str  # "form", "search", "refine" or "tolerance"
    done: int  # generations of "search", steps of "refine", points of a front, or samples of "tolerance"
    all: int  # maximum of `done`
    evaluations: int  # in this run
    best_psi_m: float  # NaN while no design is feasible
    elapsed_s: float  # time since the phase began


class Shape:
    """A shape. Each quantity of the shape is an attribute, such as psi_m, residual_N or status. The attribute `figures`
    is a dict of all quantities."""

    position_m: np.ndarray  # [n_node, 3] m, supports included
    length_m: np.ndarray  # [n_cable] m
    tension_N: np.ndarray  # [n_cable] N
    q_N_per_m: np.ndarray  # [n_cable] N/m, force densities

    def __init__(self, figures: dict[str, Any], objectives: dict[str, float], arrays: dict[str, np.ndarray]):
        self.figures = Figures(figures)  # {name: figure}
        self.objectives = Figures(objectives)  # {name: value}, each in its own unit, without its weight
        self.__dict__.update(arrays)

    def __getattr__(self, name: str) -> Any:
        figures = self.__dict__.get("figures", {})
        if name in ATTRIBUTES["Shape"]:
            return old_attribute(self, name)
        try:
            return figures[name]
        except KeyError:
            raise AttributeError(f"there is no {name}; there are {', '.join(figures)}") from None

    def __repr__(self) -> str:
        return f"<hifdm.Shape: {self.status}, psi {self.psi_m * 1e3:.4f} mm>"


class Designs:
    """The results of n designs. Each quantity, such as psi_m or merit, is a column with one value for each design. Each
    column can be accessed as an attribute or as an item."""

    def __init__(self, names: list[str], n_objective: int, table: np.ndarray):
        self.names = names
        self.objective_names = names[len(names) - n_objective:]
        self.table = table  # [n_figure, n]; the status is a code

    def __getitem__(self, name: str) -> np.ndarray:
        """Returns a column [n]. For designs without the requested quantity, the column contains NaN."""
        new = new_key(name)
        if name not in self.names and new in self.names:
            warn(repr(name), repr(new))
            name = new
        if name not in self.names:
            raise KeyError(f"there is no {name}; there are {', '.join(self.names)}")
        column = self.table[self.names.index(name)]
        if name == "status":
            return np.array([word("status", int(code)) for code in column], dtype=str)
        return column.astype(int) if name == "iterations" else column

    def __getattr__(self, name: str) -> np.ndarray:
        names = self.__dict__.get("names", ())
        if name in ATTRIBUTES["Designs"]:
            return old_attribute(self, name)
        if name in names or new_key(name) in names:
            return self[name]
        raise AttributeError(f"there is no {name}; there are {', '.join(names)}")

    def __len__(self) -> int:
        return self.table.shape[1]

    @property
    def feasible(self) -> np.ndarray:
        """[n] bool: True for feasible designs."""
        return self.table[0] == 0

    @property
    def best(self) -> int:
        """Returns the index of the feasible design with the minimum merit, or -1 if no design is feasible. If the case
        contains the key `optimize.front`, the designs have no merit."""
        merit = np.where(self.feasible, self["merit"], np.inf)
        return int(merit.argmin()) if self.feasible.any() else -1

    def columns(self) -> dict[str, np.ndarray]:
        """Returns all columns as a dict that pandas.DataFrame accepts."""
        return {name: self[name] for name in self.names}


class Run(Mapping[str, Any]):
    """A finished run. A Run is a mapping with the same contents as the output of `hifdm run --json`."""

    def __init__(self, figures: dict[str, Any]):
        self.figures = Figures(figures)
        self.status: str = figures["status"]
        self.file: str | None = figures.get("file")  # the result file, if the run has written one

    def __getitem__(self, stage: str) -> Any:
        """Returns the results of a stage, such as "form", or of another part of the summary, such as "load_cases"."""
        try:
            return self.figures[stage]
        except KeyError:
            parts = [key for key, value in self.figures.items() if isinstance(value, (dict, list))]
            raise KeyError(f"this run has no '{new_key(stage) or stage}'; it has {', '.join(parts)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.figures)

    def __len__(self) -> int:
        return len(self.figures)

    def __repr__(self) -> str:
        shapes = [(stage, self.figures[stage]["psi_m"]) for stage in ("form", "search", "refine")
                  if (self.figures.get(stage) or {}).get("psi_m") is not None]
        parts = [f"{stage} psi {psi_m * 1e3:.4g} mm" for stage, psi_m in shapes]
        return f"<hifdm.Run {self.status}: {', '.join(parts + [self.file] if self.file else parts)}>"

    def read(self):
        """Opens the result file (hifdm.read)."""
        from .results import read

        if self.file is None:
            raise HifdmError("io", "this run wrote no file")
        return read(self.file)


def _lines(set: Overrides) -> list[str]:
    if isinstance(set, Mapping):
        return [f"{key}={value if isinstance(value, str) else json.dumps(value, default=_plain)}"
                for key, value in set.items()]
    if isinstance(set, str):
        raise TypeError("set is a text; expected a list of 'key=value', or a dict")
    return list(set)


def _plain(value: Any) -> Any:
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"a key of the case has a value of type {type(value).__name__}")


class _Lock:
    """Allows only one thread at a time to use a case. A run holds the lock of its case while it calls the function
    `progress`. The function `progress` must not use the case of the run."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self.observing: int | None = None  # ident of that thread while it is in `progress`

    def __enter__(self) -> None:
        if self.observing == threading.get_ident():
            raise HifdmError("bad_usage", "progress uses the case whose run calls it; take what it needs of the case "
                                          "before the run")
        self._lock.acquire()

    def __exit__(self, *_: Any) -> None:
        self._lock.release()


class Case:
    """Represents a case. The functions hifdm.open and hifdm.net create cases. Only one thread at a time can use a case.
    Other threads wait. Indices start at 0."""

    def __init__(self, open_handle: Callable[[int], int], keep: Any = ()):
        self._lock = _Lock()
        self._check_process()
        self._handle = lib.hf_flat_create()
        if not self._handle:
            raise MemoryError("no memory for a case")
        self._keep = keep  # memory that the library borrows
        self._shape: Shape | None = None
        weakref.finalize(self, lib.hf_flat_free, self._handle)
        self._call(open_handle, self._handle)
        self.title = self._texts("title")[0]
        self.node_ids, self.cable_ids = self._texts("node_id"), self._texts("cable_id")
        self.variables = self._texts("variable")  # names: ids of cables, or of supports with .x, .y, .z
        self.variable_units = self._texts("variable_unit")  # "N", "N/m" or "m"
        # [n_variable] index of the variable whose change each takes by symmetry, or its own
        self.variable_leader = self._numbers("variable_leader", dtype=np.int32)
        self.figure_names = self._texts("figure")  # columns of evaluate
        self.slope_names = self._texts("slope")  # figures of jacobian
        # {name: number of rows} of residuals, in order: psi_m or the objectives, position_m, tension_N
        self.blocks = dict(zip(self._texts("block"), self._numbers("block_rows", dtype=np.int32).tolist()))
        self.n_node, self.n_cable, self.n_variable = len(self.node_ids), len(self.cable_ids), len(self.variables)
        self.target_position_m = self._numbers("target_position_m", 3)  # [n_node, 3] of supports the real positions
        self.role = self._words("role")  # [n_node] "support", "inner" or "edge"
        self.end = self._numbers("end", 2, dtype=np.int32)  # [n_cable, 2] indices of nodes
        self.group = self._words("group")  # [n_cable] "inner" or "boundary"
        self.law = self._words("law")  # [n_cable] "tension", "length", "force_density" or "elastic"
        self.target = self._numbers("target")  # [n_cable] N, m, N/m or m by law; NaN: the pretension of the case
        self.load_N = self._numbers("load_N", 3)  # [n_node, 3], or [0, 3] without loads
        self.EA_N = self._numbers("EA_N")  # [n_cable], NaN if not given; [0] if no cable has one
        start, cable = (self._numbers(name, dtype=np.int32) for name in ("set_start", "set_cable"))
        self.sets = {name: cable[start[k]:start[k + 1]] for k, name in enumerate(self._texts("set_name"))}
        self._objectives = self._texts("objective")
        self._result = [self._texts(name) for name in ("result", "result_kind")]

    if not TYPE_CHECKING:  # so that a type checker finds attributes that do not exist

        def __getattr__(self, name: str) -> Any:
            return old_attribute(self, name)

    def __reduce__(self) -> Any:
        raise TypeError("a Case belongs to its process and cannot be copied or pickled: open it in each process, "
                        "and pass designs and results")

    # ---- calls ----

    @staticmethod
    def _check_process() -> None:
        if os.getpid() != _process["pid"] and _process["is_used"]:
            raise HifdmError("bad_usage", "hifdm has worked in the process that this one was forked from, and its "
                                          "threads did not come along; use multiprocessing with 'spawn'")
        _process.update(pid=os.getpid())

    def _call(self, function: Callable, *arguments: Any) -> int:
        """Calls the library and issues the warnings of the library as Python warnings. Raises HifdmError if the call
        fails."""
        self._check_process()
        _process["is_used"] = True
        status = function(*arguments)
        lines = lib.hf_flat_messages(self._handle).decode().splitlines()
        for line in lines:
            if line.startswith("warning: "):
                warnings.warn(line[len("warning: "):], HifdmWarning, stacklevel=user_level())
        if status:
            errors = [line[len("error: "):] for line in lines if line.startswith("error: ")]
            raise HifdmError(status_word(status), "\n".join(errors) or lib.hf_status_text(status).decode())
        return status

    def _texts(self, of: str) -> list[str]:
        found: list[str] = []
        with self._lock:
            while (text := lib.hf_flat_text(self._handle, of.encode(), len(found))) is not None:
                found.append(text.decode())
                if of in ("title", "solver", "summary"):
                    break
        return found

    def _numbers(self, name: str, *shape: int, dtype=np.float64) -> np.ndarray:
        get = lib.hf_flat_reals if dtype is np.float64 else lib.hf_flat_ints
        with self._lock:
            to = np.empty(get(self._handle, name.encode(), None), dtype)
            get(self._handle, name.encode(), pointer(to))
        return to.reshape(-1, *shape)

    def _words(self, of: str) -> np.ndarray:
        return np.array([word(of, code) for code in self._numbers(of, dtype=np.int32)], dtype=str)

    # ---- the shape, and designs ----

    def _take_shape(self) -> Shape:
        codes = self._numbers("result")
        figures = {name: float(code) if kind == "real" else int(code) if kind == "int" else word(kind, int(code))
                   for name, kind, code in zip(*self._result, codes)}
        objectives = {name: figures.pop(name) for name in self._objectives}
        arrays = {name: self._numbers(name) for name in ("length_m", "tension_N", "q_N_per_m")}
        return Shape(figures, objectives, {"position_m": self._numbers("position_m", 3), **arrays})

    def form(self) -> Shape:
        """Finds the equilibrium shape of the net.

        Raises HifdmError if the net has no equilibrium shape, or if the iteration does not converge.
        """
        with self._lock:
            if self._shape is None:
                self._call(lib.hf_flat_form, self._handle)
                self._shape = self._take_shape()
            return self._shape

    def shape(self, design: np.ndarray) -> Shape:
        """Returns the shape of one design [n_variable]. For an infeasible design, the method raises no exception. The
        attribute `status` of the shape gives the reason why a design is infeasible."""
        design = wanted("design", design, float, (self.n_variable,))
        with self._lock:
            self.form()
            self._call(lib.hf_flat_shape, self._handle, pointer(design))
            return self._take_shape()

    def _after_form(self, name: str) -> np.ndarray:
        with self._lock:
            self.form()
            return self._numbers(name)

    @property
    def initial(self) -> np.ndarray:
        """[n_variable] The initial design. form() returns its shape. `variable_units` lists the units of its values."""
        return self._after_form("initial")

    @property
    def lower(self) -> np.ndarray:
        """[n_variable] Lower bounds of the design variables. If a design variable has no lower bound, its entry is
        -inf."""
        return self._after_form("lower")

    @property
    def upper(self) -> np.ndarray:
        """[n_variable] Upper bounds of the design variables. If a design variable has no upper bound, its entry is
        inf."""
        return self._after_form("upper")

    @property
    def solver(self) -> str:
        """Returns the name of the solver that the method `evaluate` uses for designs."""
        with self._lock:
            self.form()
            return self._texts("solver")[0]

    def evaluate(self, designs: np.ndarray) -> Designs:
        """Evaluates designs [n, n_variable] on all processor cores. `variable_units` lists the units of the design
        variables. The results are bit-identical to the output of the command `hifdm evaluate`."""
        designs = wanted("designs", designs, float, (None, self.n_variable))
        table = np.empty((len(self.figure_names), len(designs)))
        with self._lock:
            self.form()
            self._call(lib.hf_flat_evaluate, self._handle, len(designs), pointer(designs), pointer(table))
        return Designs(self.figure_names, len(self._objectives), table)

    def jacobian(self, designs: np.ndarray) -> np.ndarray:
        """Returns exact derivatives for all designs [n, n_variable] as an array [n, n_slope, n_variable]. The
        derivatives of infeasible designs are NaN.

        `slope_names` lists the differentiated quantities. If the case has objectives, the method differentiates the
        objectives and the merit. If the case has no objectives, the method differentiates only psi_m. The unit of a
        derivative is the unit of the differentiated quantity divided by the unit of the design variable.
        """
        designs = wanted("designs", designs, float, (None, self.n_variable))
        slopes = np.empty((len(designs), len(self.slope_names), self.n_variable))
        with self._lock:
            self.form()
            self._call(lib.hf_flat_slopes, self._handle, len(designs), pointer(designs), pointer(slopes))
        return slopes

    def _select(self, blocks: str | Sequence[str] | None) -> tuple[int, int, np.ndarray]:
        """Returns the bits of the selected blocks for the library, the number of their rows, and the indices of these
        rows in the order of the selection."""
        known = list(self.blocks)
        names = known[:-2] if blocks is None else [blocks] if isinstance(blocks, str) else list(blocks)
        for name in names:
            if name not in self.blocks:
                raise ValueError(f"there is no block {name!r}; there are {', '.join(known)}")
        bits, n, rows = 0, 0, {}
        for i, name in enumerate(known):
            if name in names:
                bits |= 1 << i
                rows[name] = np.arange(n, n + self.blocks[name])
                n += self.blocks[name]
        return bits, n, np.concatenate([np.empty(0, int), *(rows[name] for name in names)])

    def residuals(self, design: np.ndarray, blocks: str | Sequence[str] | None = None) -> np.ndarray:
        """Returns the residuals [n_row] of one design [n_variable].

        `blocks`: name or names of blocks of residuals, in the order of the rows. The attribute `blocks` lists the names
        and numbers of rows. The default is all objectives, or psi_m if the case has no objectives. The norm of these
        residuals is the merit of the design. The block "position_m" has the rows [n_node, 3] of Shape.position_m, and
        the block "tension_N" has the rows of Shape.tension_N.

        Raises HifdmError if the design has no shape. A design that violates only limits has residuals.
        """
        design = wanted("design", design, float, (self.n_variable,))
        bits, n, rows = self._select(blocks)
        residual = np.empty(n)
        with self._lock:
            self.form()
            self._call(lib.hf_flat_residuals, self._handle, pointer(design), bits, pointer(residual), None)
        return residual[rows]

    def residual_jacobian(self, design: np.ndarray, blocks: str | Sequence[str] | None = None) -> np.ndarray:
        """Returns the exact derivatives [n_row, n_variable] of residuals(design, blocks) with respect to the design
        variables. Each derivative keeps all other variables constant."""
        design = wanted("design", design, float, (self.n_variable,))
        bits, n, rows = self._select(blocks)
        residual, jacobian = np.empty(n), np.empty((n, self.n_variable))
        with self._lock:
            self.form()
            self._call(lib.hf_flat_residuals, self._handle, pointer(design), bits, pointer(residual), pointer(jacobian))
        return jacobian[rows]

    def vjp(self, design: np.ndarray, vector: np.ndarray, blocks: str | Sequence[str] | None = None) -> np.ndarray:
        """Returns the product [n_variable] of a vector [n_row] and the array residual_jacobian(design, blocks), which
        is not stored."""
        design = wanted("design", design, float, (self.n_variable,))
        bits, n, rows = self._select(blocks)
        vector = wanted("vector", vector, float, (len(rows),))
        in_order, product = np.zeros(n), np.empty(self.n_variable)
        np.add.at(in_order, rows, vector)
        with self._lock:
            self.form()
            self._call(lib.hf_flat_vjp, self._handle, pointer(design), bits, pointer(in_order), pointer(product))
        return product

    # ---- a run ----

    def run(self, output: str | os.PathLike | None = None, *, restart: bool = False,
            progress: Callable[[Progress], Any] | None = None) -> Run:
        """Executes all stages of the case, as the command `hifdm run` does.

        `output`: path of the result file, or None to write no file. If the result file contains an interrupted run, the
        method resumes this run.

        `restart`: if True, an interrupted run is not resumed, but replaced by a new run.

        `progress`: a function that is called in a separate thread during the run. If `progress` returns False, the run
        stops with the status "interrupted". If `progress` raises an exception, the run stops and raises the same
        exception. Ctrl-C also stops the run. The function `progress` must not use the case of the run.
        """
        path = None if output is None else c_text(os.fsencode(output))
        raised: list[BaseException] = []
        outcome: list[int] = []

        def observe(_: Any, phase: int, *now: Any) -> int:
            self._lock.observing = threading.get_ident()
            try:
                return int(progress is not None and progress(Progress(Stage(word("phase", phase)), *now)) is False)
            except BaseException as fault:
                raised.append(fault)
                return 1
            finally:
                self._lock.observing = None

        def work() -> None:
            outcome.append(lib.hf_flat_run(self._handle, path, int(restart), observer, None))

        observer = Observer(observe)
        with self._lock:
            worker = threading.Thread(target=work, name="hifdm run")  # so that this thread can be interrupted
            worker.start()
            while worker.is_alive():
                try:
                    worker.join(0.2 if raised else None)
                except BaseException as fault:
                    raised.append(fault)
                if raised:  # repeatedly, because a run clears earlier requests when it begins
                    lib.hf_flat_stop(self._handle)
            if raised:
                raise raised[0]
            figures = json.loads(self._texts("summary")[0], object_hook=Figures)
            was_stopped = status_word(outcome[0]) == "interrupted"
            self._call(lambda: 0 if was_stopped else outcome[0])
        return Run(figures)


def open(path: str | os.PathLike, set: Overrides = (), *, threads: int = 0) -> Case:
    """Opens a case file.

    `set`: values that override keys of the case file, such as {"form.pretension_N": 12} or ["form.pretension_N=12"].

    `threads`: number of threads, or 0 to use all cores.
    """
    lines = _lines(set)
    given = os.fsencode(path)
    full = given if os.path.isabs(given) else os.path.join(os.getcwdb(), given)  # a run reads the file again
    keep = (c_text(full), text_list(lines))
    return Case(lambda handle: lib.hf_flat_open(handle, keep[0], len(lines), keep[1], threads), keep)


def _codes(name: str, words: str | Sequence[str] | np.ndarray, of: str, n: int) -> np.ndarray:
    """Returns an array of n integer codes. The argument `words` can be one string, n strings, or an array of n codes
    (uint8)."""
    if isinstance(words, np.ndarray) and words.dtype.kind != "U":
        return wanted(name, words, np.uint8, (n,))
    each = [words] * n if isinstance(words, str) else list(words)
    if len(each) != n:
        raise ValueError(f"{name} has {len(each)} words; expected one word or {n}")
    code_of = {text: lib.hf_flat_code(of.encode(), c_text(str(text).encode())) for text in {*each}}
    for text, code in code_of.items():
        if code < 0:
            known = [each for each in (word(of, code) for code in range(9)) if each != "unknown"]
            raise ValueError(f"{name} has {text!r}; expected one of {', '.join(known)}")
    return np.array([code_of[text] for text in each], np.uint8)


def _ids(name: str, ids: Sequence[str] | None, n: int) -> ctypes.Array | None:
    if ids is not None and len(ids) != n:
        raise ValueError(f"{name} has {len(ids)} ids; wanted are {n}")
    return None if ids is None else text_list([str(item) for item in ids])


def _members(name: str, cables: Sequence[int]) -> np.ndarray:
    """Returns the indices of the cables in a set, in ascending order."""
    given = np.asarray(cables)
    if given.ndim != 1 or given.size and given.dtype.kind not in "iu":
        raise TypeError(f"sets[{name!r}] has dtype {given.dtype} and {given.ndim} dimensions; "
                        "expected a list of integers, the indices of cables")
    index = given.astype(np.int32)
    if (index != given).any():
        raise ValueError(f"sets[{name!r}] names a cable that there is not")
    return np.sort(index)


def _sets(sets: Mapping[str, Sequence[int]]) -> tuple:
    """Returns the sorted names of the sets, the start index of each set, and the cable indices of all sets."""
    names = sorted(sets, key=lambda name: name.encode())
    members = [_members(name, sets[name]) for name in names]
    start = np.cumsum([0] + [len(member) for member in members], dtype=np.int32)
    return text_list(names), start, np.concatenate(members + [np.empty(0, np.int32)])


def net(position_m: np.ndarray, end: np.ndarray, *, role: str | Sequence[str] | np.ndarray,
        group: str | Sequence[str] | np.ndarray = "inner", law: str | Sequence[str] | np.ndarray = "tension",
        value: np.ndarray | None = None, EA_N: np.ndarray | None = None, load_N: np.ndarray | None = None,
        node_ids: Sequence[str] | None = None, cable_ids: Sequence[str] | None = None,
        sets: Mapping[str, Sequence[int]] | None = None, set: Overrides = (), threads: int = 0,
        **sections: Any) -> Case:
    """Creates a case from arrays. The case uses the arrays without copying them. Do not change the arrays while the
    case exists.

    `position_m`: target positions of free nodes and real positions of supports [n_node, 3], m.

    `end`: indices of the two end nodes of each cable [n_cable, 2], int32.

    `role`: role of each node, which is "support", "inner" or "edge". Only the nodes with the role "inner" contribute to
    psi. The arguments `role`, `group` and `law` accept one string for all items, a sequence of strings, or an array of
    codes (uint8).

    `group`: group of each cable, which is "inner" or "boundary". Without the key `optimize.variables`, the pretensions
    of the cables in the group "boundary" are the design variables.

    `law`: law of each cable, which is "tension", "length", "force_density" or "elastic".

    `value`: target value of the law of each cable [n_cable], in N (tension), m (length), N/m (force density) or m
    (unstressed length). If the target value is NaN, hifdm uses a default value. For the law "tension", the default
    value is the key `form.pretension_N`. For the law "length", the default is the distance between the target positions
    of the end nodes.

    `EA_N`: axial stiffness of each cable [n_cable], N.

    `load_N`: loads on the nodes [n_node, 3], N.

    `sets`: the indices of the cables of each set, by the name of the set.

    `sections`: sections of a case file, such as form={"pretension_N": 10}.
    """
    wanted("position_m", position_m, float, (None, 3))
    wanted("end", end, np.int32, (None, 2))
    n_node, n_cable = len(position_m), len(end)
    for name, array, *shape in (("value", value, n_cable), ("EA_N", EA_N, n_cable), ("load_N", load_N, n_node, 3)):
        if array is not None:
            wanted(name, array, float, tuple(shape))
    codes = [_codes("role", role, "role", n_node), _codes("group", group, "group", n_cable),
             _codes("law", law, "law", n_cable)]
    ids = [_ids("node_ids", node_ids, n_node), _ids("cable_ids", cable_ids, n_cable)]
    members, lines = _sets(sets or {}), _lines(set)
    scene = {**sections.pop("scene", {}), "import": {"nodes": "nodes.csv", "cables": "cables.csv"}}
    text = json.dumps({"scene": scene, **sections}, default=_plain, ensure_ascii=False, indent=1).encode()
    texts = text_list(lines)

    def open_handle(handle: int) -> int:
        lib.hf_flat_nodes(handle, n_node, pointer(position_m), pointer(codes[0]), pointer(load_N), ids[0])
        lib.hf_flat_cables(handle, n_cable, pointer(end), pointer(codes[1]), pointer(codes[2]), pointer(value),
                           pointer(EA_N), ids[1])
        lib.hf_flat_sets(handle, len(sets or {}), members[0], pointer(members[1]), pointer(members[2]))
        return lib.hf_flat_open_net(handle, b"arrays", text, len(lines), texts, threads)

    return Case(open_handle, (position_m, end, value, EA_N, load_N, codes, ids, members, text, texts))
