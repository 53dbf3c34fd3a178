#!/usr/bin/env python3
"""Oracle for generated nets and ring trusses, independent of the program: numpy and scipy, from the case file alone.

    generators_oracle.py CASE.yaml RESULT.h5

The case has scene.paraboloid (grid triangle, ties along z) with or without truss.ring, or scene.parabolic_cylinder with
a rear net, equal arcs, equal modules and no scallops. The script makes everything again that the generators make, and
compares it with the result: nodes by their names, cables by their ends, joints, members and their sections. For a ring
it solves one load case, the stored pull of the net, with its own dense stiffness matrix. It prints what it has
compared. An assertion fails if something differs.

The triangular grid is made from axial coordinates of a hexagonal lattice, and its plane balance from a dense solve."""
import sys

import figures
import h5py
import numpy as np
import yaml
from scipy.integrate import quad
from scipy.optimize import brentq

from coupled_oracle import beam

AROUND = [(-1, 1), (-1, 0), (0, -1), (1, -1), (1, 0), (0, 1)]  # axial steps along the six sides, from the corner at x


def words(data):
    return [w.decode() for w in data[:]]


def lattice(rings):
    """Returns the axial coordinates by name."""
    at = {"f0_0": (0, 0)}
    for ring in range(1, rings + 1):
        q, r = ring, 0
        for k in range(6 * ring):
            at[f"f{ring}_{k}"] = (q, r)
            dq, dr = AROUND[k // ring]
            q, r = q + dq, r + dr
        assert (q, r) == (ring, 0)
    return at


def plane_grid(p):
    """Returns positions in the plane of the aperture relative to its middle, cables, and the nodes on the rim."""
    N, R = p["rings"], p["aperture_m"] / 2
    at = lattice(N)
    rim = {name for name in at if name.startswith(f"f{N}_")}
    node = {v: k for k, v in at.items()}
    cables = set()
    for name, (q, r) in at.items():
        for dq, dr in AROUND:
            other = node.get((q + dq, r + dr))
            if other and not (name in rim and other in rim):
                cables.add(frozenset((name, other)))
    names = sorted(at)
    row = {name: i for i, name in enumerate(names)}
    L = np.zeros((len(names), len(names)))
    for a, b in (sorted(c) for c in cables):
        i, j = row[a], row[b]
        L[i, i] += 1
        L[j, j] += 1
        L[i, j] -= 1
        L[j, i] -= 1
    x = np.zeros((len(names), 2))
    for name in rim:
        angle = 2 * np.pi * int(name.split("_")[1]) / (6 * N)
        x[row[name]] = R * np.cos(angle), R * np.sin(angle)
    is_rim = np.array([name in rim for name in names])
    x[~is_rim] = np.linalg.solve(L[np.ix_(~is_rim, ~is_rim)], -L[np.ix_(~is_rim, is_rim)] @ x[is_rim])
    if p.get("spacing") == "equal_arc":
        arc = lambda r: quad(lambda s: np.hypot(1, s / (2 * p["focal_length_m"])), 0, r)[0]
        for i in np.flatnonzero(~is_rim):
            r = np.hypot(*x[i])
            if r > 1e-9:
                x[i] *= brentq(lambda s: arc(s) - r / R * arc(R), 0, R, xtol=1e-14) / r
    return {name: x[row[name]] for name in names}, cables, rim


def paraboloid(p):
    """Returns positions by name, cables as pairs of names, and supports."""
    f, R, off = p["focal_length_m"], p["aperture_m"] / 2, p.get("offset_m", 0)
    d, rear_f = p.get("rear_distance_m", 0), p.get("rear_focal_length_m", 0) or p["focal_length_m"]
    plane, cables, rim = plane_grid(p)
    z_rim = lambda x: (R * R - off * off + 2 * off * x) / (4 * f)  # the plane of the rim
    place, all_cables, supports = {}, set(cables), set(rim)
    for name, (u, v) in plane.items():
        x = u + off
        place[name] = (x, v, (x * x + v * v) / (4 * f))
        if d:
            place["r" + name[1:]] = (x, v, z_rim(x) - d + (R * R - u * u - v * v) / (4 * rear_f))
    if d:
        supports |= {"r" + name[1:] for name in rim}
        all_cables |= {frozenset("r" + name[1:] for name in c) for c in cables}
        all_cables |= {frozenset((name, "r" + name[1:])) for name in plane if name not in rim}
    return place, all_cables, supports


def cylinder(c):
    f, a, d = c["focal_length_m"], c["aperture_m"] / 2, c["rear_distance_m"]
    rear_f = c.get("rear_focal_length_m", 0) or f
    nx, ny = (m * n for m, n in zip(c["modules"], c["cells_per_module"]))
    assert c["supports"] == "perimeter" and c["pattern"] == "alternating"
    arc = lambda x: quad(lambda s: np.hypot(1, s / (2 * f)), 0, x)[0]
    xs = [brentq(lambda x: arc(x) - (2 * i / nx - 1) * arc(a), -a, a, xtol=1e-14) for i in range(nx + 1)]
    front_z, rear_z = (lambda x: x * x / (4 * f)), (lambda x: a * a / (4 * f) - d + (a * a - x * x) / (4 * rear_f))
    place, cables, supports = {}, set(), set()
    edge = lambda i, j: i in (0, nx) or j in (0, ny)
    for i in range(nx + 1):
        for j in range(ny + 1):
            x, y = xs[i], c["length_m"] * j / ny
            place[f"n{i}_{j}"] = (x, y, front_z(x))
            if c.get("tie_direction", "z") == "normal":
                along = lambda t: (x + t * x / (2 * f), front_z(x) - t)
                t = brentq(lambda t: along(t)[1] - rear_z(along(t)[0]), 0, 2 * d)
                place[f"r{i}_{j}"] = (along(t)[0], y, along(t)[1])
            else:
                place[f"r{i}_{j}"] = (x, y, rear_z(x))
            if edge(i, j):
                supports |= {f"n{i}_{j}", f"r{i}_{j}"}
            else:
                cables.add(frozenset((f"n{i}_{j}", f"r{i}_{j}")))
    for i in range(nx + 1):
        for j in range(ny + 1):
            falls = (i + j) % 2
            steps = [((i, j), (i + 1, j)), ((i, j), (i, j + 1)), ((i + falls, j), (i + 1 - falls, j + 1))]
            for k, (p, q) in enumerate(steps):
                if max(p[0], q[0]) > nx or max(p[1], q[1]) > ny or (k == 2 and i == nx) or (edge(*p) and edge(*q)):
                    continue
                for net in "nr":
                    cables.add(frozenset((f"{net}{p[0]}_{p[1]}", f"{net}{q[0]}_{q[1]}")))
    return place, cables, supports


def compare_net(h, place, cables, supports):
    ids, x = words(h["scene/node/id"]), h["scene/node/position_m"][:]
    assert sorted(ids) == sorted(place)
    off = max(np.abs(x[i] - place[name]).max() for i, name in enumerate(ids))
    assert off < 1e-10, off
    ends = h["scene/cable/end"][:]
    found = {frozenset((ids[a], ids[b])) for a, b in ends}
    assert len(found) == len(ends) and found == cables
    assert words(h["scene/cable/id"]) == [f"{ids[a]}-{ids[b]}" for a, b in ends]
    role = h["scene/node/role"][:]
    assert {name for name, r in zip(ids, role) if r == 0} == supports
    assert all(r == (1 if name[0] in "fn" else 2) for name, r in zip(ids, role) if name not in supports)
    length = np.array([np.linalg.norm(np.subtract(place[ids[a]], place[ids[b]])) for a, b in ends])
    assert np.abs(h["scene/cable/length_m"][:] - length).max() < 1e-10
    print(f"net: {len(ids)} nodes, {len(ends)} cables, {len(supports)} supports, farthest node {off:.1e} m")


def ring(p, t):
    """Returns joints, members as name -> (ends, unit, diameter, wall), and held joints."""
    N, R, off, f = p["rings"], p["aperture_m"] / 2, p.get("offset_m", 0), p["focal_length_m"]
    r, n = t["ring"], 6 * p["rings"]
    step, height = r.get("cells_per_bay", 1), p.get("rear_distance_m") or r["height_m"]
    joints, members = {}, {}
    for k in range(n):
        x, y = off + R * np.cos(2 * np.pi * k / n), R * np.sin(2 * np.pi * k / n)
        joints[f"f{k}"] = (x, y, (x * x + y * y) / (4 * f))
        joints[f"r{k}"] = (x, y, (x * x + y * y) / (4 * f) - height)

    def add(a, b, unit, diameter):
        tube = r.get(unit, {})
        members[f"{a}-{b}"] = (a, b, unit, tube.get("diameter_m", diameter), tube.get("wall_m", 0.001))

    for k in range(n):
        add(f"f{k}", f"f{(k + 1) % n}", "longeron", 0.03)
        add(f"r{k}", f"r{(k + 1) % n}", "longeron", 0.03)
    for bay in range(n // step):
        a, b = bay * step, (bay + 1) * step % n
        add(f"f{a}", f"r{a}", "vertical", 0.03)
        assert r.get("bracing", "single") == "single"
        if bay % 2 == 0:
            add(f"f{a}", f"r{b}", "diagonal", 0.02)
        else:
            add(f"r{a}", f"f{b}", "diagonal", 0.02)
    assert r.get("held", "bay") == "bay" and "held_at_deg" not in r
    middles = {bay: 360 / (n // step) * (bay + 0.5) for bay in range(n // step)}
    bay = min(middles, key=lambda b: (round(abs(middles[b] - 180), 6), b))
    held = {f"{side}{k % n}" for side in "fr" for k in (bay * step, (bay + 1) * step)}
    return joints, members, held, {f"{side}{k}" for side in "fr" for k in range(0, n, step)}


def compare_ring(h, p, t):
    joints, members, held, hinges = ring(p, t)
    ids, x = words(h["truss/node/id"]), h["truss/node/position_m"][:]
    assert sorted(ids) == sorted(joints)
    assert max(np.abs(x[i] - joints[name]).max() for i, name in enumerate(ids)) < 1e-10
    fixed, mass = h["truss/node/fixed"][:], h["truss/node/mass_kg"][:]
    assert {name for name, row in zip(ids, fixed) if row.any()} == held and fixed.sum() == 6 * len(held)
    assert all(m == (t.get("hinge_mass_kg", 1) if name in hinges else 0) for name, m in zip(ids, mass))
    names, ends = words(h["truss/member/id"]), h["truss/member/end"][:]
    kinds = h5py.check_enum_dtype(h["truss/member/unit"].dtype)
    assert sorted(names) == sorted(members)
    E, G = float(t.get("E_Pa", 130e9)), float(t.get("G_Pa", 5e9))
    K = np.zeros((6 * len(ids), 6 * len(ids)))
    total = 0.0
    for e, name in enumerate(names):
        a, b, unit, diameter, wall = members[name]
        assert [ids[k] for k in ends[e]] == [a, b] and h["truss/member/unit"][e] == kinds[unit]
        A = np.pi * wall * (diameter - wall)
        I = np.pi / 64 * (diameter**4 - (diameter - 2 * wall) ** 4)
        assert abs(h["truss/member/A_m2"][e] / A - 1) < 1e-12 and abs(h["truss/member/Iy_m4"][e] / I - 1) < 1e-11
        xa, xb = np.array(joints[a]), np.array(joints[b])
        total += A * np.linalg.norm(xb - xa) * float(t.get("density_kg_per_m3", 1600))
        dofs = np.r_[6 * ends[e][0] : 6 * ends[e][0] + 6, 6 * ends[e][1] : 6 * ends[e][1] + 6]
        K[np.ix_(dofs, dofs)] += beam(xa, xb, E, G, A, I, I, 2 * I)
    assert abs(h["truss"].attrs["mass_kg"] / (total + mass.sum()) - 1) < 1e-12
    # each rim hangs on its ring
    net, of = h["truss/attachment/net_node"][:], h["truss/attachment/truss_node"][:]
    net_ids = words(h["scene/node/id"])
    assert [net_ids[i][0] + net_ids[i].split("_")[1] for i in net] == [ids[k] for k in of]
    # the pull of the net, and what the truss does under it
    y, q, end = h["form/position_m"][:], h["form/q_N_per_m"][:], h["scene/cable/end"][:]
    pull = np.zeros_like(y)
    np.add.at(pull, end[:, 0], q[:, None] * (y[end[:, 1]] - y[end[:, 0]]))
    np.add.at(pull, end[:, 1], q[:, None] * (y[end[:, 0]] - y[end[:, 1]]))
    load = np.zeros((len(ids), 6))
    load[of, :3] = pull[net]
    moves = ~np.repeat([name in held for name in ids], 6)
    u = np.zeros(6 * len(ids))
    u[moves] = np.linalg.solve(K[np.ix_(moves, moves)], load.ravel()[moves])
    reaction = (K @ u - load.ravel()).reshape(-1, 6)
    stored, stored_reaction = h["truss/node/displacement"][:], h["truss/node/reaction"][:]
    off = np.abs(u.reshape(-1, 6) - stored)[:, :3].max() / np.abs(stored[:, :3]).max()
    assert off < 1e-7, off
    figures.worst(off, 1e-7, f"ring of {len(ids)} joints: displacements, in parts of the largest")
    off_reaction = np.abs(reaction * fixed - stored_reaction).max() / np.abs(stored_reaction).max()
    figures.worst(off_reaction, 1e-7, f"ring of {len(ids)} joints: reactions, in parts of the largest")
    assert off_reaction < 1e-7, off_reaction
    force = load[:, :3].sum(0) + stored_reaction[:, :3].sum(0)
    moment = np.cross(x, load[:, :3] + stored_reaction[:, :3]).sum(0) + stored_reaction[:, 3:].sum(0)
    pulls = np.linalg.norm(load[:, :3], axis=1).sum()
    assert np.abs(force).max() < 1e-9 * pulls and np.abs(moment).max() < 1e-8 * pulls * p["aperture_m"]
    print(
        f"ring: {len(ids)} joints, {len(names)} members, {total + mass.sum():.3f} kg; displacements differ by "
        f"{off:.1e}, "
        f"reactions by {off_reaction:.1e}; out of balance {np.abs(force).max() / pulls:.1e}, moment "
        f"{np.abs(moment).max() / (pulls * p['aperture_m']):.1e}"
    )


def main(case, result):
    with open(case, encoding="utf-8") as file:
        c = yaml.safe_load(file)
    with h5py.File(result, "r") as h:
        scene = c["scene"]
        is_round = "paraboloid" in scene
        compare_net(h, *(paraboloid(scene["paraboloid"]) if is_round else cylinder(scene["parabolic_cylinder"])))
        if "truss" in c:
            compare_ring(h, scene["paraboloid"], c["truss"])


if __name__ == "__main__":
    main(*sys.argv[1:])
