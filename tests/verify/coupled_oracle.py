#!/usr/bin/env python3
"""Oracle for a tension net on its truss, independent of the program: dense numpy, another algorithm, its own frame.

    coupled_oracle.py CASE_FOLDER FOUND_FOLDER [TOLERANCE_m [SCALE]]

CASE_FOLDER has the imported tables: nodes.csv and cables.csv of the net (every cable with its law and value), and
truss_nodes.csv and members.csv of the truss. FOUND_FOLDER has the files of `hifdm export --csv`. E and G of the truss
are multiplied by SCALE. The script prints the deflection of the attachments and the largest distance of a node of the
net from its position in the program. The exit status is 0 if this distance is not above the tolerance (1e-7 m).

The method minimises the energy of net and truss together. The energy of the net is that of net_oracle.py, and that of
the truss is r' K r / 2. Its whole stiffness matrix K is assembled here from Euler-Bernoulli beams with 12 degrees of
freedom. There is no flexibility matrix and no condensation. Each support of the net is identical with the truss node
nearest to it."""
import csv
import sys

import figures
import numpy as np

from net_oracle import Net


def rows(path):
    with open(path) as f:
        return list(csv.DictReader(f))


def beam(p, q, E, G, A, Iy, Iz, J):
    """Returns the stiffness [12, 12] in global axes of a member clamped to its nodes p and q. Iy = Iz, so its roll is
    free."""
    assert Iy == Iz
    d = q - p
    L = np.linalg.norm(d)
    u = d / L
    v = np.cross(u, [0, 0, 1] if abs(u[2]) < 0.9 else [1, 0, 0])
    v /= np.linalg.norm(v)
    turn = np.kron(np.eye(4), np.array([u, v, np.cross(u, v)]))
    k = np.zeros((12, 12))
    for i, stiffness in ((0, E * A / L), (3, G * J / L)):
        k[np.ix_((i, i + 6), (i, i + 6))] += stiffness * np.array([[1, -1], [-1, 1]])
    bend = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) * E * Iz / L
    for dofs, sign in (((1, 5, 7, 11), 1), ((2, 4, 8, 10), -1)):
        scale = np.array([1 / L, sign, 1 / L, sign])
        k[np.ix_(dofs, dofs)] += bend * np.outer(scale, scale)
    return turn.T @ k @ turn


class Coupled(Net):
    def __init__(self, folder, scale):
        super().__init__(folder)
        nodes, members = rows(folder + "/truss_nodes.csv"), rows(folder + "/members.csv")
        x = np.array([[float(r[k]) for k in ("x_m", "y_m", "z_m")] for r in nodes])
        at = {r["id"]: i for i, r in enumerate(nodes)}
        K = np.zeros((6 * len(nodes), 6 * len(nodes)))
        for r in members:
            i, j = at[r["i"]], at[r["j"]]
            value = [float(r[k]) for k in ("E_Pa", "G_Pa", "A_m2", "Iy_m4", "Iz_m4", "J_m4")]
            dofs = np.r_[6 * i : 6 * i + 6, 6 * j : 6 * j + 6]
            K[np.ix_(dofs, dofs)] += beam(x[i], x[j], value[0] * scale, value[1] * scale, *value[2:])
        assert all(not r["fixed"] or r["fixed"] == "all" for r in nodes)
        moves = np.repeat([not r["fixed"] for r in nodes], 6)
        self.K = K[np.ix_(moves, moves)]
        number = np.where(moves, np.cumsum(moves) - 1, -1)
        # unknowns: free nodes of the net, then all of the truss; a support is at the displacement of its truss node
        n_net = 3 * self.free.sum()
        self.place = np.full((len(self.x), 3), -1)
        self.place[self.free] = np.arange(n_net).reshape(-1, 3)
        for i in np.flatnonzero(~self.free):
            near = np.linalg.norm(x - self.x[i], axis=1).argmin()
            assert np.linalg.norm(x[near] - self.x[i]) < 1e-6
            for c in range(3):
                k = number[6 * near + c]
                self.place[i, c] = n_net + k if k >= 0 else -1
        self.n_net, self.n = n_net, n_net + len(self.K)
        self.load[~self.free] = 0
        if self.reference < 1e-200:  # elastic cables alone
            self.reference = 10.0

    def shape(self, z):
        x = self.x.copy()
        ok = self.place >= 0
        x[self.free] = 0
        x[ok] += z[self.place[ok]]
        return x

    def gradient(self, z, mu, T0):
        """Returns the forces out of balance by unknown, and the stiffness matrix."""
        T, k, u, l = self.pull(self.shape(z), mu, T0)
        f, H = np.zeros(self.n + 1), np.zeros((self.n + 1, self.n + 1))  # the last takes what is held
        ends = self.place[self.end]
        for c in range(3):
            np.add.at(f, self.place[:, c], self.load[:, c])
            np.add.at(f, ends[:, 0, c], T * u[:, c])
            np.add.at(f, ends[:, 1, c], -T * u[:, c])
            for d in range(3):
                block = (T / l) * (c == d) + (k - T / l) * u[:, c] * u[:, d]
                for a in (0, 1):
                    for b in (0, 1):
                        np.add.at(H, (ends[:, a, c], ends[:, b, d]), block if a == b else -block)
        f, H = f[:-1], H[:-1, :-1]
        f[self.n_net :] -= self.K @ z[self.n_net :]
        H[self.n_net :, self.n_net :] += self.K
        return f, H, T

    def solve(self):
        z, T0 = np.zeros(self.n), np.full(len(self.value), self.reference)
        z[: self.n_net] = self.x[self.free].ravel()
        mu = 0.1 * self.reference * self.size
        for _ in range(60):
            for _ in range(200):
                f, H, T = self.gradient(z, mu, T0)
                scale = 1 / np.sqrt(H.diagonal())
                step = scale * np.linalg.solve(H * np.outer(scale, scale) + 1e-14 * np.eye(self.n), scale * f)
                net = np.abs(step[: self.n_net]).max()
                if np.abs(f[: self.n_net]).max() < 1e-10 * self.reference and net < 1e-10 * self.size or net < 1e-13:
                    break
                part, slope = min(1, 0.5 * self.size / net), f @ step
                while part > 1e-12 and abs(self.gradient(z + part * step, mu, T0)[0] @ step) > slope + 1e-18:
                    part /= 2  # the slope of the convex energy along the step has to fall
                z = z + part * step
            done = mu < 1e-15 * self.reference * self.size and np.abs(T - T0).max() < 1e-9 * self.reference
            T0 = T
            mu = max(mu / 100, 1e-16 * self.reference * self.size)
            if done:
                break
        return self.shape(z), T


def main(case, found, tolerance_m=1e-7, scale=1):
    net = Coupled(case, float(scale))
    x, T = net.solve()
    y = np.array([[float(r[k]) for k in ("x_m", "y_m", "z_m")] for r in rows(found + "/nodes.csv")])
    pull = np.array([float(r["tension_N"]) for r in rows(found + "/cables.csv")])
    gives_way = np.linalg.norm((x - net.x)[~net.free], axis=1).max()
    far = np.linalg.norm(x - y, axis=1).max()
    print(
        f"attachments give way by {1e3 * gives_way:.4f} mm; farthest node {far:.2e} m, tension "
        f"{np.abs(T - pull).max():.2e} N, {np.sum(T < 1e-6 * net.reference)} cables slack"
    )
    figures.worst(far, float(tolerance_m), f"attachments that give way by {1e3 * gives_way:.4f} mm: places, m")
    return 0 if far <= float(tolerance_m) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
