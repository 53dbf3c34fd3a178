"""Runs the program for the figures of Chen et al. 2022, with cases made from configs/, and reads the results from
HDF5."""
import os
import shutil
import subprocess
import time

import h5py
import numpy as np
import yaml

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NET = os.path.join(ROOT, "configs", "chen2022.yaml")
TRUSS = os.path.join(ROOT, "configs", "chen2022-truss.yaml")
SEARCH, SEARCH_TRUSS = (os.path.join(ROOT, "configs", f"chen2022-search{part}.yaml") for part in ("", "-truss"))
DENSE = os.path.join(ROOT, "configs", "chen2022-dense.yaml")
DENSE_CSV, DENSE_TRUSS_CSV = (os.path.join(ROOT, "results", "chen2022", f"dense{part}.csv") for part in ("", "-truss"))
USUAL_E_PA = 130e9  # CFRP; that of the case is calibrated


class Result:
    """One result file. The group of a stage has its shape: form, search, refine."""

    def __init__(self, path, setting):
        self.file, self.setting = h5py.File(path, "r"), setting
        node, cable = self.file["scene/node"], self.file["scene/cable"]
        self.target_m, self.end = node["position_m"][:], cable["end"][:]
        self.role, self.group = words(node["role"]), words(cable["group"])
        self.inner, self.boundary = self.group == "inner", self.group == "boundary"

    def __getitem__(self, name):
        return self.file[name][()]

    def words(self, name):
        return words(self.file[name])

    def get(self, group, attribute):
        value = self.file[group].attrs[attribute]
        return value.item() if hasattr(value, "item") else value


def words(data):
    """Returns an HDF5 enumeration as an array of words."""
    names = {value: word for word, value in h5py.check_enum_dtype(data.dtype).items()}
    return np.array([names[value] for value in data[:]])


class Runs:
    def __init__(self, program, work):
        self.program, self.work = os.path.abspath(program), os.path.abspath(work)
        self.env = dict(os.environ, OMP_WAIT_POLICY="passive")
        os.makedirs(self.work, exist_ok=True)

    def call(self, *arguments, allowed=(0,)):
        done = subprocess.run([self.program, *arguments], cwd=self.work, env=self.env, capture_output=True, text=True)
        if done.returncode not in allowed:
            raise SystemExit(f"hifdm {' '.join(arguments)}: exit status {done.returncode}\n{done.stderr}")
        return done.stdout

    def case(self, name, base, drop=(), **extra):
        """Writes a case file from a given one, without the sections of `drop` and with those of `extra`."""
        with open(base) as file:
            case = yaml.safe_load(file)
        case = {key: value for key, value in case.items() if key not in drop} | extra
        path = os.path.join(self.work, name + ".yaml")
        with open(path, "w") as file:
            yaml.safe_dump(case, file, sort_keys=False)
        return path

    def sweep(self, study, merged, allowed=(0,)):
        """Runs a whole study from the start and writes its table to `merged`. Failed points give exit status 3."""
        start, folder = time.monotonic(), os.path.splitext(os.path.basename(study))[0] + ".d"
        shutil.rmtree(os.path.join(self.work, folder), ignore_errors=True)
        self.call("sweep", study, "--quiet", allowed=allowed)
        self.call("merge", study, "-o", merged, "--force")
        print(f"  {folder[:-2]:18} sweep {time.monotonic() - start:18.1f} s", flush=True)

    def run(self, name, case, setting, **overrides):
        """Runs a case. setting: what distinguishes this run, for captions. Overrides: form__stop="residual" and the
        like."""
        path, start = os.path.join(self.work, name + ".h5"), time.monotonic()
        keys = [word for key, value in overrides.items() for word in ("--set", f"{key.replace('__', '.')}={value}")]
        self.call("run", case, *keys, "-o", path, "--force", "--quiet")
        result = Result(path, setting)
        psi_mm, wall_s = 1e3 * result.get("form", "psi_m"), time.monotonic() - start
        print(f"  {name:18} psi {psi_mm:8.4f} mm  {wall_s:5.1f} s  {setting}", flush=True)
        return result


STOP = "stopped when psi changes by < 0.001 mm"
EXACT = "at equilibrium (residual 1e-8 N)"


def net_runs(runs):
    """Runs everything on rigid supports: Figs. 2 to 14."""
    form = runs.case("form", NET, drop=["optimize"])
    return {"fdm": runs.run("fdm", form, "first step of the iterative FDM", form__method="fdm"),
            "hifdm": runs.run("hifdm", form, f"HIFDM, {EXACT}"),
            "stopped": runs.run("stopped", form, f"HIFDM, {STOP}", form__stop="rms_change"),
            "seeded": runs.run("seeded", NET, f"GA, each individual by HIFDM {STOP}", optimize__rule="seeded",
                               form__stop="rms_change"),
            "ga": runs.run("ga", NET, f"GA, each individual {EXACT}")}


class Sweep:
    """The rows of a merged study."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            points = file["points"]
            self.pretension_N, self.psi_m = points["input/form.pretension_N"][:], points["form/psi_m"][:]
            if not np.isfinite(self.psi_m).all():
                raise SystemExit(f"{path}: points failed; see `hifdm status`")


def truss_runs(runs):
    """Runs everything on the truss, whose flexibility is calibrated: Figs. 15 to 22."""
    with open(NET) as file:
        optimize = yaml.safe_load(file)["optimize"]
    loop = {"coupling__scheme": "plain", "coupling__tof_m": 1e-3}
    tight = {"coupling__tof_m": 1e-9}
    search = runs.case("truss_ga", TRUSS, optimize=optimize)
    study = runs.case("pretensions", TRUSS, sweep={"form.pretension_N": [5, 10, 15, 20, 25, 30, 35, 40]})
    out = {"truss": runs.run("truss", TRUSS, f"HIFDM {EXACT} on the truss, loop of Fig. 17 to 1 mm", **loop),
           "truss_stopped": runs.run("truss_stopped", TRUSS, f"HIFDM on the truss, {STOP}, loop of Fig. 17 to 1 mm",
                                     form__stop="rms_change", **loop),
           "truss_tight": runs.run("truss_tight", TRUSS, "HIFDM on the truss, displacements to 1e-9 m", **tight),
           "usual": runs.run("usual", TRUSS, "HIFDM on a truss that is not calibrated, E = 130 GPa", **tight,
                             truss__E_Pa=USUAL_E_PA),
           "truss_ga": runs.run("truss_ga", search, "GA on the truss, each individual at equilibrium", **tight)}
    path = os.path.join(runs.work, "pretensions.h5")
    runs.sweep(study, path)
    return out | {"sweep": Sweep(path)}
