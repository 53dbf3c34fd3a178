"""objectives_slsqp.py HIFDM FOLDER SEED N: N random nets, or more until a limit holds one, with objectives beside psi.
The second objective is the tension of a set under a limit on its ratio, or the deflection of a truss with tensions
between bounds. The result of `hifdm run` with Levenberg-Marquardt is the start of SLSQP of scipy. Equilibria, truss
and derivatives are this script's own.

The script fails if merit or objectives differ, if a limit is broken, if SLSQP lowers the merit by more than 1e-6 of
it, or if hifdm ended neither converged nor settled."""
import os
import subprocess
import sys

import figures
import h5py
import numpy as np

from coupled_oracle import beam
from lm_slsqp import ENDED, GAIN_MOST, Net, minimise, remember

E_PA, G_PA, A_M2, I_M4, J_M4 = 70e9, 26e9, 2e-7, 1.2e-8, 2.4e-8
MAST_M = 1.5


class OnMasts(Net):
    """The same net, but each corner stands on a mast that is clamped to the ground, and beams join the tops."""

    def __init__(self, random):
        super().__init__(random)
        self.corner = np.flatnonzero(~self.free)
        self.top = self.target_position[self.corner]
        self.pair = [(0, 1), (1, 3), (3, 2), (2, 0)]
        k = np.zeros((24, 24))
        for i, top in enumerate(self.top):
            foot = top - [0, 0, MAST_M]
            k[6 * i:6 * i + 6, 6 * i:6 * i + 6] += beam(foot, top, E_PA, G_PA, A_M2, I_M4, I_M4, J_M4)[6:, 6:]
        for i, j in self.pair:
            at = np.r_[6 * i:6 * i + 6, 6 * j:6 * j + 6]
            k[np.ix_(at, at)] += beam(self.top[i], self.top[j], E_PA, G_PA, A_M2, I_M4, I_M4, J_M4)
        slides = np.arange(24) % 6 < 3
        turns = ~slides
        k = k[np.ix_(slides, slides)] - k[np.ix_(slides, turns)] @ np.linalg.solve(
            k[np.ix_(turns, turns)], k[np.ix_(turns, slides)])
        at = (3 * self.corner[:, None] + np.arange(3)).ravel()
        self.K[np.ix_(at, at)] = k
        self.moving[:] = True

    def write(self, folder, settings):
        super().write(folder, settings)
        with open(os.path.join(folder, "truss_nodes.csv"), "w", encoding="utf-8") as file:
            file.write("id,x_m,y_m,z_m,fixed\n")
            for i, top in enumerate(self.top):
                for name, place, fixed in ((f"t{i}", top, ""), (f"g{i}", top - [0, 0, MAST_M], "all")):
                    file.write(f"{name},{','.join(map(repr, map(float, place)))},{fixed}\n")
        with open(os.path.join(folder, "members.csv"), "w", encoding="utf-8") as file:
            file.write("id,i,j,E_Pa,G_Pa,A_m2,Iy_m4,Iz_m4,J_m4\n")
            for a, b in [(f"g{i}", f"t{i}") for i in range(4)] + [(f"t{i}", f"t{j}") for i, j in self.pair]:
                file.write(f"{a}{b},{a},{b},{E_PA},{G_PA},{A_M2},{I_M4},{I_M4},{J_M4}\n")
        with open(os.path.join(folder, "case.yaml"), "a", encoding="utf-8") as file:
            file.write("truss: {import: {nodes: truss_nodes.csv, members: members.csv}}\ncoupling: {tof_m: 1.0e-12}\n")


class Wanted:
    """The objectives: weight x psi, and weight x (RMS difference of the boundary tensions from the target, or the
    smooth maximum deflection). The limits: ratio of the boundary tensions, or all of them between bounds."""

    def __init__(self, net, weight, target, cap, bounds):
        self.net, self.weight, self.target, self.cap, self.bounds = net, weight, target, cap, bounds

    def goals(self, solved):
        """Returns both objectives and their derivatives with respect to the force densities."""
        net, (x, T, move, rate) = self.net, solved
        off = (x - net.target_position)[net.inner]
        psi = np.sqrt(np.mean(np.sum(off**2, axis=1)))
        psi_rate = np.einsum("ic,ick->k", off, move[net.inner]) / len(off) / psi
        if self.target is not None:
            value = np.sqrt(np.mean((T - self.target) ** 2))
            return psi, value, psi_rate, (T - self.target) @ rate / len(T) / value
        d = (x - net.target_position)[net.corner]
        size = np.linalg.norm(d, axis=1)
        size_rate = np.einsum("ic,ick->ik", d, move[net.corner]) / size[:, None]
        value = np.sum(size**16) ** (1 / 16)
        return psi, value, psi_rate, (size / value) ** 15 @ size_rate

    def merit2(self, solved):
        psi, value, psi_rate, rate = self.goals(solved)
        return psi**2 + (self.weight * value) ** 2, 2 * psi * psi_rate + 2 * self.weight**2 * value * rate

    def limits(self, solved, least):
        T = solved[1]
        if self.cap:
            return np.concatenate([T - least, self.cap * least - T])
        return np.concatenate([T - self.bounds[0], self.bounds[1] - T])

    def limit_rates(self, solved):
        rate = solved[3]
        ones, none = np.ones((len(rate), 1)), np.zeros((len(rate), 1))
        if self.cap:
            return np.vstack([np.hstack([rate, -ones]), np.hstack([-rate, self.cap * ones])])
        return np.vstack([np.hstack([rate, none]), np.hstack([-rate, none])])


def improve(wanted, density, low, high, x):
    """Returns the merit within the limits, or infinity outside them."""
    at = remember(wanted.net, x)

    def value(v):
        merit2, slope = wanted.merit2(at(v))
        return 1e4 * merit2, np.append(1e4 * slope, 0)

    return minimise(at, value, density, zip(low, high), lambda v: wanted.limits(at(v), v[-1]),
                    lambda v: wanted.limit_rates(at(v)), 400)


def compare(program, folder, random, on_truss):
    net = OnMasts(random) if on_truss else Net(random)
    part = float(random.uniform(0.3, 0.6))
    weight = float(10 ** random.uniform(1, 2)) if on_truss else float(10 ** random.uniform(-4, -2.5))
    target = None if on_truss else float(random.uniform(10, 25))
    cap = 0 if on_truss else float(random.uniform(1.1, 1.6))
    bounds = (float(random.uniform(14, 20)), float(random.uniform(40, 55))) if on_truss else None
    goal = "{figure: deflection" if on_truss else f"{{figure: tension, set: boundary, target: {target}"
    limit = (f"{{figure: tension, set: boundary, bounds: [{bounds[0]}, {bounds[1]}]}}" if on_truss
             else f"{{figure: ratio, set: boundary, bounds: [1, {cap}]}}")
    net.write(folder, f"variables: [{{set: boundary, vary: force_density, range: {100 * part} %}}], "
              f"objective: [{{figure: psi}}, {goal}, weight: {weight}}}], limits: [{limit}]")
    result = os.path.join(folder, "r.h5")
    run = subprocess.run([program, "run", os.path.join(folder, "case.yaml"), "-o", result, "--restart", "--quiet"],
                         capture_output=True, text=True, check=False)
    if run.returncode != 0:
        print(run.stderr.strip())
        return None  # not every random net has a way into its limits: the caller draws another
    with h5py.File(result) as file:
        design, refined, stored = file["refine/design"][()], dict(file["refine"].attrs), file["objective/refine"][()]
        base, shape = file["form/q_N_per_m"][()][net.boundary], file["refine/position_m"][()]
    wanted = Wanted(net, weight, target, cap, bounds)
    solved = net.solve(design, shape)
    psi, value, _, _ = wanted.goals(solved)
    merit, own = float(refined["merit"]), np.sqrt(wanted.merit2(solved)[0])
    largest = np.linalg.norm((solved[0] - net.target_position)[net.corner], axis=1).max() if on_truss else value
    low, high = base * (1 - part), base * (1 + part)
    slack = wanted.limits(solved, solved[1].min())
    start = np.sqrt(wanted.merit2(net.solve(base, net.target_position))[0])
    try:
        gain = (merit - improve(wanted, design, low, high, solved[0])) / merit
    except ArithmeticError:
        return None  # SLSQP tries a design in which nodes run together, and says nothing of this one
    try:
        from_base = improve(wanted, base, low, high, net.target_position) / merit - 1
    except ArithmeticError:
        from_base = np.inf
    n_held = (slack < 1e-6).sum() - bool(cap)  # the least tension of a ratio is at itself
    name = "displacement" if on_truss else "tension"
    print(f"{len(design)} force densities, {name}: merit {start:.6e} -> {merit:.6e} (psi {1e3 * psi:.4f} mm, "
          f"{largest:.4e}) in {refined['steps']} steps, {n_held} tensions held; "
          f"SLSQP gains {gain:.1e} from there, ends {from_base:+.1e} from the same start")
    what = f"{len(design)} force densities, psi and {name}"
    figures.worst(abs(own - merit) / merit, 1e-9, f"{what}: merit of the optimum, in parts of it")
    figures.worst(max(gain, 0), GAIN_MOST, f"{what}: what SLSQP gains there, in parts of the merit")
    wrong = [what for what, is_wrong in [
        ("merit differs", abs(own - merit) > 1e-9 * merit),
        ("goals differ", np.abs(stored / [psi, largest] - 1).max() > 1e-8),
        ("not converged", refined["algorithm_stop"] not in ENDED),
        ("beyond a limit", slack.min() < -1e-7), ("SLSQP gains", gain > GAIN_MOST),
        ("out of bounds", (design < low - 1e-9).any() or (design > high + 1e-9).any())] if is_wrong]
    if wrong:
        print("WRONG:", ", ".join(wrong))
    return bool(wrong), n_held > 0, abs(from_base) < 1e-6


def main(program, folder, seed, n):
    random, n = np.random.default_rng(int(seed)), int(n)
    for on_truss in (False, True):
        outcomes = []
        for _ in range(20 * n):
            outcome = compare(program, folder, random, on_truss)
            outcomes += [outcome] if outcome else []
            if len(outcomes) >= n and all(np.any(outcomes, axis=0)[1:]):
                break
        n_wrong, n_held, n_same = np.sum(outcomes, axis=0) if outcomes else (0, 0, 0)
        print(f"seed {seed}, {'displacement' if on_truss else 'tension'}: {len(outcomes)} nets, {n_wrong} wrong, "
              f"{n_held} at their limits, SLSQP finds {n_same} of them")
        if len(outcomes) < n or n_wrong or not n_held or not n_same:
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
