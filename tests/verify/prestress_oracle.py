#!/usr/bin/env python3
"""Oracle for form.prestress: exact, independent of the program: dense numpy and scipy, another algorithm.

    prestress_oracle.py HIFDM NETS [SEED]

The script makes NETS random double nets with ties. Their nodes are up to 0.8 of a cell off the grid, so that cables in
tension cannot hold some nets. The program must hold a net if and only if a linear programme finds tensions that do.
Then no node may move, and no tension may be below the minimum. The sum of squared differences from the required
tensions must be that of a quadratic programme over the null space of the equilibrium equations. The exit status is 0 if
all of this holds."""
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np
from scipy.linalg import null_space
from scipy.optimize import linprog, minimize

LEAST = 1e-2  # of the largest tension that is wanted


def net(rng):
    nx, ny, bend = rng.integers(3, 7), rng.integers(3, 7), rng.uniform(0.03, 0.1)
    jitter, n = rng.uniform(0, 0.8), nx * ny
    plane = np.array([[i, j] for j in range(ny) for i in range(nx)], float) - [(nx - 1) / 2, (ny - 1) / 2]
    plane += rng.uniform(-jitter, jitter, plane.shape)
    r2 = (plane**2).sum(1)
    x = np.r_[np.c_[plane, bend * r2], np.c_[plane, -4 - rng.uniform(0.7, 1.4) * bend * r2]]
    at = lambda k: (k % nx, k % n // nx)
    fixed = np.array([at(k)[0] in (0, nx - 1) or at(k)[1] in (0, ny - 1) for k in range(2 * n)])
    ends = [(k, k + s) for k in range(2 * n) for s, dx, dy in ((1, 1, 0), (nx, 0, 1), (nx + 1, 1, 1))
            if at(k)[0] + dx < nx and at(k)[1] + dy < ny] + [(k, k + n) for k in range(n)]
    ends = np.array([e for e in ends if not (fixed[e[0]] and fixed[e[1]])])
    return x, fixed, ends, rng.uniform(1, 12, len(ends))


def equations(x, fixed, ends):
    A = np.zeros((len(x), 3, len(ends)))
    d = x[ends[:, 1]] - x[ends[:, 0]]
    u = d / np.linalg.norm(d, axis=1)[:, None]
    for e, (a, b) in enumerate(ends):
        A[a, :, e] += u[e]
        A[b, :, e] -= u[e]
    return A[~fixed].reshape(-1, len(ends))


def write(folder, x, fixed, ends, wanted):
    (folder / "n.csv").write_text("id,x_m,y_m,z_m,role\n" + "".join(
        f"n{k},{p[0]:.17g},{p[1]:.17g},{p[2]:.17g},{'support' if f else 'inner'}\n"
        for k, (p, f) in enumerate(zip(x, fixed))))
    (folder / "c.csv").write_text("id,i,j,group,law,value\n" + "".join(
        f"c{k},n{a},n{b},inner,tension,{T:.17g}\n" for k, ((a, b), T) in enumerate(zip(ends, wanted))))
    (folder / "case.yaml").write_text("scene: {import: {nodes: n.csv, cables: c.csv}}\nform: {prestress: exact}\n")


def judge(program, folder, x, fixed, ends, wanted):
    """Returns what is wrong, or None, and whether the net can be held."""
    write(folder, x, fixed, ends, wanted)
    run = subprocess.run([program, "run", folder / "case.yaml", "-o", folder / "r.h5", "--force"], capture_output=True)
    A, least = equations(x, fixed, ends), LEAST * wanted.max()
    can = linprog(np.zeros(len(ends)), A_eq=A, b_eq=np.zeros(len(A)), bounds=(least, None), method="highs").status == 0
    if (run.returncode == 0) != can:
        return f"exit status {run.returncode}, held by the linear programme: {can}", can
    if not can:
        return None, can
    with h5py.File(folder / "r.h5") as f:
        T, psi = f["form/tension_N"][()], f["form"].attrs["psi_m"]
    N = null_space(A)
    free = N.T @ wanted  # without limits the nearest tensions are the projection
    if (N @ free).min() < least:
        free = minimize(lambda z: ((N @ z - wanted) ** 2).sum(), N.T @ T * 0.9 + N.T @ wanted * 0.1,
                        jac=lambda z: 2 * N.T @ (N @ z - wanted), method="SLSQP",
                        options={"ftol": 1e-14, "maxiter": 1000},
                        constraints={"type": "ineq", "fun": lambda z: N @ z - least, "jac": lambda z: N}).x
    ours, theirs = ((T - wanted) ** 2).sum(), ((N @ free - wanted) ** 2).sum()
    wrong = psi > 1e-9 or abs(A @ T).max() > 1e-8 or T.min() < least * (1 - 1e-9) or abs(ours - theirs) > 1e-6 * theirs
    return (f"psi {psi} m, least {T.min()} N, {ours} against {theirs}" if wrong else None), can


def main(program, n, seed):
    rng, bad, held = np.random.default_rng(seed), 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for k in range(n):
            wrong, can = judge(program, Path(folder), *net(rng))
            held += can
            if wrong:
                bad += 1
                print(f"net {k} of seed {seed}: {wrong}")
    print(f"{n} nets, {held} can be held; {bad} wrong")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 1))
