"""What the package refuses, and with which messages: arrays, cases, designs, runs, and a library that does not fit."""
import os
import re
import shutil
import subprocess
import sys
import unittest

import numpy as np

from common import SMALL, main, near, source, temp

import hifdm
from hifdm import _library

POSITION = np.array([[0, 0, 0], [1, 0, 0.5], [2, 0, 0], [1, 1, 0], [1, -1, 0.0]])
END = np.array([[0, 1], [1, 2], [1, 3], [4, 1]], np.int32)
ROLE = ["support", "inner", "support", "support", "support"]


class Errors(unittest.TestCase):
    def refused(self, kind, words, function, *arguments, **more):
        with self.assertRaises(kind) as caught:
            function(*arguments, **more)
        for part in [words] if isinstance(words, str) else words:
            self.assertIn(part, str(caught.exception))
        return caught.exception

    def net(self, position=POSITION, end=END, role=ROLE, **more):
        return hifdm.net(position, end, **{"role": role, **more})

    def test_arrays_of_designs(self):
        case = hifdm.open(temp("small.yaml", SMALL))
        designs, want = near(case, 4), f"dtype float64 and shape (n, {case.n_variable}) in C order"
        for function, name in ((case.evaluate, "designs"), (case.jacobian, "designs")):
            self.refused(TypeError, [f"{name} has dtype float32;", want], function, designs.astype(np.float32))
            self.refused(TypeError, [f"{name} is of type list;", want], function, designs.tolist())
            self.refused(ValueError, [f"{name} has shape (4, 3);", want], function, designs[:, :3].copy())
            self.refused(ValueError, [f"{name} has shape ({case.n_variable},);", want], function, designs[0])
            self.refused(ValueError, [f"{name} is not contiguous in C order", want], function,
                         np.asfortranarray(designs))
            self.refused(ValueError, f"{name} is not contiguous in C order", function, designs[::2])
        self.refused(ValueError, f"design has shape (4, {case.n_variable});", case.shape, designs)
        for bad in (0, -1, np.nan, np.inf):
            designs[2, 1] = bad
            error = self.refused(hifdm.HifdmError, f"design 2: {case.variables[1]} must be a finite number above zero, "
                                 "not ", case.evaluate, designs)
            self.assertEqual(error.status, "bad_case")
        self.assertEqual(len(case.evaluate(np.empty((0, case.n_variable)))), 0)
        self.assertEqual(case.evaluate(near(case, 2)).psi_m.shape, (2,))  # the case still works
        out = case.evaluate(near(case, 1))
        self.refused(AttributeError, "there is no psi; there are status, psi_m", lambda: out.psi)
        self.refused(AttributeError, "there is no psi; there are status,", lambda: case.form().psi)

    def test_arrays_of_a_net(self):
        for part, arguments in {
            "position_m has dtype float32; expected a numpy array of dtype float64 and shape (n, 3)":
                {"position": POSITION.astype(np.float32)},
            "end has dtype int64; expected a numpy array of dtype int32 and shape (n, 2)":
                {"end": END.astype(np.int64)},
            "value has dtype int64; expected": {"value": np.arange(4)},
            "role has dtype int64; expected a numpy array of dtype uint8 and shape (5,)": {"role": np.arange(5)},
        }.items():
            self.refused(TypeError, part, self.net, **arguments)
        for part, arguments in {
            "position_m has shape (5, 2)": {"position": POSITION[:, :2].copy()},
            "position_m is not contiguous": {"position": np.asfortranarray(POSITION)},
            "EA_N has shape (5,); expected a numpy array of dtype float64 and shape (4,)": {"EA_N": np.ones(5)},
            "load_N has shape (4, 3);": {"load_N": np.ones((4, 3))},
            "role has 4 words; expected one word or 5": {"role": ROLE[:4]},
            "role has 'free'; expected one of support, inner, edge": {"role": ["free", *ROLE[1:]]},
            "law has 'spring'; expected one of tension, length, force_density, elastic": {"law": "spring"},
            "node_ids has 2 ids; wanted are 5": {"node_ids": ["a", "b"]},
        }.items():
            self.refused(ValueError, part, self.net, **arguments)

    def test_nets(self):
        bad, far = END.copy(), POSITION.copy()
        bad[3, 0], far[1, 2] = 5, np.nan
        for part, arguments in {
            "scene: cable '3' ends at node 5, but nodes count from 0 to 4": {"end": bad},
            "scene: node '1' has a position that is no number": {"position": far},
            "scene: cable '2' is refused: value must be above zero for the law tension":
                {"value": np.array([1, 1, 0, 1.0])},
            "scene: cable '2' is refused: value must be a finite number": {"value": np.array([1, 1, np.inf, 1])},
            "scene: cable '0' is refused: the law elastic needs a value, the unstressed length in m":
                {"law": "elastic"},
            "scene: cable '1' is refused: EA_N must be a finite number above zero":
                {"EA_N": np.array([1, -1, 1, 1.0])},
            "scene: node '3' has a role that is none of 0 to 2": {"role": np.array([0, 1, 0, 7, 0], np.uint8)},
            "scene: cable '3' has a law that there is not": {"law": np.array([0, 0, 0, 9], np.uint8)},
            "scene: cable '0' has a group that is none of 0 and 1": {"group": np.array([2, 0, 0, 0], np.uint8)},
            "scene: node 'a' has an id that was used before": {"node_ids": list("abcda")},
            "scene: cable '' has an empty id": {"cable_ids": ["a", "", "c", "d"]},
            "has an id longer than 255 bytes": {"cable_ids": ["a" * 256, "b", "c", "d"]},
            "scene: the set 'all' is the name of all cables": {"sets": {"all": [0]}},
            "scene: the set 'a b' must be made of letters": {"sets": {"a b": [0]}},
            "scene: the set 'a' names a cable that there is not": {"sets": {"a": [0, 4]}},
            "scene: the set 'a' must name each cable once": {"sets": {"a": [1, 1]}},
            "scene: the net has no free nodes": {"role": "support"},
            "scene: 5 nodes and 0 cables do not form a net": {"end": END[:0]},
            "arrays:": {"form": {"pretention_N": 1}},
            "unknown key; did you mean 'pretension_N'": {"form": {"pretention_N": 1}},
            "a net from arrays needs a `scene` section that imports nodes and cables but no facets":
                {"set": {"scene.import.facets": "facets.csv"}},
        }.items():
            self.assertEqual(self.refused(hifdm.HifdmError, part, self.net, **arguments).status, "bad_case")

    def test_sets_and_texts(self):
        """Checks that nothing is rounded or cut on the way to C."""
        self.assertEqual(self.net(sets={"a": [2, 0], "b": []}).sets["a"].tolist(), [0, 2])
        for bad in ([0.9, 2.2], [True, False], [[0, 1]], 0):
            self.refused(TypeError, "sets['a'] has dtype", self.net, sets={"a": bad})
        self.refused(ValueError, "sets['a'] names a cable that there is not", self.net, sets={"a": [2**32]})
        small = temp("small.yaml", SMALL)
        for function, arguments in ((self.net, {"cable_ids": ["a\0b", "b", "c", "d"]}),
                                    (self.net, {"role": ["support\0", *ROLE[1:]]}),
                                    (hifdm.open, {"path": small + "\0"}),
                                    (hifdm.open, {"path": small, "set": ["form.stop=residual\0"]}),
                                    (hifdm.open(small).run, {"output": temp("nul.h5") + "\0"})):
            self.refused(ValueError, "has a NUL character", function, **arguments)

    def test_old_names_in_sections(self):
        adjust = {"set": "all", "range_m": 0.01, "step_m": 0.001, "moves": 3}
        for old, more in (("arrays:[0-9]+:[0-9]+: adjust.moves is now adjust.max_adjustments: ", {}),
                          ("--set adjust.aim=theory: adjust.aim=theory is now adjust.aim=target_positions: ",
                           {"set": {"adjust.aim": "theory"}})):
            with self.assertWarnsRegex(hifdm.HifdmWarning, old):
                self.net(adjust=adjust, **more)

    def test_a_relative_path_is_that_of_its_opening(self):
        temp("here.yaml", SMALL + "optimize: {population: 4, generations: 1}\n")
        before = os.getcwd()
        try:
            os.chdir(temp(""))
            case = hifdm.open("here.yaml")
            os.chdir("/")
            self.assertEqual(case.run(temp("here.h5")).status, "ok")
        finally:
            os.chdir(before)
        with hifdm.read(temp("here.h5")) as result:
            self.assertEqual(result.shape().status, "ok")
            self.assertEqual(result.shape().stop_reason, case.form().stop_reason)
            self.assertEqual(result.shape().bound_reason, case.form().bound_reason)

    def test_cases(self):
        path = temp("wrong.yaml", "scene: {}\nfrom: {}\n")
        error = self.refused(hifdm.HifdmError, f"{path}:2:1: from: unknown key; did you mean 'form'?", hifdm.open, path)
        self.assertEqual(error.status, "bad_case")
        self.refused(hifdm.HifdmError, "nowhere.yaml: cannot open", hifdm.open, "nowhere.yaml")
        small = temp("small.yaml", SMALL)
        self.refused(hifdm.HifdmError, "--set form.max_iterations", hifdm.open, small, {"form.max_iterations": -1})
        self.refused(TypeError, "expected a list of 'key=value', or a dict", hifdm.open, small, "form.stop=residual")
        few = hifdm.open(source("configs/chen2022.yaml"), {"form.max_iterations": 1, "form.method": "hifdm"})
        error = self.refused(hifdm.HifdmError, "did not converge in 1 iteration", few.form)
        self.assertEqual(error.status, "not_converged")
        self.refused(hifdm.HifdmError, "did not converge", lambda: few.initial)
        seeded = hifdm.open(source("configs/chen2022.yaml"), ["optimize.rule=seeded"])
        self.refused(hifdm.HifdmError, "no derivatives under optimize.rule seeded", seeded.jacobian, near(seeded, 1))

    def test_runs(self):
        case = hifdm.open(temp("run.yaml", SMALL + "optimize: {population: 6, generations: 50, stagnation_tolerance_m: "
                               "0, stagnation_generations: 50}\n"))
        self.assertEqual(self.refused(hifdm.HifdmError, "nowhere", case.run, "/nowhere/out.h5").status, "io")

        def fail(now):
            raise ValueError(f"in {now.phase}")

        self.refused(ValueError, "in form", case.run, progress=fail)
        for use in (lambda now: case.initial, lambda now: case.run()):  # would wait for itself
            error = self.refused(hifdm.HifdmError, "progress uses the case whose run calls it", case.run, progress=use)
            self.assertEqual(error.status, "bad_usage")
        stopped = case.run(temp("stopped.h5"), progress=lambda now: now.done < 3)
        self.assertEqual(stopped.status, "interrupted")
        rest = []
        whole = case.run(temp("stopped.h5"), progress=rest.append)
        self.assertEqual(whole.status, "ok")
        self.assertGreater(rest[1].done, 3)
        self.assertEqual(whole["search"]["psi_m"], case.run()["search"]["psi_m"])
        alone = case.run()
        self.refused(hifdm.HifdmError, "this run wrote no file", alone.read)
        self.assertIn("search", alone.keys())
        self.assertEqual(dict(alone), alone.figures)
        psi_mm = [alone[stage]["psi_m"] * 1e3 for stage in ("form", "search")]
        self.assertTrue(repr(alone).startswith("<hifdm.Run ok: form psi %.4g mm, search psi %.4g mm" % (*psi_mm,)))
        formed = hifdm.open(temp("form.yaml", SMALL)).run()
        self.refused(KeyError, "this run has no 'search'; it has form", lambda: formed["search"])
        self.refused(KeyError, "this run has no 'search'; it has form", lambda: formed["optimize"])
        self.assertIsNone(formed.get("search"))

    def test_interrupt(self):
        """Checks that Ctrl-C ends a run that would take hours."""
        script = ("import hifdm, os, signal, sys\n"
                  "long = {'optimize.generations': 100000, 'optimize.stagnation_generations': 100000}\n"
                  "case = hifdm.open(sys.argv[1], long)\n"
                  "try: case.run(progress=lambda now: now.done != 2 or os.kill(os.getpid(), signal.SIGINT))\n"
                  "except KeyboardInterrupt: print('interrupted')\n")
        out = subprocess.run([sys.executable, "-W", "ignore", "-c", script, source("configs/straight-edges.yaml")],
                             capture_output=True, text=True, timeout=200, check=False)
        self.assertEqual((out.stdout, out.stderr), ("interrupted\n", ""))

    def test_a_forked_process_is_refused(self):
        case = hifdm.open(temp("small.yaml", SMALL))
        case.form()
        child = os.fork()
        if child == 0:
            try:
                case.evaluate(near(case, 4))
            except hifdm.HifdmError as error:
                os._exit(7 if "use multiprocessing with 'spawn'" in str(error) else 8)
            finally:
                os._exit(9)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 7)


class Library(unittest.TestCase):
    def test_prototypes_are_those_of_the_header(self):
        with open(source("include/hifdm/flat.h"), encoding="utf-8") as file:
            text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
        ctype = {"int": "c_int", "void": None, "const char *": "c_char_p", "hf_flat *": "c_void_p",
                 "const hf_flat *": "c_void_p", "double": "c_double", "double *": "LP_c_double",
                 "const double *": "LP_c_double", "const int *": "LP_c_int", "int *": "LP_c_int", "long": "c_long",
                 "const unsigned char *": "LP_c_ubyte", "const char *const *": "LP_c_char_p", "void *": "c_void_p",
                 "hf_flat_observer *": _library.Observer.__name__}
        found = {}
        for result, name, arguments in re.findall(r"^([a-z][\w ]*?[ *]+)hf_flat_(\w+)\(([^)]*)\);", text, flags=re.M):
            if result.startswith("typedef"):
                continue
            parts = [part.strip() for part in arguments.split(",")]
            parts = [] if parts == ["void"] else [re.sub(r"\w+$", "", part).strip() for part in parts]
            found[name] = (ctype[result.strip()], [ctype[" ".join(part.split())] for part in parts])
        ours = {name: (result and result.__name__, [argument.__name__ for argument in arguments])
                for name, (result, arguments) in _library.PROTOTYPES.items()}
        self.assertEqual(ours, found)
        self.assertEqual(int(re.search(r"#define HF_FLAT_INTERFACE (\d+)", text)[1]), _library.INTERFACE)

    def test_threads_wait_quietly(self):
        """Checks the wait policy: OpenMP gets it while it is loaded, unless the user sets one; the environment stays
        unchanged."""
        script = "import hifdm, os; print(*(os.environ.get(n) for n in ('OMP_WAIT_POLICY', 'GOMP_SPINCOUNT')))"
        plain = {key: value for key, value in os.environ.items() if key not in ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT")}
        for given, left, policy, spins in (({}, "None None", "PASSIVE", "2000"),
                                           ({"GOMP_SPINCOUNT": "5"}, "None 5", "PASSIVE", "5"),
                                           ({"OMP_WAIT_POLICY": "active"}, "active None", "ACTIVE", None)):
            out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True,
                                 env={**plain, **given, "OMP_DISPLAY_ENV": "VERBOSE"})
            self.assertEqual(out.stdout, left + "\n")
            told = dict(re.findall(r"(\w+) = '(\w+)'", out.stderr))
            self.assertEqual(told["OMP_WAIT_POLICY"], policy)
            self.assertEqual(told["GOMP_SPINCOUNT"], spins or told["GOMP_SPINCOUNT"])
            self.assertEqual(told["GOMP_SPINCOUNT"] == "2000", spins == "2000")

    def test_another_library_is_refused(self):
        """Checks that a library which is not ours, and one with another interface, are refused."""
        other = temp("other.so")
        source_of = temp("other.c", "int hf_flat_interface(void) { return 999; }\n")
        subprocess.run(["cc", "-shared", "-fPIC", source_of, "-o", other], check=True)
        for library, words in ((other, f"has the interface 999, this package is for {_library.INTERFACE}"),
                               ("libm.so.6", "hf_flat_interface"), (temp("none.so"), "cannot open shared object file")):
            out = subprocess.run([sys.executable, "-c", "import hifdm"], capture_output=True, text=True, check=False,
                                 env={**os.environ, "HIFDM_LIBRARY": library})
            self.assertEqual(out.returncode, 1)
            self.assertIn(words, out.stderr)
            self.assertIn("ImportError", out.stderr)

    def test_a_broken_library_does_not_hide_another(self):
        folder = temp("broken/lib")
        shutil.copytree(os.path.dirname(_library.__file__), folder + "/python3/dist-packages/hifdm")
        os.makedirs(folder + "/some-linux-gnu")
        os.symlink(os.path.realpath(_library.lib._name), folder + "/some-linux-gnu/libhifdm.so.1")
        temp("broken/lib/libhifdm.so.1", "no library")
        plain = {key: value for key, value in os.environ.items() if key != "HIFDM_LIBRARY"}
        out = subprocess.run([sys.executable, "-c", "from hifdm import _library; print(_library.lib._name)"], text=True,
                             capture_output=True, check=False,
                             env={**plain, "PYTHONPATH": folder + "/python3/dist-packages"})
        self.assertIn("broken/lib/some-linux-gnu/libhifdm.so.1", out.stdout, out.stderr)


if __name__ == "__main__":
    main()
