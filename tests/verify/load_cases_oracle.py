#!/usr/bin/env python3
"""Oracle for load cases of the as-built net, independent of the program: dense numpy, its own bar truss.

    load_cases_oracle.py make N FOLDER       writes random cases FOLDER/1 to FOLDER/N: net, truss (odd ones), load cases
    load_cases_oracle.py check N FOLDER      checks the results FOLDER/1.h5 ... FOLDER/N.h5

`check` draws the same random numbers again. It takes only the design from the result (lengths and tensions of /form)
and cuts the cables. It finds each load case by damped Newton steps, which minimise an energy. The energy is that of
cables without compression, of the bars of the truss (linear, pinned, in the shape in which it was made) and of the dead
loads. The script prints the largest differences of positions, tensions and bar forces, and the numbers of slack cables.
The exit status is 1 if one is too large."""
import os
import sys

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # matrices are small: threads would wait for each other

import figures
import numpy as np

TOLERANCE_M, TOLERANCE_N = 1e-9, 1e-6  # the residuals of both are 1e-9 N or less, stiffnesses are 1 N/m or more
ARMS, RINGS = 7, 3
SLACK = 1e-3  # of the largest tension of the design, HF_SLACK_RATIO


class Case:
    def __init__(self, seed):
        r = np.random.default_rng(seed)
        self.on_truss = seed % 2 == 1
        angle = 2 * np.pi * np.arange(ARMS) / ARMS
        ring = lambda R, z: np.stack([R * np.cos(angle), R * np.sin(angle), z + 0 * angle], axis=1)
        places = [ring(0.6 * (k + 1), 0.05 * (k + 1) ** 2) for k in range(RINGS)]
        self.x = np.concatenate([[[0, 0, 0.0]], *places]) + r.uniform(-0.05, 0.05, (1 + ARMS * RINGS, 3))
        at = lambda k, i: 1 + ARMS * k + i % ARMS
        self.support = np.arange(len(self.x)) > ARMS * (RINGS - 1)
        radial = [(0, at(0, i)) for i in range(ARMS)]
        radial += [(at(k, i), at(k + 1, i)) for k in range(RINGS - 1) for i in range(ARMS)]
        around = [(at(k, i), at(k, i + 1)) for k in range(RINGS - 1) for i in range(ARMS)]
        self.end = np.array(radial + around)
        self.is_radial = np.arange(len(self.end)) < len(radial)
        self.q = np.where(self.is_radial, r.uniform(10, 40, len(self.end)), r.uniform(5, 20, len(self.end)))
        self.EA = 10 ** r.uniform(3, 4.5, len(self.end))
        self.alpha = np.where(self.is_radial, 2e-5, -1e-5)
        self.mu = np.where(self.is_radial, 0.02, 0.05)
        self.mass = np.where(self.support, 0.3, 0.1)
        self.states = [self.state(r, k) for k in range(4)]
        if self.on_truss:
            self.make_truss(r, at)

    def state(self, r, k):
        n = len(self.x)
        return {"T": r.uniform(-600, 600), "T_radial": r.uniform(-400, 700), "T_truss": r.uniform(-200, 200),
                "gradient": r.uniform(-20, 20, 3), "g": r.uniform(1, 10), "direction": r.uniform(-1, 1, 3),
                "push": r.uniform(-0.5, 0.5, 3), "F": r.uniform(-1, 1, (n, 3)),
                "move": np.where(self.support[:, None], r.uniform(-2e-3, 2e-3, (n, 3)), 0)}

    def make_truss(self, r, at):
        """Makes a truss: each support stands on three bars to the ground, and bars join neighbours."""
        top = self.x[self.support]
        self.ground = top * [1.2, 1.2, 0] + [0, 0, -1] + r.uniform(-0.1, 0.1, top.shape)
        self.truss_x = np.concatenate([top, self.ground])
        bars = [(i, ARMS + (i + d) % ARMS) for i in range(ARMS) for d in (-1, 0, 1)]
        self.bar = np.array(bars + [(i, (i + 1) % ARMS) for i in range(ARMS)])
        n = len(self.bar)
        self.E, self.A = np.full(n, 70e9), r.uniform(2e-6, 2e-5, n)
        self.bar_alpha, self.rho = r.uniform(-1e-6, 2.5e-5, n), np.full(n, 2700.0)
        self.hinge = r.uniform(0, 0.5, 2 * ARMS)

    # ---- writing ----

    def write(self, folder):
        g = lambda v: repr(float(v))
        row = lambda *v: ",".join(x if isinstance(x, str) else g(x) for x in v) + "\n"
        with open(folder + "/nodes.csv", "w") as f:
            f.write("id,x_m,y_m,z_m,role\n")
            for i, p in enumerate(self.x):
                f.write(row(f"n{i}", *p, "support" if self.support[i] else "inner"))
        with open(folder + "/cables.csv", "w") as f:
            f.write("id,i,j,group,law,value,EA_N,set\n")
            for e, (i, j) in enumerate(self.end):
                f.write(row(f"c{e}", f"n{i}", f"n{j}", "inner", "force_density", self.q[e], self.EA[e],
                            "radial" if self.is_radial[e] else "around"))
        lines = ["scene: {import: {nodes: nodes.csv, cables: cables.csv}}",
                 "form: {residual_tolerance: 1e-11}", "coupling: {tof_m: 1e-12}",
                 "cables:", "  - {expansion_per_K: -1e-5, mass_kg_per_m: 0.05}",
                 "  - {set: radial, expansion_per_K: 2e-5, mass_kg_per_m: 0.02}",
                 "nodes:", "  - {mass_kg: 0.1}", "  - {role: support, mass_kg: 0.3}", "cases:"]
        vector = lambda v: "[" + ", ".join(g(x) for x in v) + "]"
        for k, s in enumerate(self.states):
            name = f"  - {{name: s{k}, "
            lines += [name + f"temperature_K: {g(s['T'])}, gradient_K_per_m: {vector(s['gradient'])}, part: net}}",
                      name + f"set: radial, temperature_K: {g(s['T_radial'])}}}",
                      name + f"gravity_m_per_s2: {g(s['g'])}, direction: {vector(s['direction'])}}}",
                      name + f"force_N: {vector(s['push'])}, role: inner}}", name + f"nodes: s{k}.csv}}"]
            if self.on_truss:
                lines.append(name + f"part: truss, temperature_K: {g(s['T_truss'])}}}")
            with open(f"{folder}/s{k}.csv", "w") as f:
                f.write("id,Fx_N,Fy_N,Fz_N,dx_m,dy_m,dz_m\n")
                for i in range(len(self.x)):
                    f.write(row(f"n{i}", *s["F"][i], *s["move"][i]))
        if self.on_truss:
            lines.append("truss: {import: {nodes: truss_nodes.csv, members: members.csv}}")
            with open(folder + "/truss_nodes.csv", "w") as f:
                f.write("id,x_m,y_m,z_m,fixed,mass_kg\n")
                for i, p in enumerate(self.truss_x):
                    f.write(row(f"t{i}", *p, "ux uy uz" if i >= ARMS else "", self.hinge[i]))
            with open(folder + "/members.csv", "w") as f:
                f.write("id,i,j,E_Pa,A_m2,density_kg_per_m3,expansion_per_K,joint\n")
                for e, (i, j) in enumerate(self.bar):
                    numbers = self.E[e], self.A[e], self.rho[e], self.bar_alpha[e]
                    f.write(row(f"b{e}", f"t{i}", f"t{j}", *numbers, "pinned"))
        open(folder + "/case.yaml", "w").write("\n".join(lines) + "\n")

    # ---- the truss alone ----

    def stiffness(self):
        """Returns the stiffness of the supports [3 ARMS][3 ARMS], and directions, lengths and EA of the bars."""
        d = self.truss_x[self.bar[:, 1]] - self.truss_x[self.bar[:, 0]]
        L = np.linalg.norm(d, axis=1)
        n, EA, K = d / L[:, None], self.E * self.A, np.zeros((6 * ARMS, 6 * ARMS))
        for e, (i, j) in enumerate(self.bar):
            b = np.zeros(6 * ARMS)
            b[3 * i:3 * i + 3], b[3 * j:3 * j + 3] = -n[e], n[e]
            K += EA[e] / L[e] * np.outer(b, b)
        return K[: 3 * ARMS, : 3 * ARMS], n, L, EA

    def own_load(self, s, n, L, EA):
        """Returns the loads of temperature and weight on the free nodes of the truss."""
        f, down = np.zeros((2 * ARMS, 3)), s["g"] * s["direction"] / np.linalg.norm(s["direction"])
        for e, (i, j) in enumerate(self.bar):
            hot = EA[e] * self.bar_alpha[e] * s["T_truss"] * n[e]
            weight = self.rho[e] * self.A[e] * L[e] * down / 2
            f[i] += weight - hot
            f[j] += weight + hot
        return (f + self.hinge[:, None] * down)[:ARMS].ravel()

    # ---- one state ----

    def solve(self, s, l0, start):
        """Returns positions, tensions and bar forces."""
        middle = (self.x[self.end[:, 0]] + self.x[self.end[:, 1]]) / 2
        heat = np.where(self.is_radial, s["T_radial"], s["T"] + middle @ s["gradient"])
        l0_hot, down = l0 * (1 + self.alpha * heat), s["g"] * s["direction"] / np.linalg.norm(s["direction"])
        load = s["F"] + np.where(self.support, 0, 1)[:, None] * s["push"] + self.mass[:, None] * down
        for k in (0, 1):
            np.add.at(load, self.end[:, k], (self.mu * l0 / 2)[:, None] * down)
        rest = self.x + s["move"]
        free = np.repeat(~self.support | self.on_truss, 3)
        K = np.zeros((3 * len(self.x),) * 2)
        own = 0
        if self.on_truss:
            hard = np.repeat(self.support, 3)
            K_top, n, L, EA = self.stiffness()
            own = self.own_load(s, n, L, EA)
            K[np.ix_(hard, hard)] = K_top
            rest[self.support] += np.linalg.solve(K_top, own).reshape(-1, 3)
        x = np.where(self.support[:, None], rest, start)

        def energy(x, slopes):
            d = x[self.end[:, 1]] - x[self.end[:, 0]]
            l = np.linalg.norm(d, axis=1)
            T = self.EA * np.maximum(l / l0_hot - 1, 0)
            off = np.where(self.support[:, None], x - rest, 0).ravel()
            E = (T**2 * l0_hot / self.EA).sum() / 2 - (load * x).sum() + off @ K @ off / 2
            if not slopes:
                return E
            gradient, H = (K @ off).reshape(-1, 3) - load, K.copy()
            for e, (i, j) in enumerate(self.end):
                u = d[e] / l[e]
                gradient[j] += T[e] * u
                gradient[i] -= T[e] * u
                along = self.EA[e] / l0_hot[e] if T[e] else 0
                B = T[e] / l[e] * (np.eye(3) - np.outer(u, u)) + along * np.outer(u, u)
                for a, b, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
                    H[3 * a:3 * a + 3, 3 * b:3 * b + 3] += sign * B
            return E, gradient.ravel()[free], H[np.ix_(free, free)], T

        damping = 1.0
        for _ in range(2000):
            E, gradient, H, T = energy(x, True)
            if np.abs(gradient).max() < 1e-9:
                break
            while True:
                step = np.zeros(3 * len(self.x))
                step[free] = -np.linalg.solve(H + damping * np.eye(len(H)), gradient)
                step = step.reshape(-1, 3)
                # rounding of the energy hides small gains: near the end the gradient decides
                better = energy(x + step, False) < E or np.abs(energy(x + step, True)[1]).max() < np.abs(gradient).max()
                if better or damping > 1e12:
                    break
                damping *= 4
            x = x + step
            damping = max(damping / 8, 1e-14)
        assert np.abs(gradient).max() < 1e-7, "the oracle does not converge"
        force = None
        if self.on_truss:
            u = np.zeros((2 * ARMS, 3))
            u[:ARMS] = (x - self.x - s["move"])[self.support]
            force = EA / L * ((u[self.bar[:, 1]] - u[self.bar[:, 0]]) * n).sum(1) - EA * self.bar_alpha * s["T_truss"]
        return x, T, force

    def check(self, path):
        import h5py

        worst = np.zeros(3)
        slack = []
        with h5py.File(path, "r") as f:
            l0 = f["form/length_m"][:] / (1 + f["form/tension_N"][:] / self.EA)
            for k, s in enumerate(self.states):
                state = f[f"load_cases/s{k}"]
                x, T, force = self.solve(s, l0, f["form/position_m"][:])
                worst[0] = max(worst[0], np.abs(state["position_m"][:] - x).max())
                worst[1] = max(worst[1], np.abs(state["tension_N"][:] - T).max())
                if self.on_truss:
                    worst[2] = max(worst[2], np.abs(state["truss/member/end_force"][:, 6] - force).max())
                slack.append(int((T < SLACK * f["form/tension_N"][:].max()).sum()))
                if state.attrs["n_slack"] != slack[-1]:
                    worst[:] = np.inf
                inner = ~self.support
                psi = np.sqrt(((x - self.x)[inner] ** 2).sum(1).mean())
                worst[0] = max(worst[0], abs(psi - state.attrs["psi_m"]))
        print(f"truss {self.on_truss}: places {worst[0]:.1e} m, tensions {worst[1]:.1e} N, bars {worst[2]:.1e} N; "
              f"slack {slack} of {len(T)}")
        where = f"net {os.path.basename(path)[:-3]}, {len(self.states)} states: "
        figures.worst(worst[0], TOLERANCE_M, where + "places, m")
        figures.worst(worst[1], TOLERANCE_N, where + "tensions, N")
        if self.on_truss:
            figures.worst(worst[2], TOLERANCE_N, where + "forces of bars, N")
        return worst[0] < TOLERANCE_M and worst[1] < TOLERANCE_N and worst[2] < TOLERANCE_N


def main(what, n, folder):
    is_right = True
    for seed in range(1, int(n) + 1):
        if what == "make":
            os.mkdir(f"{folder}/{seed}")
            Case(seed).write(f"{folder}/{seed}")
        else:
            is_right &= Case(seed).check(f"{folder}/{seed}.h5")
    return 0 if is_right else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
