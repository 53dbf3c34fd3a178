"""A run that finds an existing result file while another thread holds the lock of the interpreter (the GIL).

The run reads this file first in another process, because HDF5 may crash on a damaged file. h5py registers conversions
of types in HDF5, and these wait for the GIL. A copy of this process would wait for ever, because the thread that holds
the GIL does not exist in the copy.
"""
import ctypes
import os
import resource
import sys
import termios
import threading
import unittest

try:
    import h5py  # noqa: F401  before hifdm, as a user may do
except ImportError:
    print("skipped: h5py")
    sys.exit()

from common import SMALL, main, temp

import hifdm
from hifdm._library import lib

python = ctypes.PyDLL(None)  # its calls keep the GIL


def children():
    """Returns page faults of the children that this process has waited for, which grow with each child."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_minflt


def n_waiting(descriptor):
    """Returns the bytes that wait in a pipe."""
    n = ctypes.c_int()
    python.ioctl(descriptor, ctypes.c_ulong(termios.FIONREAD), ctypes.byref(n))
    return n.value


def hold_forks():
    """Lets each fork of this process first read a byte from standard input. Returns where to write it."""
    read, write = os.pipe()
    os.dup2(read, 0)
    register = getattr(python, "pthread_atfork", None) or python.__register_atfork
    register(ctypes.cast(python.getchar, ctypes.c_void_p), None, None, None)
    return write


class HeldLock(unittest.TestCase):
    def run_beside_a_holder(self, case, path):
        """Runs the case. From before the other process exists until it has ended, this thread holds the GIL."""
        begun, found, run, write = threading.Event(), [], lib.hf_flat_run, hold_forks()

        def begin(*arguments):
            begun.set()  # the other thread takes the GIL when the following call releases it
            return run(*arguments)

        before = children()
        thread = threading.Thread(target=lambda: found.append(case.run(path)))
        sys.setswitchinterval(1e6)  # no thread must give away the GIL
        lib.hf_flat_run = begin
        thread.start()
        begun.wait()
        python.write(write, b"\n", 1)
        while children() == before:
            if n_waiting(0) == 0:
                print("the run copies this process while another thread holds the GIL", flush=True)
                os._exit(1)  # the copy blocks and ends with this process
        sys.setswitchinterval(0.005)
        thread.join()
        lib.hf_flat_run = run
        return found[0]

    def test_a_result_that_exists(self):
        case = hifdm.open(temp("case.yaml", SMALL + "optimize: {population: 4, generations: 1}\n"))
        first = case.run(temp("result.h5"))
        again = self.run_beside_a_holder(case, temp("result.h5"))
        self.assertEqual(first["search"]["psi_m"], again["search"]["psi_m"])


if __name__ == "__main__":
    main()
