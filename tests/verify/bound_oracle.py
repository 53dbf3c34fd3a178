#!/usr/bin/env python3
"""Oracle for certified error bounds, independent of the program: dense Newton steps on the conditions of Karush, Kuhn
and Tucker. The true errors are computed with fifty decimal digits.

    bound_oracle.py DUMP [LEAST_SHARE_PROVEN] [LARGEST_MEDIAN]

tests/bounds.h writes DUMP: doubles, net after net, each with the shapes at its stops. The unknowns are the positions of
the free nodes and the tensions T of taut cables whose law has a multiplier. These cables obey l = L* (law length) or l
= l0 + l0 T / EA (elastic). A slack cable is shorter and has no tension. The energy is convex, so a shape with these
properties is an equilibrium, however it was found. On a truss the positions of the attachments are unknowns, too. They
obey r = F b for the pull b of the net. F is positive semidefinite, so the energy is still convex.

The script prints which bounds are certified, why others are not, and how far the bounds are from the true errors. It
exits with status 1 if a bound is below the error, if the certified share is below LEAST_SHARE_PROVEN, or if the median
of bound over error is above LARGEST_MEDIAN. The median is over shapes with a condition below 1e10 and an error above
the rounding of the coordinates."""
import sys
from collections import Counter
from decimal import Decimal, getcontext

import numpy as np

getcontext().prec = 50
TENSION, LENGTH, FORCE_DENSITY, ELASTIC = range(4)
REASON = ["none", "certified", "struts", "truss", "no_matrix", "not_definite", "not_contracting", "slack_or_taut",
          "dependent_lengths", "loose"]
STOPS = 16


class Net:
    def __init__(self, take):
        self.kind, self.n_node, self.n_free, n_cable, self.reference, n_inner, n_truss = take(7)
        self.n_node, self.n_free, n_cable = int(self.n_node), int(self.n_free), int(n_cable)
        self.n_moving = self.n_free + int(n_truss)
        self.flexibility = take(int(9 * n_truss * n_truss)).reshape(int(3 * n_truss), int(3 * n_truss))
        self.exact_flexibility = [[Decimal(v) for v in row] for row in self.flexibility.tolist()]
        self.target_position = take(3 * self.n_node).reshape(3, -1).T
        self.load = take(3 * self.n_node).reshape(3, -1).T
        self.inner = take(int(n_inner)).astype(int)
        cable = take(5 * n_cable).reshape(-1, 5)
        self.stops = []
        for _ in range(STOPS):
            figures = take(8)
            x = take(3 * self.n_node).reshape(3, -1).T
            self.stops.append((figures, x, take(n_cable)))
        keep = (cable[:, :2] < self.n_moving).any(axis=1)
        self.kept = keep
        self.end, self.law = cable[keep, :2].astype(int), cable[keep, 2].astype(int)
        self.target, self.EA = cable[keep, 3], cable[keep, 4]
        self.rest = np.linalg.norm(self.target_position[self.end[:, 1]] - self.target_position[self.end[:, 0]], axis=1)
        self.multiplier = (self.law == LENGTH) | (self.law == ELASTIC)
        self.flex = np.where(self.law == ELASTIC, self.target / np.where(self.law == ELASTIC, self.EA, 1), 0)

    def errors(self, x, T, taut):
        """Returns, in floating point: forces out of balance at free nodes, F b - r of attachments, and l - L(T) of
        cables with a multiplier."""
        d = x[self.end[:, 1]] - x[self.end[:, 0]]
        l = np.linalg.norm(d, axis=1)
        pull = np.where(self.law == TENSION, self.target, np.where(self.law == FORCE_DENSITY, self.target * l, T))
        pull = np.where(self.multiplier & ~taut, 0, pull)
        force = self.load.copy()
        u = d / l[:, None]
        np.add.at(force, self.end[:, 0], pull[:, None] * u)
        np.add.at(force, self.end[:, 1], -pull[:, None] * u)
        gap = self.flexibility @ force[self.n_free:self.n_moving].ravel() - (x - self.target_position)[
            self.n_free:self.n_moving].ravel()
        return np.vstack((force[:self.n_free], gap.reshape(-1, 3))), l - self.target - self.flex * T, u, l, pull

    def exact_errors(self, x, T, taut):
        """Returns the same as `errors` with fifty digits, and lengths over the target lengths. x, T: lists of
        Decimal."""
        force = [[Decimal(v) for v in row] for row in self.load.tolist()]
        over = [Decimal(0)] * len(T)
        for e, (a, b) in enumerate(self.end.tolist()):
            d = [x[b][c] - x[a][c] for c in range(3)]
            l = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
            target = Decimal(float(self.target[e]))
            if self.law[e] == TENSION:
                q = target / l
            elif self.law[e] == FORCE_DENSITY:
                q = target
            else:
                q = T[e] / l if taut[e] else Decimal(0)
                over[e] = l - target
                if self.law[e] == ELASTIC:
                    over[e] -= target * T[e] / Decimal(float(self.EA[e]))
            for c in range(3):
                force[a][c] += q * d[c]
                force[b][c] -= q * d[c]
        b = [v for row in force[self.n_free:self.n_moving] for v in row]
        for i in range(self.n_free, self.n_moving):
            for c in range(3):
                r = x[i][c] - Decimal(float(self.target_position[i, c]))
                row = self.exact_flexibility[3 * (i - self.n_free) + c]
                force[i][c] = sum((f * v for f, v in zip(row, b)), -r)
        return force[:self.n_moving], over

    def step(self, x, T, taut, force, over):
        """Returns the Newton step of positions and multipliers for these errors, by a dense matrix."""
        _, _, u, l, pull = self.errors(x, T, taut)
        n, active = 3 * self.n_moving, np.flatnonzero(self.multiplier & taut)
        J = np.zeros((n + len(active), n + len(active)))
        for e in range(len(self.law)):
            K = pull[e] / l[e] * (np.eye(3) - np.outer(u[e], u[e]))
            if self.law[e] == FORCE_DENSITY:
                K = self.target[e] * np.eye(3)
            a, b = self.end[e]
            for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                if i < self.n_moving and j < self.n_moving:
                    J[3 * i:3 * i + 3, 3 * j:3 * j + 3] += sign * K
        for k, e in enumerate(active):
            for i, sign in zip(self.end[e], (-1, 1)):
                if i < self.n_moving:
                    J[3 * i:3 * i + 3, n + k] += sign * u[e]
                    J[n + k, 3 * i:3 * i + 3] += sign * u[e]
            J[n + k, n + k] = -self.flex[e]
        truss = slice(3 * self.n_free, n)  # dr + F (change of -b) = F b - r
        J[truss] = self.flexibility @ J[truss]
        J[truss, truss] += np.eye(n - 3 * self.n_free)
        d = np.linalg.solve(J, np.concatenate([force.ravel(), -over[active]]))
        move, change = np.zeros((self.n_node, 3)), np.zeros(len(self.law))
        move[:self.n_moving] = d[:n].reshape(-1, 3)
        change[active] = d[n:]
        return move, change

    def told(self, T, over):
        return T / self.reference + over / self.rest > 0

    def solve_from(self, x, T):
        """Returns the equilibrium as lists of Decimal, or None. The first steps are in floating point, and each decides
        again which cables are taut. The last steps have fifty digits."""
        x, T = x.copy(), np.where(self.multiplier, T, 0.0)
        T = np.maximum(np.where(np.isfinite(T), T, 0), 0)
        taut = np.ones(len(T), bool)
        _, over, _, _, _ = self.errors(x, T, taut)
        taut = ~self.multiplier | self.told(T, over)
        for _ in range(25):
            T = np.where(self.multiplier & ~taut, 0, T)
            force, over, _, _, _ = self.errors(x, T, taut)
            size = max(abs(force).max() / self.reference, max([abs(over[e]) for e in range(len(T))
                                                              if self.multiplier[e] and taut[e]], default=0))
            if not np.isfinite(size):
                return None
            if size < 1e-12:
                break
            move, change = self.step(x, T, taut, force, over)
            x, T = x + move, T + change
            _, over, _, _, _ = self.errors(x, T, taut)
            taut = ~self.multiplier | self.told(T, over)
        X = [[Decimal(v) for v in row] for row in x.tolist()]
        S = [Decimal(v) for v in np.where(self.multiplier & taut, T, 0.0).tolist()]
        before = None
        for _ in range(40):
            force, over = self.exact_errors(X, S, taut)
            f = np.array([[float(v) for v in row] for row in force])
            o = np.where(self.multiplier & taut, [float(v) for v in over], 0)
            size = max(abs(f).max() / self.reference, abs(o).max())
            if size < 1e-38:
                break
            if before is not None and not size < before:
                return None
            before = size
            x = np.array([[float(v) for v in row] for row in X])
            move, change = self.step(x, np.array([float(v) for v in S]), taut, f, o)
            X = [[v + Decimal(float(w)) for v, w in zip(*rows)] for rows in zip(X, move)]
            S = [v + Decimal(float(w)) for v, w in zip(S, change)]
        else:
            return None
        for e in range(len(S)):
            if self.multiplier[e] and (S[e] < 0 if taut[e] else over[e] > 0):
                return None
        return X

    def truth(self):
        order = sorted(range(STOPS), key=lambda k: (self.stops[k][0][1] != 1, self.stops[k][0][7]
                                                    if np.isfinite(self.stops[k][0][7]) else np.inf))
        for k in order[:4]:
            figures, x, T = self.stops[k]
            if not np.isfinite(x).all():
                continue
            try:
                found = self.solve_from(x, T[self.kept])
            except np.linalg.LinAlgError:
                found = None
            if found:
                return found
        return None

    def psi(self, X):
        square = sum((X[i][c] - Decimal(float(self.target_position[i, c]))) ** 2
                     for i in self.inner.tolist() for c in range(3))
        return (square / len(self.inner)).sqrt()

    def error(self, X, x):
        """Returns the largest distance of a free node or an attachment from the shape x to the equilibrium X."""
        square = max(sum((X[i][c] - Decimal(v)) ** 2 for c, v in enumerate(row))
                     for i, row in enumerate(x[:self.n_moving].tolist()))
        return square.sqrt()


def main():
    data = np.fromfile(sys.argv[1])
    least, largest = (float(v) for v in (sys.argv[2:4] + ["0", "inf"])[:2])
    at = 0

    def take(n):
        nonlocal at
        at += n
        return data[at - n:at]

    low, unknown, n_net = 0, 0, 0
    converged = Counter()
    reasons, per_kind, ratios, psi_ratios, estimate_low, compared = Counter(), {}, [], [], 0, 0
    while at < len(data):
        net = Net(take)
        X = net.truth()
        n_net += 1
        for k, (figures, x, T) in enumerate(net.stops):
            status, reason, condition, bound, psi_bound, psi, estimate, _ = figures
            if status not in (0, 1) and reason == 0:
                reasons["no shape"] += 1
                continue
            reasons[REASON[int(reason)]] += 1
            converged[REASON[int(reason)]] += status == 0
            kind = per_kind.setdefault(int(net.kind), Counter())
            kind[REASON[int(reason)]] += 1
            if X is None:
                unknown += reason == 1
                continue
            error = net.error(X, x)
            if np.isfinite(estimate):
                compared += 1
                estimate_low += Decimal(float(estimate)) < error
            if reason != 1:
                continue
            psi_error = abs(net.psi(X) - Decimal(float(psi)))
            if not Decimal(float(bound)) >= error or not Decimal(float(psi_bound)) >= psi_error:
                low += 1
                print(f"BELOW: net {n_net - 1} (kind {int(net.kind)}), stop {k}: bound {bound:.6e}, error {error:.6e}; "
                      f"psi bound {psi_bound:.6e}, error {psi_error:.6e}; condition {condition:.1e}")
            if condition < 1e10 and error > 0:
                ratios.append(float(Decimal(float(bound)) / error))
                if psi_error > 0:
                    psi_ratios.append(float(Decimal(float(psi_bound)) / psi_error))
    shapes = sum(reasons.values()) - reasons["no shape"]
    share = reasons["certified"] / max(shapes, 1)
    median = float(np.median(ratios)) if ratios else np.nan
    print(f"  {n_net} nets, {shapes} shapes: {100 * share:.1f} % certified, {low} bounds below the error; "
          f"{unknown} certified shapes without an oracle")
    print("  " + ", ".join(f"{name} {n}" for name, n in reasons.most_common()))
    print("  converged shapes: " + ", ".join(f"{name} {n}" for name, n in converged.most_common()))
    for kind in sorted(per_kind):
        print(f"    kind {kind}: " + ", ".join(f"{name} {n}" for name, n in per_kind[kind].most_common()))
    if ratios:
        print(f"  bound over error, condition below 1e10: median {median:.4f}, 90 % {np.percentile(ratios, 90):.3f}, "
              f"largest {max(ratios):.3g} ({len(ratios)} shapes); of psi: median {np.median(psi_ratios):.4f}")
    print(f"  the estimate was below the error in {estimate_low} of {compared} shapes")
    return int(low > 0 or share < least or not (median <= largest))


if __name__ == "__main__":
    sys.exit(main())
