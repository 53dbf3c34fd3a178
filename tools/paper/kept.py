"""Puts a net on its truss with the force densities that it has on rigid supports: every cable keeps q while the truss
deflects. This is the second reading of the paper's section 4.2; the first one is form-finding on the truss."""
import csv
import json
import math
import os

import yaml

from runs import TRUSS

MEMBER = ["id", "i", "j", "A_m2", "G_Pa", "Iy_m4", "Iz_m4", "J_m4", "roll_rad", "joint", "unit"]
NEAR = 5e-4


def table(path, names, rows):
    with open(path, "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(names)
        out.writerows([row[name] for name in names] for row in rows)


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def export(runs, case, point, name, *more):
    """Runs a case at a point and exports its tables to WORK/NAME."""
    result, folder = os.path.join(runs.work, name + ".h5"), os.path.join(runs.work, name)
    keys = [word for key, value in point.items() for word in ("--set", f"{key}={value}")]
    runs.call("run", case, *keys, *more, "-o", result, "--force", "--quiet")
    runs.call("export", result, "--csv", folder, "--force")
    return folder


class Kept:
    """A net whose cables keep their force densities, on a truss whose Young's modulus can be set."""

    def __init__(self, runs, net, truss, name="kept"):
        """net: folder with the exported tables of the net on rigid supports; truss: the same of a net on its truss."""
        self.runs, self.folder = runs, os.path.join(runs.work, name)
        os.makedirs(self.folder, exist_ok=True)
        at = {"x_m": "x0_m", "y_m": "y0_m", "z_m": "z0_m"}
        nodes = [row | {key: row[target] for key, target in at.items()} for row in read(f"{net}/nodes.csv")]
        cables = [row | {"law": "force_density", "value": row["q_N_per_m"]} for row in read(f"{net}/cables.csv")]
        table(f"{self.folder}/nodes.csv", ["id", "x_m", "y_m", "z_m", "role"], nodes)
        table(f"{self.folder}/cables.csv", ["id", "i", "j", "group", "law", "value", "set"], cables)
        table(f"{self.folder}/truss_nodes.csv", ["id", "x_m", "y_m", "z_m", "fixed"], read(f"{truss}/truss_nodes.csv"))
        self.members = read(f"{truss}/members.csv")
        self.case = os.path.join(self.folder, "kept.yaml")
        with open(self.case, "w") as file:
            yaml.safe_dump({"title": "force densities kept on the truss",
                            "scene": {"import": {"nodes": "nodes.csv", "cables": "cables.csv"}},
                            "form": {"pretension_N": 10}, "coupling": {"scheme": "plain", "tof_m": 1e-3},
                            "truss": {"import": {"nodes": "truss_nodes.csv", "members": "members.csv"},
                                      "match_tolerance_m": 0.5}}, file, sort_keys=False)

    def run(self, E_Pa):
        """Returns the figures with this Young's modulus, or None if net and truss have no equilibrium."""
        table(f"{self.folder}/members.csv", [*MEMBER, "E_Pa"], [row | {"E_Pa": f"{E_Pa:.6g}"} for row in self.members])
        out = self.runs.call("run", self.case, "-o", os.path.join(self.folder, "kept.h5"), "--force", "--json",
                             allowed=(0, 3, 4))
        found = json.loads(out)
        if found["status"] != "ok":
            return None
        form, coupling = found["form"], found["coupling"]
        return {"E_Pa": float(f"{E_Pa:.6g}"), "psi_m": form["psi_m"], "inner": form["inner_tension_ratio"],
                "boundary": form["boundary_tension_ratio"], "loops": coupling["iterations"] - 1,
                "deflection_m": coupling["deflection_max_m"]}

    def soften(self, psi_m):
        """Returns the figures with the Young's modulus for which psi is psi_m, by bisection, or None."""
        low, high, found = math.log(1e8), math.log(1e13), None
        for _ in range(60):
            E = math.exp((low + high) / 2)
            found = self.run(E)
            if found and abs(found["psi_m"] / psi_m - 1) < NEAR:
                return found
            if found and found["psi_m"] < psi_m:
                high = math.log(E)
            else:
                low = math.log(E)
            if high - low < 1e-5:
                return None
        return None


def on_truss(runs, net, point, psi_m, truss=()):
    """Returns the figures of a net with its force densities on its truss, with the Young's modulus for which psi is
    psi_m. None if there is none. net: folder of its tables; truss: keys of section `truss` and their values."""
    keys = [word for key, value in truss for word in ("--set", f"truss.{key}={value}")]
    stiff = {"truss.E_Pa": "1e12", "truss.match_tolerance_m": "0.5"}
    case = runs.case("kept-truss", TRUSS, form={"method": "hifdm", "pretension_N": 10, "stop": "rms_change"})
    return Kept(runs, net, export(runs, case, point | stiff, "kept-truss", *keys)).soften(psi_m)
