"""The runs of the program behind the figures of Chen et al. 2022: cases made from configs/, results read from HDF5."""
import csv
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
SOFTER = 100


class Result:
    """One result file; the shape of any stage by its group: form, ga/best, polish."""

    def __init__(self, path, setting):
        self.file, self.setting = h5py.File(path, "r"), setting
        node, cable = self.file["scene/node"], self.file["scene/cable"]
        self.theory_m, self.end = node["position_m"][:], cable["end"][:]
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
    """An HDF5 enumeration as an array of words."""
    names = {value: word for word, value in h5py.check_enum_dtype(data.dtype).items()}
    return np.array([names[value] for value in data[:]])


class Runs:
    def __init__(self, program, work):
        self.program, self.work = os.path.abspath(program), os.path.abspath(work)
        self.env = dict(os.environ, OMP_WAIT_POLICY="passive")
        os.makedirs(self.work, exist_ok=True)

    def call(self, *arguments):
        done = subprocess.run([self.program, *arguments], cwd=self.work, env=self.env, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"hifdm {' '.join(arguments)}: exit status {done.returncode}\n{done.stderr}")
        return done.stdout

    def case(self, name, base, drop=(), **extra):
        """A case file from a shipped one: without the sections of `drop`, with those of `extra`."""
        with open(base) as file:
            case = yaml.safe_load(file)
        case = {key: value for key, value in case.items() if key not in drop} | extra
        path = os.path.join(self.work, name + ".yaml")
        with open(path, "w") as file:
            yaml.safe_dump(case, file, sort_keys=False)
        return path

    def run(self, name, case, setting, **overrides):
        """setting: what distinguishes this run, for captions. Overrides: form__stop="residual" and the like."""
        path, start = os.path.join(self.work, name + ".h5"), time.monotonic()
        keys = [word for key, value in overrides.items() for word in ("--set", f"{key.replace('__', '.')}={value}")]
        self.call("run", case, *keys, "-o", path, "--force", "--quiet")
        result = Result(path, setting)
        psi_mm, wall_s = 1e3 * result.get("form", "psi_m"), time.monotonic() - start
        print(f"  {name:18} psi {psi_mm:8.4f} mm  {wall_s:5.1f} s  {setting}", flush=True)
        return result


def straight_middles(result):
    """Free nodes in the middle of a straight chain of two boundary cables: Eq. 8 has one place for them, where theory
    has them, and no finite tension that holds them there."""
    end, at, found = result.end[result.boundary], result.theory_m, []
    for node in np.flatnonzero(result.role == "edge"):
        other = [sum(pair) - node for pair in end if node in pair]
        lengths = sum(np.linalg.norm(at[k] - at[node]) for k in other)
        if len(other) == 2 and lengths - np.linalg.norm(at[other[0]] - at[other[1]]) < 1e-9:
            found.append(node)
    return found


def limit_case(runs, result):
    """The net that Eq. 8 tends to: the same, with the middles of straight chains held where theory has them."""
    role = result.role.copy()
    role[straight_middles(result)] = "support"
    with open(os.path.join(runs.work, "limit_nodes.csv"), "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["id", "x_m", "y_m", "z_m", "role"])
        rows.writerows([k, *map(repr, at.tolist()), role[k]] for k, at in enumerate(result.theory_m))
    with open(os.path.join(runs.work, "limit_cables.csv"), "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["id", "i", "j", "group", "law", "value"])
        rows.writerows([k, i, j, result.group[k], "tension" if result.inner[k] else "length", ""]
                       for k, (i, j) in enumerate(result.end) if "support" not in role[i] or "support" not in role[j])
    return runs.case("limit", NET, drop=["optimize", "title", "form"], form={"pretension_N": 10},
                     scene={"import": {"nodes": "limit_nodes.csv", "cables": "limit_cables.csv"}})


def net_runs(runs):
    """Everything on rigid supports: Figs. 2 to 14."""
    form = runs.case("form", NET, drop=["optimize"])
    paper, exact = "stopped when psi changes by < 0.001 mm", "until equilibrium (residual 1e-8 N)"
    out = {"fdm": runs.run("fdm", form, f"iterative FDM, {paper}", form__method="iterative_fdm"),
           "fdm_exact": runs.run("fdm_exact", form, f"iterative FDM, {exact}", form__method="iterative_fdm",
                                 form__stop="residual"),
           "hifdm": runs.run("hifdm", form, f"HIFDM, {paper}")}
    out["limit"] = runs.run("limit", limit_case(runs, out["hifdm"]), "HIFDM, limit of Eq. 8, by Newton")
    out["seeded"] = runs.run("seeded", NET, f"GA, each individual by HIFDM {paper}", optimize__rule="seeded")
    out["ga"] = runs.run("ga", NET, f"GA, each individual {exact}")
    return out


class Sweep:
    """The rows of a merged study."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            points = file["points"]
            self.pretension_N, self.E_Pa = (points[f"input/{key}"][:] for key in ("form.pretension_N", "truss.E_Pa"))
            self.psi_m = points["form/psi_m"][:]
            if not np.isfinite(self.psi_m).all():
                raise SystemExit(f"{path}: points failed; see `hifdm status`")

    def at(self, E_Pa):
        """psi by pretension, for one stiffness of the truss."""
        return {T: psi for T, E, psi in zip(self.pretension_N, self.E_Pa, self.psi_m) if E == E_Pa}


def truss_runs(runs):
    """On the truss: Figs. 15 to 22. SOFTER is an illustration, no fit."""
    with open(NET) as file:
        optimize = yaml.safe_load(file)["optimize"]
    loop = {"coupling__scheme": "plain", "coupling__tof_m": 1e-3}
    tight = {"coupling__tof_m": 1e-9}
    search = runs.case("truss_ga", TRUSS, optimize=optimize)
    with open(TRUSS) as file:
        young_Pa = float(yaml.safe_load(file)["truss"]["E_Pa"])
    paper = "HIFDM on the truss, both stopped as in the paper (0.001 mm; 1 mm)"
    out = {"truss": runs.run("truss", TRUSS, paper, **loop),
           "truss_tight": runs.run("truss_tight", TRUSS, "HIFDM on the truss, displacements to 1e-9 m", **tight),
           "soft": runs.run("soft", TRUSS, f"{paper}, truss {SOFTER} times softer", **loop,
                            truss__E_Pa=young_Pa / SOFTER)}
    out["truss_ga"] = runs.run("truss_ga", search, "GA on the truss, each individual at equilibrium", **tight)
    out["truss_seeded"] = runs.run("truss_seeded", search, "GA on the truss, each individual stopped as in the paper",
                                   optimize__rule="seeded", **loop)
    study = runs.case("pretensions", TRUSS, sweep={  # the plain loop diverges for the softer truss from 35 N on
        "form.pretension_N": [5, 10, 15, 20, 25, 30, 35, 40], "truss.E_Pa": [young_Pa, young_Pa / SOFTER]})
    start, path = time.monotonic(), os.path.join(runs.work, "pretensions.h5")
    shutil.rmtree(os.path.join(runs.work, "pretensions.d"), ignore_errors=True)
    runs.call("sweep", study, "--quiet")
    runs.call("merge", study, "-o", path)
    print(f"  {'sweep':18} 16 points {time.monotonic() - start:14.1f} s  HIFDM on the truss, 5 to 40 N")
    return out | {"sweep": Sweep(path)}
