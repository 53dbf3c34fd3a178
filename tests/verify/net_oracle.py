#!/usr/bin/env python3
"""Oracle for the shape of a tension net, independent of the program: dense numpy, another algorithm.

    net_oracle.py CASE_FOLDER FOUND_FOLDER [TOLERANCE_m [LOOSE]]

CASE_FOLDER has nodes.csv and cables.csv as imported (every cable with its law and value), and FOUND_FOLDER those of
`hifdm export --csv`. The script prints the largest distance of a node and the largest difference of a tension. The exit
status is 0 if no node is farther off than the tolerance (1e-7 m) and LOOSE nodes (none) are loose.

The method minimises the energy of the net by damped Newton steps. Every law is replaced by a smooth one, and the
smoothing is removed step by step. A cable with a multiplier pulls with the positive root T of the equation

    l + mu / T = L + c T     (law length: c (T - T0) with T0 the last tension and a small c, an augmented Lagrangian)

A slack cable therefore has a small tension instead of none. Free nodes without load are loose if all their cables are
slack. SLSQP of scipy puts them as near to their target positions, by the sum of squares, as possible without a cable
that is too long."""
import csv
import sys

import figures
import numpy as np
from scipy.optimize import minimize


def read(folder):
    with open(folder + "/nodes.csv") as f:
        nodes = list(csv.DictReader(f))
    with open(folder + "/cables.csv") as f:
        cables = list(csv.DictReader(f))
    return nodes, cables


class Net:
    def __init__(self, folder):
        nodes, cables = read(folder)
        at = {r["id"]: i for i, r in enumerate(nodes)}
        number = lambda r, k: float(r.get(k) or 0)
        self.x = np.array([[float(r[k]) for k in ("x_m", "y_m", "z_m")] for r in nodes])
        self.load = np.array([[number(r, k) for k in ("Fx_N", "Fy_N", "Fz_N")] for r in nodes])
        self.free = np.array([r["role"] != "support" for r in nodes])
        self.end = np.array([[at[r["i"]], at[r["j"]]] for r in cables])
        self.law = np.array([r["law"] for r in cables])
        self.value = np.array([float(r["value"]) for r in cables])
        self.flex = np.array([float(r["value"]) / float(r["EA_N"]) if r["law"] == "elastic" else 0 for r in cables])
        self.reference = max([1e-300] + [float(r["value"]) for r in cables if r["law"] == "tension"])
        self.size = np.mean(np.linalg.norm(self.x[self.end[:, 1]] - self.x[self.end[:, 0]], axis=1))

    def pull(self, x, mu, T0):
        """Returns the tension of each cable, its derivative by the length, unit vectors and lengths."""
        d = x[self.end[:, 1]] - x[self.end[:, 0]]
        l = np.sqrt((d * d).sum(1) + 1e-24 * self.size**2)
        T, k = np.array(self.value), np.zeros(len(l))
        spring = self.law == "force_density"
        T[spring] *= l[spring]
        k[spring] = self.value[spring]
        m = (self.law == "length") | (self.law == "elastic")
        soft = 1e-4 * self.size / self.reference
        c = np.where(self.law == "length", soft, self.flex)[m]
        over = l[m] - self.value[m] + np.where(self.law == "length", soft * T0, 0)[m]
        root = np.sqrt(over**2 + 4 * c * mu)
        T[m] = np.where(over > 0, (over + root) / (2 * c), 2 * mu / np.maximum(root - over, 1e-300))
        k[m] = T[m] / np.maximum(root, 1e-300)
        return T, k, d / l[:, None], l

    def force(self, T, u):
        f = np.array(self.load)
        np.add.at(f, self.end[:, 0], T[:, None] * u)
        np.add.at(f, self.end[:, 1], -T[:, None] * u)
        return f[self.free].ravel()

    def stiffness(self, T, k, u, l):
        n = len(self.x)
        H = np.zeros((n, n, 3, 3))
        block = (T / l)[:, None, None] * np.eye(3) + (k - T / l)[:, None, None] * u[:, :, None] * u[:, None, :]
        i, j = self.end.T
        for row, column, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
            np.add.at(H, (row, column), sign * block)
        size = 3 * self.free.sum()
        return H[self.free][:, self.free].transpose(0, 2, 1, 3).reshape(size, size)

    def solve(self):
        x, T0 = np.array(self.x), np.full(len(self.value), self.reference)
        mu = 0.1 * self.reference * self.size
        for _ in range(60):
            for _ in range(200):
                T, k, u, l = self.pull(x, mu, T0)
                f = self.force(T, u)
                H = self.stiffness(T, k, u, l)
                H[np.diag_indices_from(H)] += 1e-13 * H.diagonal().max()
                step = np.linalg.solve(H, f)
                if np.abs(f).max() < 1e-11 * self.reference or np.abs(step).max() < 1e-13 * self.size:
                    break
                part, slope = min(1, 0.5 * self.size / np.abs(step).max()), f @ step
                while part > 1e-12:
                    y = np.array(x)
                    y[self.free] += part * step.reshape(-1, 3)
                    T1, _, u1, _ = self.pull(y, mu, T0)
                    if abs(self.force(T1, u1) @ step) <= (1 - 1e-3 * part) * slope + 1e-18:
                        break  # the slope of the convex energy along the step has fallen
                    part /= 2
                x = y
            done = mu < 1e-15 * self.reference * self.size and np.abs(T - T0).max() < 1e-9 * self.reference
            T0 = T
            mu = max(mu / 100, 1e-16 * self.reference * self.size)
            if done:
                break
        return x, T


    def loose(self, T):
        """Returns which nodes no taut cable holds."""
        taut = np.zeros(len(self.x), bool)
        taut[self.end[T > 1e-6 * self.reference]] = True
        return self.free & ~taut & (self.load == 0).all(axis=1)

    def place(self, x, loose):
        """Returns x with the loose nodes at their positions."""
        cables = loose[self.end].any(axis=1)

        def moved(z):
            y = np.array(x)
            y[loose] = z.reshape(-1, 3)
            return y

        def room(z):
            d = np.diff(moved(z)[self.end[cables]], axis=1)[:, 0]
            return self.value[cables] ** 2 - (d * d).sum(1)

        wanted = self.x[loose].ravel()
        best = minimize(lambda z: ((z - wanted) ** 2).sum(), x[loose].ravel(), jac=lambda z: 2 * (z - wanted),
                        constraints={"type": "ineq", "fun": room}, method="SLSQP",
                        options={"ftol": 1e-15, "maxiter": 500})
        assert best.success or best.status == 8, best.message  # 8: rounding is all that is left
        return moved(best.x)


def main(case, found, tolerance_m=1e-7, n_loose=0):
    net = Net(case)
    x, T = net.solve()
    loose = net.loose(T)
    if loose.any():
        x = net.place(x, loose)
    nodes, cables = read(found)
    y = np.array([[float(r[k]) for k in ("x_m", "y_m", "z_m")] for r in nodes])
    pull = np.array([float(r["tension_N"]) for r in cables])
    far = np.linalg.norm(x - y, axis=1).max()
    print(f"farthest node {far:.2e} m, tension {np.abs(T - pull).max():.2e} N, {loose.sum()} nodes loose")
    figures.worst(far, float(tolerance_m), f"{'/'.join(case.split('/')[-2:])}: places of {len(x)} nodes, m")
    return 0 if far <= float(tolerance_m) and loose.sum() == int(n_loose) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
