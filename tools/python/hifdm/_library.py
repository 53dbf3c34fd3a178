"""Loads the shared library and its flat interface (include/hifdm/flat.h) with ctypes. During each call, ctypes releases
Python's global interpreter lock (GIL)."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
from collections.abc import Iterator
from ctypes import CFUNCTYPE, POINTER, c_char_p, c_double, c_int, c_long, c_ubyte, c_void_p
from pathlib import Path

INTERFACE = 2  # HF_FLAT_INTERFACE that this package is written for
_WAITING = {"OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "2000"}  # as in hf_batch_wait_quietly
Observer = CFUNCTYPE(c_int, c_void_p, c_int, c_long, c_long, c_long, c_double, c_double)

_texts, _ints, _reals, _codes = POINTER(c_char_p), POINTER(c_int), POINTER(c_double), POINTER(c_ubyte)
# Functions: result, arguments. A test compares them with flat.h.
PROTOTYPES = {
    "interface": (c_int, []),
    "version": (c_char_p, []),
    "word": (c_char_p, [c_char_p, c_int]),
    "code": (c_int, [c_char_p, c_char_p]),
    "create": (c_void_p, []),
    "free": (None, [c_void_p]),
    "messages": (c_char_p, [c_void_p]),
    "open": (c_int, [c_void_p, c_char_p, c_int, _texts, c_int]),
    "nodes": (None, [c_void_p, c_int, _reals, _codes, _reals, _texts]),
    "cables": (None, [c_void_p, c_int, _ints, _codes, _codes, _reals, _reals, _texts]),
    "sets": (None, [c_void_p, c_int, _texts, _ints, _ints]),
    "open_net": (c_int, [c_void_p, c_char_p, c_char_p, c_int, _texts, c_int]),
    "text": (c_char_p, [c_void_p, c_char_p, c_int]),
    "ints": (c_int, [c_void_p, c_char_p, _ints]),
    "reals": (c_int, [c_void_p, c_char_p, _reals]),
    "form": (c_int, [c_void_p]),
    "evaluate": (c_int, [c_void_p, c_int, _reals, _reals]),
    "shape": (c_int, [c_void_p, _reals]),
    "slopes": (c_int, [c_void_p, c_int, _reals, _reals]),
    "residuals": (c_int, [c_void_p, _reals, c_int, _reals, _reals]),
    "vjp": (c_int, [c_void_p, _reals, c_int, _reals, _reals]),
    "run": (c_int, [c_void_p, c_char_p, c_int, Observer, c_void_p]),
    "set_reader": (None, [_texts]),
    "read": (None, [c_char_p]),
    "stop": (None, [c_void_p]),
}


class HifdmError(Exception):
    """An error of the library. The string value of the exception is the error message.

    `status`: the reason as a word, such as "bad_case", "not_converged" or "no_memory".
    """

    def __init__(self, status: str, message: str):
        super().__init__(status, message)  # arguments from which pickle makes it again in another process
        self.status = status

    def __str__(self) -> str:
        return self.args[1]


def _candidates() -> list[str]:
    """Returns the candidate paths of the shared library. If the environment variable HIFDM_LIBRARY is set, its value is
    the only candidate path. The dynamic loader searches for the last candidate, because it is a file name without a
    folder."""
    given = os.environ.get("HIFDM_LIBRARY")
    if given:
        return [given]
    here = Path(__file__).resolve()
    lib = here.parents[3]  # of PREFIX/lib/pythonX/dist-packages/hifdm
    paths = [lib / "libhifdm.so.1", *lib.glob("*-linux-*/libhifdm.so.1")]
    if (lib / "Makefile").exists():  # tools/python/hifdm in the sources
        paths.append(lib / "build" / "libhifdm.so")
    return [str(path) for path in paths if path.exists()] + ["libhifdm.so.1"]


@contextlib.contextmanager
def _quiet_waiting() -> Iterator[None]:
    """Lets waiting OpenMP threads sleep unless the user has set a wait policy. The program `hifdm` also lets its
    waiting threads sleep.

    OpenMP reads its environment variables when the OpenMP library is loaded. By default, waiting OpenMP threads spin
    for one millisecond. Evaluating small batches with spinning threads takes three times as much processor time as with
    sleeping threads.
    """
    ours = {} if {"OMP_WAIT_POLICY", "GOMP_SPINCOUNT"} & os.environ.keys() else _WAITING
    os.environ.update(ours)
    try:
        yield
    finally:
        for name in ours:
            del os.environ[name]


# Reads a result file in a process of its own.
_READ = "import ctypes, os, sys; ctypes.CDLL(sys.argv[1]).hf_flat_read(os.fsencode(sys.argv[2]))"


def _reader(library: str) -> ctypes.Array | None:
    """Returns the command that reads an existing output file in a new process. Returns None if no Python interpreter
    is available.

    By default, a run reads an existing output file in a forked process. The HDF5 conversions of h5py wait for the GIL.
    If another thread holds the GIL during the fork, the HDF5 conversions in the forked process wait forever.
    """
    if not sys.executable or getattr(sys, "frozen", False):
        return None
    path = os.path.abspath(library) if os.sep in library else library  # the working folder may change later
    words = [sys.executable, "-I", "-S", "-c", _READ, path]
    return (c_char_p * (len(words) + 1))(*map(os.fsencode, words), None)


def _load() -> ctypes.CDLL:
    faults = []
    for path in _candidates():
        try:
            with _quiet_waiting():
                found = ctypes.CDLL(path)
            found.hf_flat_interface.restype = c_int
            interface = found.hf_flat_interface()
            break
        except (OSError, AttributeError) as fault:
            faults.append(str(fault))
    else:
        raise ImportError(f"libhifdm cannot be used: {'; '.join(faults)}; install it, or set HIFDM_LIBRARY to its path")
    if interface != INTERFACE:
        raise ImportError(f"{path} has the interface {interface}, this package is for {INTERFACE}: "
                          "install library and package of the same version")
    for name, (result, arguments) in PROTOTYPES.items():
        function = getattr(found, f"hf_flat_{name}")
        function.restype, function.argtypes = result, arguments
    for name in ("hf_status_word", "hf_status_text"):
        getattr(found, name).restype = c_char_p
    found.reader = _reader(path)  # an attribute, because the library borrows it
    found.hf_flat_set_reader(found.reader)
    found.gsl_set_error_handler_off()  # GSL's default handler would end the process where it only reports no progress
    return found


lib = _load()  # before numpy, whose BLAS may load OpenMP

import numpy as np  # noqa: E402  pylint: disable=wrong-import-position,wrong-import-order

version: str = lib.hf_flat_version().decode()


def status_word(status: int) -> str:
    return lib.hf_status_word(status).decode()


def word(of: str, code: int) -> str:
    """Returns the name of an integer code, such as "inner". The argument `of` selects the enumeration, such as
    "role"."""
    found = status_word(code) if of == "status" else lib.hf_flat_word(of.encode(), code)
    return "unknown" if found is None else found if isinstance(found, str) else found.decode()


def c_text(text: bytes) -> bytes:
    """Returns the string unchanged. Raises ValueError if the string contains a NUL character."""
    if b"\0" in text:
        raise ValueError(f"{text.decode(errors='replace')!r} has a NUL character")
    return text


def text_list(items: list[str]) -> ctypes.Array:
    return (c_char_p * max(len(items), 1))(*[c_text(item.encode()) for item in items])


_pointer_of = {np.dtype(np.float64): _reals, np.dtype(np.int32): _ints, np.dtype(np.uint8): _codes}


def pointer(array: np.ndarray | None):
    """Returns a pointer to the data of an array. The caller must keep the array alive while the pointer is in use."""
    return None if array is None else array.ctypes.data_as(_pointer_of[array.dtype])


def wanted(name: str, array, dtype, shape: tuple) -> np.ndarray:
    """Returns the array itself if it has the given dtype and shape in C order. If an element of the argument `shape` is
    None, the array can have any length along this axis.

    Otherwise, raises TypeError or ValueError. The error message contains the name, the actual type or shape, and the
    required type and shape of the argument.
    """
    want = "(" + ", ".join("n" if n is None else str(n) for n in shape) + ("," if len(shape) == 1 else "") + ")"
    want = f"a numpy array of dtype {np.dtype(dtype)} and shape {want} in C order"
    if not isinstance(array, np.ndarray):
        raise TypeError(f"{name} is of type {type(array).__name__}; expected {want}")
    if array.dtype != np.dtype(dtype):
        raise TypeError(f"{name} has dtype {array.dtype}; expected {want}")
    fits = array.ndim == len(shape) and all(n is None or n == m for n, m in zip(shape, array.shape))
    if not fits:
        raise ValueError(f"{name} has shape {array.shape}; expected {want}")
    if not array.flags.c_contiguous or not array.flags.aligned:
        raise ValueError(f"{name} is not contiguous in C order; expected {want}: numpy.ascontiguousarray makes one")
    return array
