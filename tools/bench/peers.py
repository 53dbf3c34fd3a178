#!/usr/bin/env python3
"""The force density method as an expert in numpy and scipy would write it today. The pattern is fixed once, one sparse
product gives the values, and LAPACK's band solver or SuperLU solves. run.py runs the script, which prints samples as
the C driver does and reads FOLDER/NAME.net.

    peers.py version | peers.py step FOLDER | peers.py single FOLDER NAME | peers.py precision FOLDER NAME
    peers.py built FOLDER SIGMA_MM
    peers.py pattern FOLDER TO_DEG
"""
import os
import sys
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
try:
    import numpy as np
    import scipy
    import scipy.sparse as sp
    from scipy.linalg import solveh_banded
    from scipy.linalg.lapack import dpbsv
    from scipy.sparse.linalg import splu
except ImportError:
    sys.exit(3)

ENOUGH_S = 0.1
WANTED_M = 1e-6
TRACE_S, TRACE_LEAST = 20, 1e-10  # as in precision.c
TENSION, LENGTH, FORCE_DENSITY = range(3)


class Net:
    """A net as bench_write_net (step.c) writes it: rows instead of nodes, free ones first."""

    def __init__(self, path):
        field = {}
        with open(path) as file:
            for line in file:
                name, _, *values = line.split()
                field[name] = np.array(values, dtype=float)
        self.n_node, self.n, self.m, self.b = (int(v) for v in field["size"])
        self.end = field["end_row"].astype(int).reshape(-1, 2)
        self.x0 = field["position_m"].reshape(3, -1).T.copy()
        load = field["load_N"]
        self.load = load.reshape(3, -1)[:, : self.n].ravel() if load.size else np.zeros(3 * self.n)
        self.q0, self.target, self.law = field["q"], field["target"], field["law"].astype(int)
        self.reference = field["reference_m"].reshape(3, -1).T
        self.patterns()

    def patterns(self):
        n, m = self.n, self.m
        cable = np.arange(m)
        a, b = self.end[:, 0], self.end[:, 1]
        low, high = np.minimum(a, b), np.maximum(a, b)
        inside, one_end = high < n, (low < n) & (high >= n)
        row = np.concatenate([a[a < n], b[b < n], high[inside]])
        column = np.concatenate([a[a < n], b[b < n], low[inside]])
        who = np.concatenate([cable[a < n], cable[b < n], cable[inside]])
        sign = np.concatenate([np.ones((a < n).sum() + (b < n).sum()), -np.ones(inside.sum())])
        # lower band column by column, as LAPACK requires it, so that nothing is copied
        self.band_of_q = sp.csr_matrix((sign, (row - column + column * (self.b + 1), who)), shape=((self.b + 1) * n, m))
        # the full matrix for SuperLU, by columns
        off = sign < 0
        row, column = np.concatenate([row, column[off]]), np.concatenate([column, row[off]])
        who, sign = np.concatenate([who, who[off]]), np.concatenate([sign, sign[off]])
        place, inverse = np.unique(column * n + row, return_inverse=True)
        self.sparse_of_q = sp.csr_matrix((sign, (inverse, who)), shape=(place.size, m))
        pointer = np.searchsorted(place // n, np.arange(n + 1))
        self.matrix = sp.csc_matrix((np.zeros(place.size), place % n, pointer), shape=(n, n))
        # right-hand side: the pull of the supports on the free nodes
        k = cable[one_end]
        values, free = self.x0[high[k]], low[k]
        where = (free[:, None] + np.arange(3) * n).ravel()
        self.rhs_of_q = sp.csr_matrix((values.ravel(), (where, np.repeat(k, 3))), shape=(3 * n, m))
        self.branch = sp.csr_matrix((np.tile([1.0, -1.0], m), (np.repeat(cable, 2), self.end[:, ::-1].ravel())),
                                    shape=(m, self.n_node))
        self.is_tension, self.is_length = self.law == TENSION, self.law == LENGTH

    def rhs(self, q):
        return (self.load + self.rhs_of_q @ q).reshape(3, -1).T

    def band(self, q):
        return (self.band_of_q @ q).reshape(-1, self.b + 1).T

    def solveh_banded(self, q):
        return solveh_banded(self.band(q), self.rhs(q), overwrite_ab=True, overwrite_b=True, lower=True,
                             check_finite=False)

    def dpbsv(self, q):
        return dpbsv(self.band(q), self.rhs(q), lower=1, overwrite_ab=1, overwrite_b=1)[1]

    def splu(self, q):
        self.matrix.data = self.sparse_of_q @ q
        return splu(self.matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                    options={"SymmetricMode": True}).solve(self.rhs(q))

    def step(self, solve, q, x):
        """Does one step: assembly, factor, three right-hand sides, lengths."""
        x[: self.n] = solve(q)
        d = self.branch @ x
        return np.sqrt(np.einsum("ij,ij->i", d, d))

    def update(self, q, length):
        """Returns the force densities after Eqs. 7 and 8."""
        return np.where(self.is_tension, self.target / length, np.where(self.is_length, q * length / self.target, q))

    def iterate(self, solve, count, wanted_m=None):
        """Does `count` iterations, or as many as bring the shape within wanted_m of the reference. Returns their
        number."""
        q, x = self.q0, self.x0.copy()
        for k in range(1, count + 1):
            length = self.step(solve, q, x)
            if wanted_m and self.error_m(x) <= wanted_m:
                return k
            q = self.update(q, length)
        return count


    def error_m(self, x):
        return np.sqrt(((x - self.reference) ** 2).sum(axis=1)).max()

    def trace(self, solve):
        """Yields (decade, seconds, error, iterations) whenever the error has fallen below another decade. Computing the
        error is not timed."""
        q, x, passed_s, wanted_m, k = self.q0, self.x0.copy(), 0.0, np.inf, 0
        while passed_s < TRACE_S and wanted_m > TRACE_LEAST:
            k, start = k + 1, time.perf_counter()
            length = self.step(solve, q, x)
            passed_s += time.perf_counter() - start
            error_m = self.error_m(x)
            if error_m <= wanted_m:
                wanted_m = 10.0 ** np.floor(np.log10(error_m))
                yield wanted_m, passed_s, error_m, k
            start = time.perf_counter()
            q = self.update(q, length)
            passed_s += time.perf_counter() - start


def emit(section, scene, method, parameter, quantity, value):
    print(section, scene, method, f"{parameter:.9g}", quantity, f"{value:.9g}", sep="\t", flush=True)


def timed(work):
    start, n = time.perf_counter(), 0
    while True:
        work()
        n += 1
        passed = time.perf_counter() - start
        if passed > ENOUGH_S:
            return passed / n


def step(folder):
    net = Net(f"{folder}/step.net")
    ways = {"scipy solveh_banded": net.solveh_banded, "scipy dpbsv": net.dpbsv, "scipy splu": net.splu}
    first = None
    for _ in range(5):
        for name, solve in ways.items():
            x = net.x0.copy()
            emit("step", "21x25 perimeter", name, net.n, "time_s", timed(lambda: net.step(solve, net.q0, x)))
            first = x.copy() if first is None else first
            emit("step", "21x25 perimeter", name, net.n, "difference_m", abs(x - first).max())


def single(folder, scene):
    """Solves the fixed point to the required error: counts the iterations first, then times them without computing the
    error."""
    net = Net(f"{folder}/{scene}.net")
    count = net.iterate(net.solveh_banded, 200000, WANTED_M)
    for name, solve in {"scipy fixed point, band": net.solveh_banded, "scipy fixed point, splu": net.splu}.items():
        if "splu" in name and count * net.n > 1e6:
            continue  # the slower of the two, and slow
        start = time.perf_counter()
        net.iterate(solve, count)
        emit("single", scene, name, WANTED_M, "time_s", time.perf_counter() - start)
        emit("single", scene, name, WANTED_M, "iterations", count)


def precision(folder, scene):
    net = Net(f"{folder}/{scene}.net")
    net.iterate(net.solveh_banded, 5)  # the first calls are slow
    for decade, *values in net.trace(net.solveh_banded):
        for quantity, value in zip(("time_s", "error_m", "iterations"), values):
            emit("precision", scene, "scipy fixed point", decade, quantity, value)


class BuiltNet:
    """The as-built net with its samples, as built.c writes them: elastic cables, sum EA/(2 l0) max(l - l0, 0)^2."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.n_node, n, m, count = (int(v) for v in np.fromfile(file, "i4", 4))
            self.n, self.end = n, np.fromfile(file, "i4", 2 * m).reshape(m, 2)
            def read(*shape):
                return np.fromfile(file, "f8", int(np.prod(shape))).reshape(shape)
            self.x0 = read(3, self.n_node).T.copy()
            _, self.EA, self.tension = read(m), read(m), read(m)
            self.cut, self.found = read(count, m), read(count, 3, self.n_node).transpose(0, 2, 1)
        a, b = self.end.T
        # force on the free nodes from the pulls [3 m], and the matrix by columns from the blocks [m][3][3]
        one = np.concatenate([np.ones((a < n).sum()), -np.ones((b < n).sum())])
        row, who = np.concatenate([a[a < n], b[b < n]]), np.concatenate([np.flatnonzero(a < n), np.flatnonzero(b < n)])
        self.gather = sp.kron(sp.csr_matrix((one, (row, who)), shape=(n, m)), sp.eye(3), format="csr")
        inside = np.flatnonzero((a < n) & (b < n))
        i = np.concatenate([row, a[inside], b[inside]])
        j = np.concatenate([row, b[inside], a[inside]])
        who = np.concatenate([who, inside, inside])
        sign = np.where(np.arange(i.size) < row.size, 1.0, -1.0)
        c = np.arange(3)
        rows = (3 * i[:, None, None] + c[:, None] + 0 * c).ravel()
        columns = (3 * j[:, None, None] + 0 * c[:, None] + c).ravel()
        place, inverse = np.unique(columns * 3 * n + rows, return_inverse=True)
        blocks = (9 * who[:, None, None] + 3 * c[:, None] + c).ravel()
        self.data_of_blocks = sp.csr_matrix((np.repeat(sign, 9), (inverse, blocks)), shape=(place.size, 9 * m))
        pointer = np.searchsorted(place // (3 * n), np.arange(3 * n + 1))
        self.matrix = sp.csc_matrix((np.zeros(place.size), place % (3 * n), pointer), shape=(3 * n, 3 * n))
        self.soft = np.flatnonzero(place // (3 * n) == place % (3 * n))

    def geometry(self, x):
        d = x[self.end[:, 1]] - x[self.end[:, 0]]
        length = np.sqrt(np.einsum("ij,ij->i", d, d))
        return d / length[:, None], length

    def energy(self, x, cut):
        return (self.EA / (2 * cut) * np.maximum(self.geometry(x)[1] - cut, 0) ** 2).sum()

    def newton(self, cut, tolerance, most):
        """Solves by Newton's method from the nominal shape, with Armijo's rule on the energy. Returns shape, steps and
        residual."""
        x, residual = self.x0.copy(), np.inf
        for k in range(most + 1):
            u, length = self.geometry(x)
            stiffness = self.EA / cut * (length > cut)
            tension = stiffness * (length - cut)
            force = self.gather @ (tension[:, None] * u).ravel()
            residual = np.sqrt((force.reshape(-1, 3) ** 2).sum(axis=1).max()) / self.tension.max()
            if residual <= tolerance or k == most:
                break
            across = tension / length
            block = (stiffness - across)[:, None, None] * u[:, :, None] * u[:, None, :] \
                + across[:, None, None] * np.eye(3)
            self.matrix.data = self.data_of_blocks @ block.ravel()
            self.matrix.data[self.soft] += 1e-6  # N/m, for nodes without taut cables
            step = splu(self.matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                        options={"SymmetricMode": True}).solve(force)
            part, before, slope = 1.0, self.energy(x, cut), force @ step
            while part > 1e-3:
                trial = x.copy()
                trial[: self.n] += part * step.reshape(-1, 3)
                if self.energy(trial, cut) <= before - 1e-4 * part * slope + 1e-15 * before:
                    break
                part /= 2
            x = trial
        return x, k, residual


def built(folder, sigma_mm):
    """Measures samples. Those that do not converge in 60 steps are counted and left out of the differences."""
    net = BuiltNet(f"{folder}/built_{sigma_mm}.bin")
    net.newton(net.cut[0], 1e-8, 2)  # the first calls are slow
    start, steps, missed, difference = time.process_time(), [], 0, 0.0
    for cut, found in zip(net.cut, net.found):
        x, k, residual = net.newton(cut, 1e-8, 60)
        steps.append(k)
        missed += residual > 1e-8
        if residual <= 1e-8:
            held = np.zeros(net.n_node, dtype=bool)  # loose nodes have no unique position
            held[net.end[net.geometry(x)[1] > cut * (1 + 1e-9)]] = True
            difference = max(difference, np.sqrt(((x - found)[held] ** 2).sum(axis=1)).max())
    seconds = (time.process_time() - start) / len(net.cut)
    for quantity, value in (("cpu_s", seconds), ("steps", np.mean(steps)),
                            ("error_m", difference), ("missed", missed / len(net.cut))):
        emit("built", "21x25 f=7.2 as built", "scipy Newton; splu", float(sigma_mm), quantity, value)


def pattern(folder, to_deg):
    """Computes the far field of pattern.c. Each facet has as many points of Gauss-Legendre. All angles are computed at
    a time, by blocks of points, and the currents by one product of matrices. Only the sum is timed."""
    lines = open(f"{folder}/pattern.txt").read().split("\n")
    head = lines[0].split()
    n_facet, n_point = int(head[0]), int(head[1])
    focus, axis, co = np.array(head[2:11], float).reshape(3, 3).T
    q, scale = map(float, head[11:13])
    corner = np.array([l.split() for l in lines[1:1 + 4 * n_facet]], float).reshape(n_facet, 4, 1, 3)
    table = np.array([l.split() for l in lines[1 + 4 * n_facet:] if l], float)
    at, weight = np.polynomial.legendre.leggauss(round((n_point / n_facet) ** 0.5))
    at, weight = (at + 1) / 2, weight / 2
    u, v = [g.ravel()[None, :, None] for g in np.meshgrid(at, at)]
    a, b, c, d = corner[:, 0], corner[:, 1], corner[:, 2], corner[:, 3]
    p = ((1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * c)).reshape(-1, 3)
    area = np.cross((1 - v) * (b - a) + v * (c - d), (1 - u) * (d - a) + u * (c - b))
    area = (area * np.outer(weight, weight).ravel()[None, :, None]).reshape(-1, 3)
    rho = np.linalg.norm(p - focus, axis=1)
    to = (p - focus) / rho[:, None]
    e = co - ((to @ co) / (1 + to @ axis))[:, None] * (axis + to)
    current = 2 * np.cross(area, np.cross(to, e) * ((to @ axis) ** q / rho)[:, None])
    theta, k = np.radians(table[:, 0]), 2 * np.pi * 10e9 / 299792458.0
    s = np.stack([np.sin(theta), 0 * theta, np.cos(theta)])
    for method in ("numpy, exp", "numpy, cos and sin"):
        start, N = time.perf_counter(), np.zeros((len(theta), 3), complex)
        for i in range(0, len(p), 1024):
            phase = (k * p[i:i + 1024]) @ s - (k * rho[i:i + 1024])[:, None]
            if method == "numpy, exp":
                N += np.exp(1j * phase).T @ current[i:i + 1024]
            else:
                N += np.cos(phase).T @ current[i:i + 1024] + 1j * (np.sin(phase).T @ current[i:i + 1024])
        seconds = time.perf_counter() - start
        along = np.stack([np.cos(theta), 0 * theta, -np.sin(theta)], axis=1)
        field = np.abs((N * along).sum(axis=1)) * np.sqrt(scale) * k / (2 * np.pi)
        off = np.abs(field - 10 ** (table[:, 1] / 20)).max() / field.max()
        for quantity, value in (("wall_s", seconds), ("points", len(p)), ("difference", off)):
            emit("pattern", "12 m offset reflector at 10 GHz", method, float(to_deg), quantity, value)


if __name__ == "__main__":
    if sys.argv[1] == "version":
        print("numpy", np.__version__, "scipy", scipy.__version__)
    elif sys.argv[1] == "step":
        step(sys.argv[2])
    elif sys.argv[1] == "precision":
        precision(sys.argv[2], sys.argv[3])
    elif sys.argv[1] == "built":
        built(sys.argv[2], sys.argv[3])
    elif sys.argv[1] == "pattern":
        pattern(sys.argv[2], sys.argv[3])
    else:
        single(sys.argv[2], sys.argv[3])
