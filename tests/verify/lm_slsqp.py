"""lm_slsqp.py HIFDM FOLDER SEED N: N random nets whose cap on the boundary tension ratio matters. The case has the cap
as such or as a row of optimize.limits. The result of `hifdm run` with Levenberg-Marquardt is the start of SLSQP of
scipy. Equilibria and derivatives are this script's own.

The script fails if the equilibrium differs, if a limit is broken, if SLSQP lowers psi by more than 1e-6 of it, or if
hifdm ended neither converged nor settled."""
import os
import subprocess
import sys

import figures
import h5py
import numpy as np
import scipy.optimize

GAIN_MOST = 1e-6  # of psi
ENDED = 0, 3  # converged, settled


class Net:
    """A square grid of cells on a sheet like a paraboloid, with loads on the inner nodes. The four corners are
    supports. Edge cables are the boundary. They are scalloped and have their target lengths before the design. The
    other cables have the tension pretension_N."""

    def __init__(self, random):
        n = int(random.integers(4, 6))
        self.pretension_N = 10.0
        at = np.arange(n)
        self.target_position = np.array([(x, y, 0.02 * ((x - n / 2) ** 2 + 0.5 * y**2)) for y in at for x in at], float)
        self.target_position[:, :2] += random.uniform(-0.08, 0.08, (n * n, 2))
        edge = {i for i in range(n * n) if i % n in (0, n - 1) or i // n in (0, n - 1)}
        corner = {0, n - 1, n * n - n, n * n - 1}
        self.role = ["support" if i in corner else "edge" if i in edge else "inner" for i in range(n * n)]
        pairs = [(i, i + 1) for i in range(n * n) if i % n < n - 1] + [(i, i + n) for i in range(n * n - n)]
        self.end = np.array(pairs)
        self.is_boundary = np.array([a in edge and b in edge for a, b in pairs])
        self.load = np.zeros_like(self.target_position)
        self.load[:, 2] = np.where([r == "inner" for r in self.role], random.uniform(-1.5, 0.5, n * n), 0)
        # Edges are scalloped, so that finite tensions on them carry the pull of the net.
        middle = self.target_position.mean(axis=0)
        for i in edge - corner:
            row, column = i // n, i % n
            part = (column if row in (0, n - 1) else row) / (n - 1)
            inwards = np.array([0, 1] if row in (0, n - 1) else [1, 0]) * np.sign(middle - self.target_position[i])[:2]
            self.target_position[i, :2] += 0.5 * (n - 1) * part * (1 - part) * inwards
        self.free = np.array([r != "support" for r in self.role])
        self.inner = np.array([r == "inner" for r in self.role])
        self.length = np.linalg.norm(np.diff(self.target_position[self.end], axis=1)[:, 0], axis=1)
        self.boundary = np.flatnonzero(self.is_boundary)
        self.moving = np.repeat(self.free, 3)  # components that give way
        self.K = np.zeros((3 * n * n, 3 * n * n))  # N/m, of what holds them

    def write(self, folder, settings):
        with open(os.path.join(folder, "nodes.csv"), "w", encoding="utf-8") as file:
            file.write("id,x_m,y_m,z_m,role,Fx_N,Fy_N,Fz_N\n")
            for i, (place, force) in enumerate(zip(self.target_position, self.load)):
                file.write(f"n{i},{','.join(map(repr, map(float, place)))},{self.role[i]},"
                           f"{','.join(map(repr, map(float, force)))}\n")
        with open(os.path.join(folder, "cables.csv"), "w", encoding="utf-8") as file:
            file.write("id,i,j,group,law,value\n")
            for e, (a, b) in enumerate(self.end):
                kind = "boundary,length," if self.is_boundary[e] else "inner,tension,"
                file.write(f"c{e},n{a},n{b},{kind}\n")
        with open(os.path.join(folder, "case.yaml"), "w", encoding="utf-8") as file:
            file.write("title: capped\nscene: {import: {nodes: nodes.csv, cables: cables.csv}}\n"
                       f"form: {{pretension_N: {self.pretension_N}, residual_tolerance: 1.0e-11}}\n"
                       f"optimize: {{method: lm, {settings}}}\n")

    def energy(self, density, x):
        l = np.linalg.norm(x[self.end[:, 1]] - x[self.end[:, 0]], axis=1)
        off, of_nets = (x - self.target_position).ravel(), self.pretension_N * l[~self.is_boundary].sum()
        return of_nets + density @ l[self.boundary] ** 2 / 2 - np.sum(self.load * x) + off @ self.K @ off / 2

    def solve(self, density, start):
        """Solves for the equilibrium by Newton's method, where boundary cable k has the force density density[k].
        Returns the shape, the boundary tensions, and the derivatives of both with respect to the force densities."""
        x, n, b = start.copy(), len(self.target_position), self.boundary
        dof = np.flatnonzero(self.moving)
        for _ in range(200):
            vector = x[self.end[:, 1]] - x[self.end[:, 0]]
            l = np.linalg.norm(vector, axis=1)
            u, T, along = vector / l[:, None], np.full(len(l), self.pretension_N), np.zeros(len(l))
            T[b], along[b] = density * l[b], density
            force, H = self.load.copy(), np.zeros((3 * n, 3 * n))
            np.add.at(force, self.end[:, 0], T[:, None] * u)
            np.add.at(force, self.end[:, 1], -T[:, None] * u)
            for e, (i, j) in enumerate(self.end):
                uu = np.outer(u[e], u[e])
                K = T[e] / l[e] * (np.eye(3) - uu) + along[e] * uu
                for row, column, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
                    H[3 * row:3 * row + 3, 3 * column:3 * column + 3] += sign * K
            right = (force.ravel() - self.K @ (x - self.target_position).ravel())[dof]
            H = (H + self.K)[np.ix_(dof, dof)]
            if np.abs(right).max() < 1e-10:
                break
            step = np.zeros(3 * n)
            step[dof] = np.linalg.solve(H, right)
            step, most = step.reshape(n, 3), np.abs(step).max()
            part = min(1, 0.5 / most)
            while part * most > 1e-6 and self.energy(density, x + part * step) > self.energy(density, x):
                part /= 2  # the energy is convex
            x = x + part * step
        else:
            raise ArithmeticError("no equilibrium")
        push = np.zeros((3 * n, len(b)))
        for k, e in enumerate(b):
            i, j = self.end[e]
            push[3 * i:3 * i + 3, k] += vector[e]
            push[3 * j:3 * j + 3, k] -= vector[e]
        move = np.zeros_like(push)
        move[dof] = np.linalg.solve(H, push[dof])
        move = move.reshape(n, 3, -1)
        spread = move[self.end[b, 1]] - move[self.end[b, 0]]
        rate = density[:, None] * np.einsum("ec,eck->ek", u[b], spread) + np.diag(l[b])
        return x, T[b], move, rate

    def psi(self, shape):
        return np.sqrt(np.mean(np.sum((shape - self.target_position)[self.inner] ** 2, axis=1)))


def remember(net, x):
    """Returns a function of v that gives the shape and its rates for force densities v[:-1]. It keeps those of its last
    call."""
    kept = {}

    def at(v):
        key = v[:-1].tobytes()
        if key not in kept:
            kept.clear()
            kept[key] = net.solve(v[:-1], x)
        return kept[key]

    return at


def minimise(at, value, density, bounds, limits, limit_rates, iterations):
    """Runs SLSQP over the force densities and the minimum tension, from `density`. `value` is 1e4 times a square, with
    its slope. Returns the root of that square, or infinity outside the limits."""
    found = scipy.optimize.minimize(
        value, np.append(density, at(np.append(density, 0))[1].min()), jac=True, method="SLSQP",
        bounds=[*bounds, (1e-6, None)], constraints={"type": "ineq", "fun": limits, "jac": limit_rates},
        options={"maxiter": iterations, "ftol": 1e-15})
    return np.sqrt(value(found.x)[0] / 1e4) if limits(found.x).min() > -1e-9 else np.inf


def improve(net, density, low, high, cap, is_density, x):
    """Minimises psi^2 subject to t <= T <= cap t with the minimum tension t. By rule there are also bounds on the
    tensions, or on force density times target length. Returns psi, or infinity outside the limits."""
    at, length = remember(net, x), net.length[net.boundary]

    def psi2(v):
        shape, _, move, _ = at(v)
        f = (shape - net.target_position)[net.inner]
        slope = 2e4 * np.einsum("ic,ick->k", f, move[net.inner]) / len(f)
        return 1e4 * np.mean(np.sum(f**2, axis=1)), np.append(slope, 0)

    def limits(v):
        _, T, _, _ = at(v)
        bounds = [] if is_density else [T - low, high - T]
        return np.concatenate([T - v[-1], cap * v[-1] - T, *bounds])

    def limit_rates(v):
        rate = at(v)[3]
        ones, none = np.ones((len(rate), 1)), np.zeros((len(rate), 1))
        bounds = [] if is_density else [np.hstack([rate, none]), np.hstack([-rate, none])]
        return np.vstack([np.hstack([rate, -ones]), np.hstack([-rate, cap * ones]), *bounds])

    bounds = zip(low / length, high / length) if is_density else zip(0.1 * density, 10 * density)
    return minimise(at, psi2, density, bounds, limits, limit_rates, 300)


def predict(net, density, low, high, cap, is_density, x):
    """Returns the part of psi by which the linear model of the shape at x lowers it, within the limits to first
    order."""
    shape, T, move, rate = net.solve(density, x)
    f, J = (shape - net.target_position)[net.inner].ravel(), move[net.inner].reshape(-1, len(density))
    scale, unit = np.linalg.norm(f), density
    f, J, rate, n = f / scale, J * unit / scale, rate * unit, len(density)
    ones, none = np.ones((n, 1)), np.zeros((n, 1))
    rows = [np.hstack([rate, -ones]), np.hstack([-rate, cap * ones])]
    left = [T, -T]
    if is_density:
        length = net.length[net.boundary] * unit
        rows += [np.hstack([np.diag(length), none]), np.hstack([-np.diag(length), none])]
        left += [density * net.length[net.boundary] - low, high - density * net.length[net.boundary]]
    else:
        rows += [np.hstack([rate, none]), np.hstack([-rate, none])]
        left += [T - low, high - T]
    A, b = np.vstack(rows), np.concatenate(left)
    found = scipy.optimize.minimize(
        lambda v: (100 * np.sum((f + J @ v[:-1])**2), np.append(200 * J.T @ (f + J @ v[:-1]), 0)),
        np.append(np.zeros(n), T.min()), jac=True, method="SLSQP",
        constraints={"type": "ineq", "fun": lambda v: A @ v + b, "jac": lambda v: A},
        options={"maxiter": 1000, "ftol": 1e-14})
    return 1 - np.linalg.norm(f + J @ found.x[:-1])


def compare(program, folder, random):
    net = Net(random)
    is_density, reach, cap = bool(random.integers(2)), float(random.uniform(3, 15)), float(random.uniform(1.1, 1.8))
    # The same problem in two ways: by rule, range and cap, or by rows of variables and limits.
    rule = "force_density" if is_density else "tension"
    by_rows = not is_density and cap < 1.5
    net.write(folder, f"variables: [{{set: boundary, vary: tension, range: {reach}, bounds: [0.1, null]}}], "
              f"limits: [{{figure: ratio, set: boundary, bounds: [1, {cap}]}}]" if by_rows
              else f"rule: {rule}, range_N: {reach}, boundary_ratio_cap: {cap}")
    result = os.path.join(folder, "r.h5")
    argv = [program, "run", os.path.join(folder, "case.yaml"), "-o", result, "--restart", "--quiet"]
    n_step = int(random.integers(1, 4))
    if subprocess.run([*argv, "--set", f"optimize.refine_steps={n_step}"], capture_output=True, check=False).returncode:
        return None  # not every random net starts below its cap: the caller draws another
    with h5py.File(result) as file:
        short = dict(file["refine"].attrs)
        begun = file["refine/q_N_per_m"][()][net.boundary], file["refine/position_m"][()]
    subprocess.run(argv, capture_output=True, check=True)
    with h5py.File(result) as file:
        design, refined = file["refine/design"][()], dict(file["refine"].attrs)
        density, position = file["refine/q_N_per_m"][()][net.boundary], file["refine/position_m"][()]
        base, first = file["form/q_N_per_m"][()][net.boundary], file["form/tension_N"][()][net.boundary]
    shape, T, _, _ = net.solve(density, position)
    psi, own = float(refined["psi_m"]), net.psi(shape)
    low, high = np.maximum(first - reach, 0.1), first + reach
    predicted, own_prediction = float(short["predicted_gain"]), predict(net, begun[0], low, high, cap, is_density,
                                                                        begun[1])
    gain = (psi - improve(net, density, low, high, cap, is_density, shape)) / psi
    from_base = improve(net, base, low, high, cap, is_density, net.target_position) / psi - 1
    start = net.psi(net.solve(base, net.target_position)[0])
    given = "rows of" if by_rows else "rule"
    print(f"{len(T)} pretensions, {given} {rule}, cap {cap:.4f}: psi {1e3 * start:.6f} -> {1e3 * psi:.6f} mm in "
          f"{refined['steps']} steps, ratio {T.max() / T.min():.6f}; SLSQP gains {gain:.1e} "
          f"from there, ends {from_base:+.1e} from the same start; "
          f"after {n_step} steps the model predicts {predicted:.6e} less, recomputed {own_prediction:.6e}")
    net_is = f"{len(T)} pretensions, {given} {rule}"
    figures.worst(abs(own - psi) / psi, 1e-9, f"{net_is}: psi of the optimum, in parts of it")
    figures.worst(max(gain, 0), GAIN_MOST, f"{net_is}: what SLSQP gains there, in parts of psi")
    is_predicted = short["algorithm_stop"] != 2 or abs(predicted - own_prediction) < 1e-6
    figures.worst(abs(predicted - own_prediction), 1e-6, f"{net_is}: gain that the model predicts, in parts of psi")
    wrong = [what for what, is_wrong in [
        ("another prediction", not is_predicted),
        ("psi differs", abs(own - psi) > 1e-9 * psi), ("not converged", refined["algorithm_stop"] not in ENDED),
        ("above the cap", T.max() / T.min() > cap * (1 + 1e-9)), ("SLSQP gains", gain > GAIN_MOST),
        ("out of bounds", (design < low - 1e-9).any() or (design > high + 1e-9).any())] if is_wrong]
    if wrong:
        print("WRONG:", ", ".join(wrong))
    return bool(wrong), T.max() / T.min() > cap * (1 - 1e-6), abs(from_base) < 1e-6


def main(program, folder, seed, n):
    random, outcomes = np.random.default_rng(int(seed)), []
    for _ in range(20 * int(n)):
        outcome = compare(program, folder, random)
        outcomes += [outcome] if outcome else []
        if len(outcomes) == int(n):
            break
    n_wrong, n_capped, n_same = np.sum(outcomes, axis=0) if outcomes else (0, 0, 0)
    print(f"seed {seed}: {len(outcomes)} nets, {n_wrong} wrong, {n_capped} at their cap, SLSQP finds {n_same} of them")
    return 0 if len(outcomes) == int(n) and n_wrong == 0 and n_capped > 0 and n_same > 0 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
