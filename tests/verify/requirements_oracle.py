"""Recomputes the verdict on every row of `requirements` of a result by numpy and scipy alone, from the samples and the
shapes in its file. Usage: requirements_oracle.py RESULT.h5

METHOD section 14 has the equations. Rows with a share come from /tolerance/load_case: margin, yield with the interval
of Clopper and Pearson, quantile, worst sample. Other rows come from the shapes and tensions of the result and of its
load cases. The best fit, the facets (triangles of the front cables), their converged quadrature and the physical optics
of a point feed at the focus (METHOD section 13) are the oracle's own. If load cases have errors of their own, the
oracle also draws all errors of the samples anew and solves their nets."""
import sys

import figures
import h5py
import numpy as np
import tolerance_oracle
import yaml
from scipy.optimize import least_squares, minimize
from scipy.stats import beta

SLACK = 1e-3  # of the maximum tension of the design, HF_SLACK_RATIO
TOLERANCE = 1e-9  # relative, of values
QUADRATURE = 5e-4  # of facets: the program has 3 x 3 points (METHOD section 9), which are 2.1e-4 off for the 6 m net
RADIO = 2e-4  # of gain losses and pointings, as below: 2e-5 dB and 2e-6 deg
COUNT = ("slack_cables", "loose_nodes")
OF_RADIO = ("gain_loss", "gain", "pointing")
LIGHT_M_PER_S = 299792458


def words(data_set):
    return [w.decode() if isinstance(w, bytes) else w for w in data_set[:]]


class Result:
    def __init__(self, file):
        self.file = file
        scene = file["scene"]
        self.end, self.group = scene["cable/end"][:], scene["cable/group"][:]
        self.EA = scene["cable/EA_N"][:]
        self.target, self.role = scene["node/position_m"][:], scene["node/role"][:]
        start, member = scene["set/start"][:], scene["set/cable"][:]
        self.set = {name: member[start[k]:start[k + 1]] for k, name in enumerate(words(scene["set/name"]))}
        self.set |= {"": np.arange(len(self.end)), "inner": np.flatnonzero(self.group == 0),
                     "boundary": np.flatnonzero(self.group == 1)}
        self.stage = next(file[s] for s in ("refine", "search", "form") if s in file)
        self.case = yaml.safe_load(file["case/text"][()].decode())
        self.states = ["nominal"]
        for row in self.case.get("load_cases", []):
            self.states += [row["name"]] * (row["name"] not in self.states)

    def shape(self, state):
        of = self.stage if state == "nominal" else self.file["load_cases"][state]
        return of["position_m"][:], of["tension_N"][:]

    def mass_per_length(self):
        mu = np.full(len(self.end), np.nan)
        for row in self.case["cables"]:
            if "mass_kg_per_m" in row:
                mu[self.set[row.get("set", "")]] = row["mass_kg_per_m"]
        return mu

    # ---- figures of a shape ----

    def pull(self, x, tension):
        d = x[self.end[:, 1]] - x[self.end[:, 0]]
        force = tension[:, None] * d / np.linalg.norm(d, axis=1)[:, None]
        sum_of = np.zeros_like(x)
        np.add.at(sum_of, self.end[:, 0], force)
        np.add.at(sum_of, self.end[:, 1], -force)
        return np.linalg.norm(sum_of[self.role == 0], axis=1).max()

    def is_slack(self, tension):
        return np.abs(tension) < SLACK * self.stage["tension_N"][:].max()

    def loose(self, tension):
        """Returns the free nodes at which no taut cable ends."""
        held = np.zeros(len(self.role), bool)
        held[self.end[~self.is_slack(tension)].ravel()] = True
        return ~held & (self.role != 0)

    def figure(self, row, state, is_minimum):
        x, tension = self.shape(state)
        cables, what = self.set[row["set"]], row["figure"]
        of_set = tension[cables]
        if what == "tension":
            return of_set.min() if is_minimum else of_set.max()
        if what == "ratio":
            return np.inf if self.is_slack(of_set.min()) else of_set.max() / of_set.min()
        if what == "slack_cables":
            return float(self.is_slack(of_set).sum())
        if what == "loose_nodes":
            return float(self.loose(tension).sum())
        if what == "pull":
            return self.pull(x, tension)
        if what == "mass":
            length = np.linalg.norm(x[self.end[:, 1]] - x[self.end[:, 0]], axis=1)
            return (self.mass_per_length() * length / (1 + tension / self.EA))[cables].sum()
        if what == "psi":
            counted = (self.role == 1) & ~self.loose(tension)
            return np.sqrt(((x - self.target)[counted] ** 2).sum(1).mean())
        if what == "deflection":
            assert state == "nominal", "the oracle does not know the truss alone"
            node, moved = self.file["coupling/node"][:], self.file["coupling/displacement_m"][:]
            rest = self.file["form/position_m"][:][node] - moved
            return np.linalg.norm(x[node] - rest, axis=1).max()
        if what in OF_RADIO:
            return self.radio(x, row)
        points, weight = (self.facet_points(x)[:2] if what == "facets"
                          else (x[self.role == 1], np.ones((self.role == 1).sum())))
        return self.half_path(points, weight, row["feed"] == "refocused")[0]

    # ---- surfaces: paraboloids z = (x^2 + y^2)/(4 f) ----

    def facet_points(self, x):
        """Returns points of quadrature on the triangles of the front cables, projected areas as weights, and the
        vectors of area."""
        near = {}
        for name, cables in self.set.items():
            for a, b in self.end[cables] if name.startswith("front") else []:
                near.setdefault(a, set()).add(b)
                near.setdefault(b, set()).add(a)
        rim = [a for a in near if self.role[a] == 0]  # straight lines between neighbouring supports close the rim
        middle = self.target[rim].mean(0)
        rim.sort(key=lambda a: np.arctan2(*(self.target[a] - middle)[:2]))
        for a, b in zip(rim, rim[1:] + rim[:1]):
            if near[a] & near[b]:
                near[a].add(b)
                near[b].add(a)
        corner = x[np.array([(a, b, c) for a in near for b in near[a] if a < b
                             for c in near[a] & near[b] if b < c])]
        at, w = np.polynomial.legendre.leggauss(5)
        u, v = np.meshgrid((at + 1) / 2, (at + 1) / 2)
        share, w = u.ravel(), np.outer(w, w).ravel() * u.ravel() / 2  # rule of Gauss collapsed at a corner
        b, c = share * (1 - v.ravel()), share * v.ravel()
        p = np.einsum("qk,tkc->tqc", np.stack([1 - b - c, b, c], axis=1), corner)
        e, g = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        up = np.cross(e, g) / 2
        up *= np.sign(up[:, 2:])
        return p.reshape(-1, 3), (up[:, 2:] * w).ravel(), (up[:, None, :] * w[:, None]).reshape(-1, 3)

    def half_path(self, p, weight, is_refocused):
        """Returns the RMS of the half-path errors, the points in the frame of the fitted surface, the rotation into
        this frame, and the focal length of the surface."""
        f = self.case["scene"]["paraboloid"]["focal_length_m"]
        root = np.sqrt(weight / weight.sum())
        middle = (p.max(0) + p.min(0)) / 2
        half_width = np.linalg.norm((p - middle)[:, :2], axis=1).max()

        def turn(q):
            (sa, sb), (ca, cb) = np.sin(q[:2]), np.cos(q[:2])
            return np.array([[cb, 0, sb], [0, 1, 0], [-sb, 0, cb]]) @ np.array([[1, 0, 0], [0, ca, -sa], [0, sa, ca]])

        def errors(q):
            """q: rotations about x and y, shift along z, relative focal length, shifts along x and y."""
            x, y, z = turn(q) @ (p - [q[4], q[5], q[2]]).T
            k = 1 / (4 * f * (1 + q[3]))
            return root * (z - k * (x**2 + y**2)) / (1 + 4 * k * k * (x**2 + y**2))

        if not is_refocused:
            return np.linalg.norm(errors(np.zeros(6))), p, np.eye(3), f
        best, options = np.zeros(6), {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15, "x_scale": "jac"}
        for n in (3, 4, 6):
            fit = least_squares(lambda q: errors(np.append(q, np.zeros(6 - n))), best[:n] + 1e-9 * (n == 6), **options)
            if n < 6 or np.hypot(*fit.x[4:]) < 0.1 * half_width:
                best = np.append(fit.x, np.zeros(6 - n))
        return (np.linalg.norm(errors(best)), (p - [best[4], best[5], best[2]]) @ turn(best).T, turn(best),
                f * (1 + best[3]))

    # ---- physical optics of a paraboloid with a point feed, by default at the focus, polarised along x ----

    def radio(self, x, row):
        f = self.case["scene"]["paraboloid"]["focal_length_m"]
        wave = 2 * np.pi * row["frequency_Hz"] / LIGHT_M_PER_S
        front = [self.end[cables].ravel() for name, cables in self.set.items() if name.startswith("front")]
        corner = self.target[np.unique(np.concatenate(front))]
        aim = (corner.max(0) + corner.min(0)) / 2
        aim[2] = aim[:2] @ aim[:2] / (4 * f)
        feed = np.array([0, 0, f])
        axis = (aim - feed) / np.linalg.norm(aim - feed)
        cosine = (corner - feed) @ axis / np.linalg.norm(corner - feed, axis=1)
        power = -0.5 * np.log(10) / np.log(cosine.min())  # 10 dB at the outermost corner
        along_x = np.array([1.0, 0, 0]) - axis[0] * axis
        along_x /= np.linalg.norm(along_x)

        def currents(p, up, feed, axis, along):
            t = p - feed
            path = np.linalg.norm(t, axis=1)
            t /= path[:, None]
            twist = t @ along / (1 + t @ axis)
            field = np.cross(t, along - twist[:, None] * (axis + t)) * ((t @ axis) ** power / path)[:, None]
            assert ((t * up).sum(1) < 0).all(), "a facet shows its back"
            return 2 * np.cross(up, field), path

        def field(s, p, current, path):
            co = np.array([1, 0, 0]) - s[0] / (1 + s[2]) * (s + [0, 0, 1])
            return (current @ co * np.exp(1j * wave * (p @ s - path))).sum()

        def dBi(p, up, *source):
            size = abs(field(np.array([0, 0, 1]), p, *currents(p, up, *source)))
            return 10 * np.log10((2 * power + 1) / 2 * size**2 * row["frequency_Hz"]**2 / LIGHT_M_PER_S**2)

        flat, _, up = self.facet_points(self.target)
        smooth = np.column_stack([flat[:, :2], (flat[:, :2] ** 2).sum(1) / (4 * f)])
        up_smooth = np.column_stack([-smooth[:, :2] / (2 * f) * up[:, 2:], up[:, 2]])
        weight = np.abs(currents(smooth, up_smooth, feed, axis, along_x)[0][:, 0])
        smooth_dBi = dBi(smooth, up_smooth, feed, axis, along_x)
        p, _, up = self.facet_points(x)
        if row["figure"] == "pointing":
            light = currents(p, up, feed, axis, along_x)

            def direction(q):
                return np.array([*q, np.sqrt(1 - q @ q)])

            best = minimize(lambda q: -np.log(abs(field(direction(q), p, *light))), np.zeros(2), method="Nelder-Mead",
                            options={"xatol": 1e-11, "fatol": 1e-16, "initial_simplex": [[0, 0], [1e-3, 0], [0, 1e-3]]})
            return np.degrees(np.arcsin(np.linalg.norm(best.x)))
        if row["feed"] == "refocused":
            _, moved, turn, focal = self.half_path(p, weight, True)
            p, up, longer = moved, up @ turn.T, focal - f
            mean = np.average(smooth, axis=0, weights=weight)
            to = (mean - feed) @ axis * axis + np.average(p, axis=0, weights=weight) - mean - [0, 0, longer]
            feed, axis = feed + [0, 0, longer], to / np.linalg.norm(to)
            along_x = along_x - along_x @ axis * axis
            along_x /= np.linalg.norm(along_x)
        gain = dBi(p, up, feed, axis, along_x)
        return gain if row["figure"] == "gain" else smooth_dBi - gain


# ---- verdicts ----

def scale_of(row, key):
    both = [row["at_least"], row["at_most"]]
    return abs(row[key]) if not np.isnan(both).any() and all(both) else 1


def said_margin(row, said, value):
    """Returns the margin that the program gives, in the terms of margin_of, and checks its distance from the bound."""
    key = "at_least" if said["bound"] == row["at_least"] else "at_most"
    assert said["margin"] == (value - said["bound"]) * (1 if key == "at_least" else -1), "margin and value"
    return said["margin"] / scale_of(row, key)


def margin_of(row, low, high):
    """Returns the margin of values of the columns of at_least and at_most, relative to the bounds if both are nonzero.
    No value has a margin of -inf."""
    above = (low - row["at_least"]) / scale_of(row, "at_least")
    below = (row["at_most"] - high) / scale_of(row, "at_most")
    margin = np.minimum(np.where(np.isnan(row["at_least"]), np.inf, above),
                        np.where(np.isnan(row["at_most"]), np.inf, below))
    has_no = (~np.isnan(row["at_least"]) & np.isnan(low)) | (~np.isnan(row["at_most"]) & np.isnan(high))
    return np.where(has_no, -np.inf, margin)


def states_of(result, row):
    return result.states if row["load_case"] == "all" else [row["load_case"]]


def column_name(row, is_minimum):
    name = row["figure"] + ({True: "_min", False: "_max"}[is_minimum] if row["figure"] == "tension" else "")
    name += "_" + row["feed"] if row["figure"] in ("surface", "facets", *OF_RADIO) else ""
    name += f"_{row['frequency_Hz'] / 1e9:.9g}GHz" if row["figure"] in OF_RADIO else ""
    return name + ("_" + row["set"] if row["set"] else "")


def judge_samples(result, row, said):
    columns = []
    for state in states_of(result, row):
        of = result.file["tolerance/load_case"][state]
        low, high = (of[column_name(row, k)][:] if not np.isnan(row[key]) else None
                     for k, key in ((True, "at_least"), (False, "at_most")))
        low, high = (high if low is None else low), (low if high is None else high)
        columns.append(margin_of(row, low, high))
    margin, share = np.min(columns, axis=0), row["share"]
    n, met = len(margin), int((margin >= 0).sum())
    low = beta.ppf(0.025, met, n - met + 1) if met else 0.0
    high = beta.ppf(0.975, met + 1, n - met) if met < n else 1.0
    verdict = ("pass" if low >= share else "fail" if high < share else "undecided")
    quantile = np.sort(margin)[min(int(np.floor((1 - share) * n + 1e-9)), n - 1)]
    assert (quantile >= 0) == (met >= share * n - 1e-9), "quantile and yield"
    assert said["verdict"] == verdict, (said["verdict"], verdict)
    assert said["yield"] == met / n and said_margin(row, said, said["value"]) == quantile
    assert np.allclose([said["yield_low"], said["yield_high"]], [low, high], rtol=1e-6, atol=1e-9)
    worst = int(np.argmin(margin))
    assert said["worst_sample"] == worst
    distance = [said["worst_value"] - row["at_least"], row["at_most"] - said["worst_value"]]
    assert said["worst_margin"] in distance and margin[worst] in (
        distance[0] / scale_of(row, "at_least"), distance[1] / scale_of(row, "at_most"))
    at = states_of(result, row)[int(np.argmin([c[worst] for c in columns]))]
    assert said["worst_load_case"] == at, (said["worst_load_case"], at)
    return quantile, 0.0


def count_slack(file):
    """Demands the counts over all load cases, if the samples have the slack cables of all of them."""
    of = file.get("tolerance/load_case", {})
    if not of or not all("slack_cables" in of[name] for name in of):
        return
    said = file["tolerance"].attrs
    slack = np.array([of[name]["slack_cables"][:] for name in of])
    assert said["n_sampled_load_case"] == len(of) - 1
    if len(of) > 1:
        assert said["n_with_slack_in_any"] == (np.nan_to_num(slack) > 0).any(0).sum(), said["n_with_slack_in_any"]
        assert said["n_failed_in_any"] == np.isnan(slack).any(0).sum(), said["n_failed_in_any"]
        print(f"{said['n_with_slack']} samples with slack cables, {said['n_with_slack_in_any']} in any load case")


def judge_nominal(result, row, said):
    margin = []
    for state in states_of(result, row):
        low, high = result.figure(row, state, True), result.figure(row, state, False)
        margin.append(float(margin_of(row, np.array(low), np.array(high))))
    least = min(margin)
    scale = max(abs(row["at_least"]) if not np.isnan(row["at_least"]) else 0, abs(said["value"]), 1e-300)
    off = abs(said_margin(row, said, said["value"]) - least) * scale_of(row, "at_most") / scale
    most = QUADRATURE if row["figure"] == "facets" else RADIO if row["figure"] in OF_RADIO else TOLERANCE
    assert off == 0 if row["figure"] in COUNT else off < most, (said["margin"], least)
    at = states_of(result, row)[int(np.argmin(margin))]
    ties = sorted(margin)[1] - least < 1e-9 * scale if len(margin) > 1 else False
    assert ties or said["worst_load_case"] == at, (said["worst_load_case"], at)
    error = 0 if np.isnan(said["error_bound"]) else said["error_bound"]
    assert abs(least) > error or row["figure"] in COUNT, "this row cannot be judged from its value"
    assert said["verdict"] == ("pass" if least >= 0 else "fail"), said["verdict"]
    return least, off


# ---- samples of load cases with errors ----

# key of `tolerance`, kind of random numbers, data set
LOAD_ERROR = (("sigma_load_case_temperature_K", 12, "temperature_error_K"),
              ("sigma_gravity_ratio", 13, "gravity_error_ratio"), ("sigma_force_ratio", 14, "force_error_ratio"))


def load_of(result, name, cut):
    """Returns the rise of temperature, the weights and the forces of a load case; None where it has none."""
    rise = weight = force = None
    for row in result.case["load_cases"]:
        if row["name"] != name:
            continue
        rise = row.get("temperature_K", rise)
        if "gravity_m_per_s2" in row:
            along = np.array(row.get("direction", [0, 0, -1]), float)
            half = result.mass_per_length() * cut / 2 * row["gravity_m_per_s2"]
            weight = np.zeros((len(result.role), 3))
            for end in (0, 1):
                np.add.at(weight, result.end[:, end], half[:, None] * along / np.linalg.norm(along))
        if "force_N" in row:
            assert row["role"] == "inner"
            force = np.where((result.role == 1)[:, None], row["force_N"], 0)
    return rise, weight, force


def draw_samples(result):
    """Demands the errors and the minimum tensions of samples in load cases."""
    errors = {key: float(value) for key, value in result.case["tolerance"].items()}
    of, n_sample = result.file["tolerance/load_case"], int(errors["samples"])
    assert set(errors) <= {key for key, _, _ in LOAD_ERROR} | {"sigma_cut_m", "samples"}, "other errors"
    alpha, worst = float(result.case["cables"][0]["expansion_per_K"]), 0.0
    length, tension = result.stage["length_m"][:], result.stage["tension_N"][:]
    cut = length / (1 + tension / result.EA)
    for k, name in enumerate(result.states):
        load, start = load_of(result, name, cut), result.shape(name)[0]
        has = [LOAD_ERROR[i][2] for i in range(3) if load[i] is not None and LOAD_ERROR[i][0] in errors]
        assert set(has) == {d for d in of[name] if "error" in d}, name
        for i in range(n_sample):
            own = np.array([tolerance_oracle.number(1, i, 0, e) for e in range(len(cut))])
            warmer, heavier, stronger = (
                0 if part is None or key not in errors else errors[key] * tolerance_oracle.number(1, i, kind, k - 1)
                for part, (key, kind, _) in zip(load, LOAD_ERROR))
            for d, value in zip((d for _, _, d in LOAD_ERROR), (warmer, heavier, stronger)):
                assert d not in has or abs(of[name][d][i] - value) < 1e-12 * max(1, abs(value)), (name, d, i)
            now = (cut + errors["sigma_cut_m"] * own) * (1 + alpha * ((load[0] or 0) + warmer))
            push = sum(part * (1 + error) for part, error in ((load[1], heavier), (load[2], stronger))
                       if part is not None)
            t = tolerance_oracle.solve(start.copy(), result.role != 0, result.end, now, result.EA, push)[1]
            worst = max(worst, abs(t.min() - of[name]["tension_min"][i]))
    figures.worst(worst, 1e-7, "minimum tensions of samples in load cases with errors, N")
    assert worst < 1e-7, worst
    print(f"{n_sample} samples in {len(result.states)} load cases: minimum tensions differ by {worst:.1e} N")


def main(path):
    worst, count = 0.0, {}
    with h5py.File(path) as file:
        result, of = Result(file), file["requirements"]
        if any(key in result.case.get("tolerance", {}) for key, _, _ in LOAD_ERROR):
            draw_samples(result)
        count_slack(file)
        table = {key: words(of[key]) if of[key].dtype.kind in "OS" else of[key][:].tolist() for key in of}
        for k in range(len(table["figure"])):
            said = {key: table[key][k] for key in table}
            row = {key: said[key] for key in ("figure", "set", "feed", "frequency_Hz", "load_case", "at_least",
                                              "at_most", "share")}
            judge = judge_nominal if np.isnan(row["share"]) else judge_samples
            margin, off = judge(result, row, said)
            bound = said["bound"]
            if np.isfinite(said["value"]):
                value = said["value"] - bound if bound == row["at_least"] else bound - said["value"]
                assert abs(value - said["margin"]) <= 1e-15 * abs(bound) + 1e-15, "value and margin"
            assert bound in (row["at_least"], row["at_most"])
            if bound != 0 and np.isfinite(margin):
                assert abs(said["relative_margin"] - said["margin"] / abs(bound)) < 1e-12
            else:
                assert not np.isfinite(said["relative_margin"])
            exact = row["figure"] not in (*OF_RADIO, "facets")
            worst, count[said["verdict"]] = max(worst, off * exact), count.get(said["verdict"], 0) + 1
            print(f"{said['verdict']:9}  {row['figure']:12} {row['set']:10} margin {margin:.6g}, differs by {off:.1e}")
    figures.worst(worst, TOLERANCE, "margins of nominal rows but those of facets, relative to their values")
    print(" ".join(f"{word} {count[word]}" for word in sorted(count)))


main(sys.argv[1])
