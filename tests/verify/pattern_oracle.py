#!/usr/bin/env python3
"""Oracle for far fields and for the files of `hifdm export --rf`, independent of the program: dense numpy.

    pattern_oracle.py field RESULT CSV      /pattern/form of RESULT, from the facets in the folder CSV
    pattern_oracle.py points RESULT RF      the same from RF/points.csv alone, and the content of RF/
    pattern_oracle.py antenna RESULT CSV    gain, loss, pointing and weighted errors of /surface/form, with both feeds

`field` sums the currents 2 n x H over 18 x 18 points of Gauss-Legendre on each facet, and computes the feed again from
the target positions. `points` does what a physical-optics program would do with the points, each of which stands for an
area. The script prints the largest differences. The exit status is 1 if one is too large."""
import csv
import sys

import h5py
import numpy as np

C = 299792458.0


def feed_of(h5, corners, f):
    """Returns focus, axis, polarisation, and the power of the cosine with 10 dB at the widest corner, of a point feed
    with polarisation along x."""
    x0 = h5["scene/node/position_m"][:]
    used = x0[np.unique(corners)]
    middle = (used[:, :2].min(axis=0) + used[:, :2].max(axis=0)) / 2
    focus = np.array([0, 0, f])
    axis = np.append(middle, middle @ middle / (4 * f)) - focus
    axis /= np.linalg.norm(axis)
    co = np.array([1.0, 0, 0]) - axis[0] * axis
    co /= np.linalg.norm(co)
    to = (used - focus) / np.linalg.norm(used - focus, axis=1)[:, None]
    q = -0.5 / np.log10((to @ axis).min())
    return focus, axis, co, q


def far_field(feed, wavelength, p, area, directions):
    """Returns N of all points p with vectors of area, in each direction, and the factor that makes it a gain."""
    focus, axis, co, q = feed
    rho = np.linalg.norm(p - focus, axis=1)
    to = (p - focus) / rho[:, None]
    c = to @ axis
    e = co - ((to @ co) / (1 + c))[:, None] * (axis + to)
    h = np.cross(to, e) * (c**q / rho)[:, None]
    current = 2 * np.cross(area, h)
    k = 2 * np.pi / wavelength
    N = np.array([np.exp(1j * k * (p @ s - rho)) @ current for s in directions])
    return N, (2 * q + 1) / 2 / wavelength**2


def compare(name, h5, feed, p, area, tolerance):
    """Compares with the stored gains. The roots of gains may differ by at most this part of the largest."""
    g = h5["pattern/form"]
    theta, worst = np.radians(g["theta_deg"][:]), 0
    for i, frequency in enumerate(g["frequency_Hz"][:]):
        for j, phi in enumerate(np.radians(g["phi_deg"][:])):
            s = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1)
            along = np.stack([np.cos(theta) * np.cos(phi), np.cos(theta) * np.sin(phi), -np.sin(theta)], axis=1)
            across = np.array([-np.sin(phi), np.cos(phi), 0])
            N, scale = far_field(feed, C / frequency, p, area, s)
            co = np.abs((N * (np.cos(phi) * along - np.sin(phi) * across)).sum(axis=1)) * np.sqrt(scale)
            cross = np.abs((N * (np.sin(phi) * along + np.cos(phi) * across)).sum(axis=1)) * np.sqrt(scale)
            top = co.max()
            for mine, stored in ((co, "co_dBi"), (cross, "cross_dBi")):
                worst = max(worst, np.abs(10 ** (g[stored][i, j] / 20) - mine).max() / top)
            best = co.argmax()
            beam = np.degrees(theta[best]) - g["beam_deg"][i, j]
            step = np.degrees(theta[1] - theta[0])
            if abs(beam) > step or abs(20 * np.log10(top) - g["gain_dBi"][i, j]) > 0.05:
                sys.exit(f"the beam is at {np.degrees(theta[best])} deg with {20 * np.log10(top)} dBi")
    print(f"{name}: fields differ by {worst:.1e} of the largest")
    if not worst < tolerance:
        sys.exit(1)


def read(path):
    with open(path, newline="") as f:
        return list(csv.DictReader(line for line in f if not line.startswith("#")))


def grid_of(x, corners):
    """Returns 18 x 18 points of each facet with their vectors of area."""
    a, w = np.polynomial.legendre.leggauss(18)
    a, w = (a + 1) / 2, w / 2
    u, v = [g.ravel() for g in np.meshgrid(a, a)]
    weight = np.outer(w, w).ravel()
    A, B, D, E = [x[corners[:, k]][:, None, :] for k in range(4)]
    u, v = u[None, :, None], v[None, :, None]
    p = (1 - v) * ((1 - u) * A + u * B) + v * ((1 - u) * E + u * D)
    du, dv = (1 - v) * (B - A) + v * (D - E), (1 - u) * (E - A) + u * (D - B)
    area = np.cross(du, dv) * weight[None, :, None]
    return p.reshape(-1, 3), area.reshape(-1, 3)


def facets_in(folder):
    nodes = read(f"{folder}/nodes.csv")
    place = {n["id"]: k for k, n in enumerate(nodes)}
    x = np.array([[float(n[c]) for c in ("x_m", "y_m", "z_m")] for n in nodes])
    return x, np.array([[place[r[c] or r["c"]] for c in "abcd"] for r in read(f"{folder}/facets.csv")])


def field(result, folder):
    x, corners = facets_in(folder)
    p, area = grid_of(x, corners)
    with h5py.File(result) as h5:
        f = h5["surface"].attrs["focal_length_m"]
        compare("facets", h5, feed_of(h5, corners, f), p, area, 1e-10)


Z = np.array([0, 0, 1.0])


def gain(feed, wavelength, p, area, s=Z):
    """Returns the gain in the direction s, in the polarisation along x by Ludwig's third definition, dBi."""
    N, scale = far_field(feed, wavelength, p, area, [s])
    return 10 * np.log10(scale * abs(N[0] @ (np.eye(3)[0] - s[0] / (1 + s[2]) * (s + Z))) ** 2)


def half_path(p, f):
    t2 = (p[:, 0] ** 2 + p[:, 1] ** 2) / (4 * f * f)
    return (p[:, 2] - t2 * f) / (1 + t2)


def frame(p, area, middle, q):
    """Returns the points in the frame of a fitted surface: turns q[0:2] about x, then y; shift q[2:5]."""
    (cx, sx), (cy, sy) = [(np.cos(a), np.sin(a)) for a in q[:2]]
    R = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]]) @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    return (p - middle - q[2:5]) @ R + middle, area @ R


def spread(e, w):
    return np.sqrt(w @ e**2 / w.sum() - (w @ e / w.sum()) ** 2)


def beam_of(feed, wavelength, p, area):
    """Returns the direction of the maximum, by parabolas through 9 directions around the best one so far."""
    best = np.zeros(2)
    for step in 1e-3 * 0.3 ** np.arange(12):
        a = np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1)]) * step + best
        g = [gain(feed, wavelength, p, area, np.append(q, np.sqrt(1 - q @ q))) for q in a]
        d = a - best
        A = np.stack([np.ones(9), d[:, 0], d[:, 1], d[:, 0] ** 2, d[:, 0] * d[:, 1], d[:, 1] ** 2], axis=1)
        c = np.linalg.lstsq(A / [1, step, step, step**2, step**2, step**2], g, rcond=None)[0]
        c /= [1, step, step, step**2, step**2, step**2]
        best = best - np.linalg.solve([[2 * c[3], c[4]], [c[4], 2 * c[5]]], c[1:3])
        if step < 1e-5:
            return best
    return best


def antenna(result, folder):
    x, corners = facets_in(folder)
    p, area = grid_of(x, corners)
    with h5py.File(result) as h5:
        f, g = h5["surface"].attrs["focal_length_m"], h5["surface/form"]
        feed = feed_of(h5, corners, f)
        smooth, below = grid_of(h5["scene/node/position_m"][:], corners)
        below[:, :2] = -smooth[:, :2] / (2 * f) * below[:, 2:]
        smooth[:, 2] = (smooth[:, :2] ** 2).sum(axis=1) / (4 * f)
        to = smooth - feed[0]
        rho = np.linalg.norm(to, axis=1)
        to /= rho[:, None]
        e = feed[2] - ((to @ feed[2]) / (1 + to @ feed[1]))[:, None] * (feed[1] + to)
        w = np.abs(np.cross(below, np.cross(to, e) * ((to @ feed[1]) ** feed[3] / rho)[:, None])[:, 0])
        middle, q = p.mean(axis=0), np.zeros(6)  # turns, shift, focal length
        errors = lambda q: half_path(frame(p, area, middle, q)[0], f + q[5])
        for _ in range(30):  # lengths of a shift across and a turn are nearly the same: the steps are damped a little
            r = errors(q)
            J = np.stack([(errors(q + d) - errors(q - d)) / 2e-6 for d in 1e-6 * np.eye(6)], axis=1)
            q = q - np.linalg.lstsq(np.sqrt(w)[:, None] * J, np.sqrt(w) * r, rcond=1e-13)[0]
        there, turned = frame(p, area, middle, q)
        focus = feed[0] + q[5] * Z
        axis = feed[1] * (((w @ smooth) / w.sum() - feed[0]) @ feed[1]) + (w @ (there - smooth)) / w.sum() - q[5] * Z
        axis /= np.linalg.norm(axis)
        co = feed[2] - (feed[2] @ axis) * axis
        refocused = (focus, axis, co / np.linalg.norm(co), feed[3])
        worst = np.zeros(3)
        for k, frequency in enumerate(h5["surface/frequency_Hz"][:]):
            wave = C / frequency
            ideal = gain(feed, wave, smooth, below)
            both = {"fixed": gain(feed, wave, p, area), "refocused": gain(refocused, wave, there, turned)}
            for name, mine in both.items():
                off = [mine - g[name + "_gain_dBi"][k], ideal - mine - g[name + "_gain_loss_dB"][k]]
                worst[0] = max(worst[0], np.abs(off).max())
            beam_deg = np.degrees(np.linalg.norm(beam_of(feed, wave, p, area)))
            worst[1] = max(worst[1], abs(beam_deg - g["pointing_deg"][k]))
        rms = [spread(half_path(p, f), w), spread(errors(q), w)]
        stored = [g.attrs[n + "_half_path_rms_m"] for n in ("fixed", "refocused")]
        worst[2] = np.abs(np.array(rms) / stored - 1).max()
        print(f"antenna: gains differ by {worst[0]:.1e} dB, pointing by {worst[1]:.1e} deg, errors by {worst[2]:.1e}")
        if not (worst < [1e-5, 1e-5, 1e-5]).all():
            sys.exit(1)


def points(result, folder):
    t = np.genfromtxt(f"{folder}/points.csv", delimiter=",", names=True, comments="#", skip_header=2)
    p = np.stack([t["x"], t["y"], t["z"]], axis=1)
    n = np.stack([t["nx"], t["ny"], t["nz"]], axis=1)
    assert np.abs(np.linalg.norm(n, axis=1) - 1).max() < 1e-14 and (n[:, 2] > 0).all()
    words = open(f"{folder}/facets.stl").read().split("vertex")[1:]
    tri = np.array([[float(c) for c in w.split()[:3]] for w in words]).reshape(-1, 3, 3)
    normal = np.cross(tri[:, 1] - tri[:, 0], tri[:, 2] - tri[:, 0]) / 2
    stated = np.array([l.split()[2:] for l in open(f"{folder}/facets.stl") if l.startswith("facet")], float)
    size = np.linalg.norm(normal, axis=1)
    assert (normal[:, 2] > 0).all() and np.abs(stated - normal / size[:, None]).max() < 1e-8
    with h5py.File(result) as h5:
        s = h5["surface"].attrs
        bent = s["mesh_tension_N_per_m"] > 0
        area = h5["surface/form"].attrs["facet_area_m2"]  # seen along z
        print(f"areas: {t['dA'].sum():.9f} m2 of points, {size.sum():.9f} m2 of triangles")
        assert abs(t["dA"].sum() / size.sum() - 1) < (1e-3 if bent else 1e-12)
        assert abs(normal[:, 2].sum() / area - 1) < 1e-9
        lines = open(f"{folder}/surface.grd").read().split("\n")
        low_x, low_y, high_x, high_y = map(float, lines[1].split())
        nx, ny, limit = map(int, lines[2].split())
        z = np.array(" ".join(lines[3:]).split(), float).reshape(ny, nx)
        assert limit == 0 and abs((high_x - low_x) / (nx - 1) - (high_y - low_y) / (ny - 1)) < 1e-12
        check_grid(z, np.linspace(low_x, high_x, nx), np.linspace(low_y, high_y, ny), tri, s["focal_length_m"], bent)
        now = h5["form/position_m"][:]
        corners = [int(np.argmin(np.abs(now - c).sum(axis=1))) for c in tri.reshape(-1, 3)]
        compare("points", h5, feed_of(h5, np.array(corners), s["focal_length_m"]), p, n * t["dA"][:, None], 1e-3)


def check_grid(z, x, y, tri, f, bent):
    """Checks each point against the plane of the triangle it is in, or against the target surface if it is in none."""
    X, Y = np.meshgrid(x, y)
    want, inside = (X**2 + Y**2) / (4 * f), np.zeros(X.shape, bool)
    for a, b, c in tri:
        det = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        ix = (x >= min(a[0], b[0], c[0])) & (x <= max(a[0], b[0], c[0]))
        iy = (y >= min(a[1], b[1], c[1])) & (y <= max(a[1], b[1], c[1]))
        part = np.ix_(iy, ix)
        px, py = X[part] - a[0], Y[part] - a[1]
        u = (px * (c[1] - a[1]) - py * (c[0] - a[0])) / det
        v = (py * (b[0] - a[0]) - px * (b[1] - a[1])) / det
        on = (u >= 0) & (v >= 0) & (u + v <= 1)
        want[part] = np.where(on, a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]), want[part])
        inside[part] |= on
    off = np.abs(z - want)
    print(f"grid: {inside.sum()} of {inside.size} points on facets, off by {off[inside].max():.1e} m at most, "
          f"{off[~inside].max():.1e} m beside them")
    assert 0.5 * inside.size < inside.sum() < inside.size
    assert off[inside].max() < (5e-3 if bent else 1e-9) and (off[inside].max() > 1e-5) == bent
    assert off[~inside].max() < 1e-9


if __name__ == "__main__":
    {"field": field, "points": points, "antenna": antenna}[sys.argv[1]](sys.argv[2], sys.argv[3])
