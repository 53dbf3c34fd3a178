#!/usr/bin/env python3
"""Oracle for the pillow of a mesh, independent of the program: the membrane in each facet by harmonic polynomials.

    mesh_oracle.py RESULT FACETS

RESULT is a result file of `hifdm run` with surface.mesh_tension_N_per_m, and FACETS the form_facets.hdf of `hifdm
export --vtk`. Each facet is a membrane of tension N in its mean plane (Laplace's equation). Its sides are straight, but
sides between two facets are arcs of height F l^2 / (8 T), where F is the pull of both membranes on the cable. Re z^k
and Im z^k up to k = DEGREE fit the values on the sides by least squares. The errors of the facets along the normal must
be those of the file, to 1e-3 of the errors that the mesh adds."""
import sys

import figures
import h5py
import numpy as np

DEGREE, POINTS = 16, 40


def unit(v):
    return v / np.linalg.norm(v)


class Facet:
    def __init__(self, points):
        self.p = points
        self.normal = unit(np.cross(points[2] - points[0], points[-1] - points[1]))
        self.x = unit(points[1] - points[0] - self.normal * ((points[1] - points[0]) @ self.normal))
        self.y = np.cross(self.normal, self.x)
        self.middle = points.mean(axis=0)
        self.sag = np.zeros(len(points))

    def side(self, k):
        return self.p[k], self.p[(k + 1) % len(self.p)]

    def settle(self):
        """Computes the coefficients of the harmonic polynomials. t runs along the sides."""
        t = (1 - np.cos(np.pi * (np.arange(POINTS) + 0.5) / POINTS)) / 2
        at, value = [], []
        for k in range(len(self.p)):
            a, b = self.side(k)
            q = a + np.outer(t, b - a) - self.middle
            at.append(q @ self.x + 1j * (q @ self.y))
            value.append(q @ self.normal + 4 * t * (1 - t) * self.sag[k])
        at = np.concatenate(at)
        self.scale = abs(at).max()
        self.c = np.linalg.lstsq(self.basis(at), np.concatenate(value), rcond=None)[0]

    def basis(self, z):
        power = (z[:, None] / self.scale) ** np.arange(DEGREE + 1)
        return np.hstack([power.real, power.imag[:, 1:]])

    def quadrature(self, n=8):
        """Returns points of the membrane and weights, projected area: triangles around the middle."""
        g, w = np.polynomial.legendre.leggauss(n)
        u, v = (a.ravel() for a in np.meshgrid((g + 1) / 2, (g + 1) / 2))
        w = np.outer(w, w).ravel() / 4 * v
        flat = [np.array([(q - self.middle) @ self.x, (q - self.middle) @ self.y]) for q in self.p]
        points, weights = [], []
        for a, b in zip(flat, flat[1:] + flat[:1]):
            xy = np.outer(v * (1 - u), a) + np.outer(v * u, b)
            h = self.basis(xy[:, 0] + 1j * xy[:, 1]) @ self.c
            points.append(self.middle + np.outer(xy[:, 0], self.x) + np.outer(xy[:, 1], self.y) +
                          np.outer(h, self.normal))
            weights.append(w * abs(a[0] * b[1] - a[1] * b[0]) * abs(self.normal[2]))
        return np.concatenate(points), np.concatenate(weights)


def main(path, facets_path):
    result, cells = h5py.File(path, "r"), h5py.File(facets_path, "r")["VTKHDF"]
    settings, form = result["surface"].attrs, result["form"]
    N, f, is_round = settings["mesh_tension_N_per_m"], settings["focal_length_m"], settings["kind"] == 2
    position = form["position_m"][:]
    start = cells["Offsets"][:]
    corners = [cells["Connectivity"][a:b].tolist() for a, b in zip(start, start[1:])]
    tension, facet_of = {}, {}
    for (i, j), T in zip(result["scene/cable/end"][:].tolist(), form["tension_N"][:]):
        key = frozenset((i, j))
        tension[key] = tension.get(key, 0) + T
    facets = [Facet(position[c]) for c in corners]
    for i, c in enumerate(corners):
        for k in range(len(c)):
            facet_of.setdefault(frozenset((c[k], c[(k + 1) % len(c)])), []).append((i, k))
    ratio = 0
    for key, both in facet_of.items():
        if len(both) < 2:
            continue
        pull = 0
        for i, k in both:
            a, b = facets[i].side(k)
            pull = pull + N * np.cross(facets[i].normal, unit(b - a))
        length = np.linalg.norm(b - a)
        ratio = max(ratio, N * length / tension[key])
        for i, k in both:
            facets[i].sag[k] = pull @ facets[i].normal * length**2 / (8 * tension[key])
    total = {True: 0, False: 0}
    for is_mesh in total:
        area = 0
        for facet in facets:
            facet.sag *= is_mesh
        # sags are taken away in the second round, the membranes of tension without bent cables
            facet.settle()
            p, w = facet.quadrature()
            slope = p[:, :2] / (2 * f) * [1, is_round]
            above = p[:, 2] - (p[:, 0] ** 2 + is_round * p[:, 1] ** 2) / (4 * f)
            total[is_mesh] += (w * above**2 / (1 + (slope**2).sum(axis=1))).sum()
            area += w.sum()
        total[is_mesh] = np.sqrt(total[is_mesh] / area)
    said = result["surface/form"].attrs
    added = total[True] - total[False]
    print(f"{len(facets)} facets: {total[True]:.9g} m, of which the mesh {added:.3g} m; the file "
          f"{said['facet_normal_rms_m']:.9g} m; N l / T {ratio:.4g}")
    figures.worst(abs(said["facet_normal_rms_m"] - total[True]) / added, 1e-3,
                  f"{len(facets)} facets: RMS that the mesh adds, in parts of it")
    assert abs(said["mesh_pull_ratio"] - ratio) < 1e-9 * ratio
    assert abs(said["facet_normal_rms_m"] - total[True]) < 1e-3 * added, "another pillow"


main(*sys.argv[1:])
