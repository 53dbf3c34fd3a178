"""An independent `hifdm adjust`: scipy's least squares on dense matrices, with sensitivities from differences of solved
nets.

    adjust_oracle.py measure CUT.csv JIG.csv SHAPE MEASURED.csv SEED    a net with random errors, measured with noise
    adjust_oracle.py check CUT.csv JIG.csv SHAPE MEASURED.csv ANSWER.json

CUT.csv and JIG.csv are those of `hifdm export --cutlist`, SHAPE is the folder of `--csv`, and ANSWER.json the output of
`hifdm adjust --json`. Cables are elastic and never push. The errors of cut lengths have the dense covariance of the
constants below, which are those of the case. Sets of cables are spools. A cable of several sets is of the spool that
comes first by name. The script prints the largest differences of estimated errors and of predicted figures, and exits
with 1 if they are too large."""
import csv
import json
import sys

import figures
import numpy as np

SIGMA_CUT = 1e-4
SIGMA_RATIO = 3e-4  # of cut lengths
SIGMA_EA = 0.05
BATCH = 0.7  # correlation of both within a spool
SIGMA_TEMPERATURE_K = 20
EXPANSION_PER_K = {"inner": 1e-5, "boundary": 2e-5}
SIGMA_PLACE = 1e-4


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class Net:
    def __init__(self, cut, jig, shape):
        nodes, cables = rows(jig), rows(cut)
        self.id = [n["id"] for n in nodes]
        index = {name: i for i, name in enumerate(self.id)}
        self.place = np.array([[float(n[c]) for c in ("x_m", "y_m", "z_m")] for n in nodes])
        self.free = np.array([i for i, n in enumerate(nodes) if n["role"] != "support"])
        self.inner = np.array([n["role"] == "inner" for n in nodes])
        self.cable = [c["id"] for c in cables]
        self.end = np.array([[index[c["i"]], index[c["j"]]] for c in cables])
        self.cut = np.array([float(c["unstressed_length_m"]) for c in cables])
        self.EA = np.array([float(c["EA_N"]) for c in cables])
        strained = self.cut * np.array([float(c["tension_N"]) for c in cables]) / self.EA
        spool = [sorted(c["set"].split())[0] for c in rows(f"{shape}/cables.csv")]
        alike = np.array([[BATCH if a == b else 0 for a in spool] for b in spool]) + (1 - BATCH) * np.eye(len(spool))
        expansion = self.cut * np.array([EXPANSION_PER_K[c["group"]] for c in cables])
        self.covariance = (SIGMA_CUT**2 * np.eye(len(spool)) + SIGMA_RATIO**2 * alike * np.outer(self.cut, self.cut)
                           + SIGMA_EA**2 * alike * np.outer(strained, strained)
                           + SIGMA_TEMPERATURE_K**2 * np.outer(expansion, expansion))

    def forces(self, place, cut):
        """Returns the forces out of balance at all nodes, and the stiffness of the free ones."""
        d = place[self.end[:, 1]] - place[self.end[:, 0]]
        length = np.linalg.norm(d, axis=1)
        unit = d / length[:, None]
        tension = np.maximum(self.EA * (length / cut - 1), 0)
        along = np.where(tension > 0, self.EA / cut, 0)
        force = np.zeros_like(place)
        np.add.at(force, self.end[:, 0], tension[:, None] * unit)
        np.add.at(force, self.end[:, 1], -tension[:, None] * unit)
        stiffness = np.zeros((3 * len(place), 3 * len(place)))
        for e, (a, b) in enumerate(self.end):
            across = tension[e] / length[e]
            block = across * np.eye(3) + (along[e] - across) * np.outer(unit[e], unit[e])
            for p, q, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                stiffness[3 * p:3 * p + 3, 3 * q:3 * q + 3] += sign * block
        dof = (3 * self.free[:, None] + np.arange(3)).ravel()
        return force.ravel()[dof], stiffness[np.ix_(dof, dof)], tension

    def solve(self, cut, start):
        """Solves for equilibrium by Newton's method with halved steps."""
        place = start.copy()
        for _ in range(100):
            force, stiffness, tension = self.forces(place, cut)
            size = np.linalg.norm(force)
            if size < 1e-9:
                break
            step = np.linalg.solve(stiffness + 1e-12 * np.trace(stiffness) / len(force) * np.eye(len(force)), force)
            for _ in range(20):
                trial = place.copy()
                trial[self.free] += step.reshape(-1, 3)
                if np.linalg.norm(self.forces(trial, cut)[0]) < size:
                    break
                step /= 2
            else:
                break  # rounding
            place = trial
        return place, tension


def measure(cut, jig, shape, measured, seed):
    net, random = Net(cut, jig, shape), np.random.default_rng(int(seed))
    truth = net.cut + np.linalg.cholesky(net.covariance) @ random.standard_normal(len(net.cut))
    place, _ = net.solve(truth, net.place)
    with open(measured, "w") as file:
        file.write("id,x_m,y_m,z_m,sigma_m\n")
        for i in net.free:
            if random.random() < 0.8:
                at = place[i] + SIGMA_PLACE * random.standard_normal(3)
                file.write(f"{net.id[i]},{at[0]:.17g},{at[1]:.17g},{at[2]:.17g},{SIGMA_PLACE:g}\n")


def estimate(net, which, target):
    """Returns the most probable errors by the Gauss-Newton method with halved steps."""
    last, whiten = [net.place], np.linalg.inv(np.linalg.cholesky(net.covariance))

    def shape(e):
        last[0] = net.solve(net.cut + e, last[0])[0]
        return last[0]

    def misfit(e):
        left = shape(e)[which].ravel() - target
        return ((whiten @ e) @ (whiten @ e) + left @ left / SIGMA_PLACE**2) / 2

    e = np.zeros(len(net.cut))
    for _ in range(30):
        place = shape(e)
        h = 1e-7
        effect = np.array([(net.solve(net.cut + e + h * unit, place)[0][which].ravel()
                            - net.solve(net.cut + e - h * unit, place)[0][which].ravel()) / (2 * h)
                           for unit in np.eye(len(e))]).T
        gap = target - place[which].ravel() + effect @ e
        matrix = np.vstack((effect / SIGMA_PLACE, whiten))
        solution = np.linalg.lstsq(matrix, np.concatenate((gap / SIGMA_PLACE, np.zeros(len(e)))), rcond=None)[0]
        step = solution - e
        before = misfit(e)
        while misfit(e + step) > before and np.abs(step).max() > 1e-12:
            step /= 2
        e = e + step
        if np.abs(step).max() < 1e-9:
            break
    return e, shape


def check(cut, jig, folder, measured, answer):
    net, target_position = Net(cut, jig, folder), {n["id"]: n for n in rows(f"{folder}/nodes.csv")}
    said = json.load(open(answer))
    aimed = "{}_m" if said["aim"] == "design" else "{}0_m"
    aim = np.array([[float(target_position[i][aimed.format(c)]) for c in "xyz"] for i in net.id])
    index = {name: i for i, name in enumerate(net.id)}
    table = rows(measured)
    which = np.array([index[r["id"]] for r in table])
    target = np.array([[float(r[c]) for c in ("x_m", "y_m", "z_m")] for r in table]).ravel()
    e, shape = estimate(net, which, target)
    told = np.array([said["errors_m"][c] for c in net.cable])
    worst_error = np.abs(told - e).max()

    def psi(errors):
        d = shape(errors)[net.inner] - aim[net.inner]
        return np.sqrt((d * d).sum(axis=1).mean())

    worst_figure, turned = abs(psi(told) - said["estimated_m"]), told.copy()
    for move in said["adjustments"]:
        turned[net.cable.index(move["cable"])] += move["turnbuckle_m"]
        place, tension = net.solve(net.cut + turned, net.place)
        worst_figure = max(worst_figure, abs(psi(turned) - move["predicted_m"]))
        after = tension[net.cable.index(move["cable"])]
        worst_figure = max(worst_figure, 1e-6 * abs(after - move["tension_after_N"]))
    print(f"{len(said['adjustments'])} adjustments; errors differ by {worst_error:.2e} m of {np.abs(e).max():.2e}, "
          f"figures by {worst_figure:.2e} m")
    figures.worst(worst_error, 1e-8, "estimated errors of cut lengths, m")
    figures.worst(worst_figure, 1e-9, f"psi after each of {len(said['adjustments'])} adjustments, aim {said['aim']}, m")
    return 0 if len(said["adjustments"]) and worst_error < 1e-8 and worst_figure < 1e-9 else 1


if __name__ == "__main__":
    sys.exit({"measure": measure, "check": check}[sys.argv[1]](*sys.argv[2:]))
