"""Draws the errors of a result's samples again and solves each as-built net by numpy alone: psi, minimum tension and
slack cables must be those of the result. Usage: tolerance_oracle.py RESULT.h5

METHOD section 12 describes the stream of an error: SplitMix64 scattered by (seed, sample, kind, item). The net has the
minimum energy of its cables, sum EA/(2 l0) max(l - l0, 0)^2, less the work of its loads.
Newton's method with a shrinking ridge and a line search finds it."""
import sys

import figures
import h5py
import numpy as np
import yaml
from scipy.special import ndtri

STEP, MASK = 0x9E3779B97F4A7C15, 2**64 - 1
CUT, RATIO, RATIO_BATCH, EA_OWN, EA_BATCH, SUPPORT = range(6)


def mix(z):
    z = ((z ^ z >> 30) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ z >> 27) * 0x94D049BB133111EB) & MASK
    return z ^ z >> 31


def number(seed, sample, kind, item):
    place = sample << 32 | kind << 27 | item
    state = mix(mix((seed + STEP) & MASK) ^ mix((place + 2 * STEP) & MASK))
    return ndtri(((mix((state + STEP) & MASK) >> 12) + 0.5) * 2.0**-52)


def energy(x, end, cut, ea):
    length = np.linalg.norm(x[end[:, 1]] - x[end[:, 0]], axis=1)
    return np.sum(ea / (2 * cut) * np.maximum(length - cut, 0) ** 2)


def slope_and_matrix(x, end, cut, ea):
    d = x[end[:, 1]] - x[end[:, 0]]
    length = np.linalg.norm(d, axis=1)
    u = d / length[:, None]
    tension = ea * np.maximum(length / cut - 1, 0)
    slope = np.zeros_like(x)
    np.add.at(slope, end[:, 1], tension[:, None] * u)
    np.add.at(slope, end[:, 0], -tension[:, None] * u)
    along = np.where(length > cut, ea / cut, 0)
    matrix = np.zeros((len(x), 3, len(x), 3))
    for e, (a, b) in enumerate(end):
        block = (along[e] - tension[e] / length[e]) * np.outer(u[e], u[e]) + tension[e] / length[e] * np.eye(3)
        matrix[a, :, a] += block
        matrix[b, :, b] += block
        matrix[a, :, b] -= block
        matrix[b, :, a] -= block
    return slope, matrix.reshape(3 * len(x), 3 * len(x)), tension


def solve(x, free, end, cut, ea, load=0):
    dof = (3 * np.flatnonzero(free)[:, None] + np.arange(3)).ravel()
    for _ in range(200):
        slope, matrix, tension = slope_and_matrix(x, end, cut, ea)
        g = (slope - load).ravel()[dof]
        if np.abs(g).max() < 1e-10 * tension.max():
            return x, tension
        ridge = 1e-9 * ea.max() + np.abs(g).max()  # vanishes at the end, up to what loose nodes need
        step = np.zeros(x.size)
        step[dof] = np.linalg.solve(matrix[np.ix_(dof, dof)] + ridge * 1e-3 * np.eye(len(dof)), -g)
        step, size, now = step.reshape(x.shape), 1.0, energy(x, end, cut, ea) - np.sum(load * x)
        gain = g @ step.ravel()[dof]
        while (-gain > 1e-12 * abs(now) and energy(x + size * step, end, cut, ea) - np.sum(load * (x + size * step))
               > now + 1e-4 * size * gain):
            size /= 2  # less than that is rounding
        x = x + size * step
    raise SystemExit("the oracle does not converge")


def main(path):
    with h5py.File(path) as f:
        overrides = dict(line.split("=") for line in f["case/overrides"][()].decode().split() if "=" in line)
        case = yaml.safe_load(f["case/text"][()].decode())["tolerance"]
        case.update({key.split(".")[1]: value for key, value in overrides.items() if key.startswith("tol")})
        case = {key: float(value) for key, value in case.items() if key in
                ("sigma_cut_m", "sigma_cut_ratio", "sigma_EA_ratio", "sigma_support_m", "batch", "samples")}
        scene, found = f["scene"], f["form"]
        target, role = scene["node/position_m"][:], scene["node/role"][:]
        end, ea, group = scene["cable/end"][:], scene["cable/EA_N"][:], scene["cable/group"][:]
        place, length, tension = found["position_m"][:], found["length_m"][:], found["tension_N"][:]
        start, member = scene["set/start"][:], scene["set/cable"][:]
        sample = {name: values[:] for name, values in f["tolerance/sample"].items()}
    free, inner, n_set, seed = role != 0, role == 1, len(start) - 1, 1
    spool = n_set + group.astype(int)
    for k in reversed(range(n_set)):
        spool[member[start[k]:start[k + 1]]] = k
    cut, own, shared = length / (1 + tension / ea), np.sqrt(1 - case["batch"]), np.sqrt(case["batch"])
    worst, n_slack, n_psi = 0.0, 0, 0
    for i in range(int(case["samples"])):
        def draw(kind, items):
            return np.array([number(seed, i, kind, int(k)) for k in items])
        spools = range(n_set + 2)
        cables = range(len(end))
        ratio = case["sigma_cut_ratio"] * (own * draw(RATIO, cables) + shared * draw(RATIO_BATCH, spools)[spool])
        stiff = case["sigma_EA_ratio"] * (own * draw(EA_OWN, cables) + shared * draw(EA_BATCH, spools)[spool])
        x = place.copy()
        for k in np.flatnonzero(~free):
            x[k] += case["sigma_support_m"] * draw(SUPPORT, 3 * k + np.arange(3))
        x, t = solve(x, free, end, cut * (1 + ratio) + case["sigma_cut_m"] * draw(CUT, cables), ea * (1 + stiff))
        psi = np.sqrt(np.mean(np.sum((x - target)[inner] ** 2, axis=1)))
        assert sample["status"][i] == 0, f"sample {i}"
        if sample["n_loose"][i] == 0:  # the places of loose nodes are free
            worst, n_psi = max(worst, abs(psi - sample["psi_m"][i])), n_psi + 1
        assert abs(t.min() - sample["tension_min_N"][i]) < 1e-5 * t.max(), f"sample {i}: least tension {t.min()}"
        slack = int(np.sum(t < 1e-3 * tension.max()))
        n_slack += slack
        assert slack == sample["n_slack"][i], f"sample {i}: {slack} slack cables, not {sample['n_slack'][i]}"
    print(f"{int(case['samples'])} samples, {n_slack} slack cables: psi differs by at most {worst:.2g} m")
    figures.worst(worst, 1e-9, f"psi of {n_psi} samples with {n_slack} slack cables in all, m")
    assert worst < 1e-9 and n_slack > 0 and n_psi > 40


if __name__ == "__main__":
    main(sys.argv[1])
