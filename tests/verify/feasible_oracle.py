#!/usr/bin/env python3
"""Oracle for the warnings about limits that no design at the target positions can meet: the simplex method of scipy.

    feasible_oracle.py HIFDM NETS [SEED]

The script makes NETS random double nets that are prestressed at their target positions, with random design variables
and limits. `hifdm check` must warn if and only if no tensions in the reach of the variables hold the net and meet all
limits. A limit named alone must have no such tensions even alone, and its best value must be that of the programme.
Limits that are named together must each have some. A pretension that is advised must end the warnings. The exit status
is 0 if all of this holds."""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np
from prestress_oracle import equations, net
from scipy.optimize import linprog

NONE_KNOWN = 3e-5  # amounts below it, over the tensions, are left to rounding
SETS = ("front", "rear", "tie")
CASE = """scene: {import: {nodes: n.csv, cables: c.csv}}
form: {prestress: exact, pretension_N: 10}
optimize:
  method: lm
  refine_steps: 1
  variables:
"""


def write(folder, rng, x, fixed, ends):
    """Writes a case; returns the set of each cable, the range of each, and the limits (set, lower, upper, ratio)."""
    n = len(x) // 2
    of = np.array(["tie" if b - a == n else "front" if b < n else "rear" for a, b in ends])
    (folder / "n.csv").write_text("id,x_m,y_m,z_m,role\n" + "".join(
        f"n{k},{p[0]:.17g},{p[1]:.17g},{p[2]:.17g},{'support' if f else 'inner'}\n"
        for k, (p, f) in enumerate(zip(x, fixed))))
    (folder / "c.csv").write_text("id,i,j,group,law,value,set\n" + "".join(
        f"c{k},n{a},n{b},inner,tension,,{s}\n" for k, ((a, b), s) in enumerate(zip(ends, of))))
    varied = [s for s in SETS if rng.random() < 0.8] or ["tie"]
    reach = {s: round(rng.uniform(5, 60)) / 100 if s in varied else 0 for s in SETS}
    text = CASE + "".join(f"    - {{set: {s}, vary: force_density, range: {100 * reach[s]:.0f} %}}\n" for s in varied)
    (folder / "case.yaml").write_text(CASE.partition("optimize")[0])  # for its tensions alone
    return of, np.array([reach[s] for s in of]), text


def limits_of(rng, of, T, A, low, high):
    limits = []
    if rng.random() < 0.25:  # each within reach, but close to its best value, and so hardly together
        s, t = rng.permutation(SETS)[:2]
        most = T.max() - loosened(A, T, low, high, of, [(s, T.max(), np.inf, np.inf)])
        least = loosened(A, T, low, high, of, [(t, -np.inf, 0, np.inf)])
        limits = [(s, 0.98 * most, np.inf, np.inf), (t, -np.inf, 1.02 * least, np.inf)]
        return [(s, float(f"{a:.6g}"), float(f"{b:.6g}"), r) for s, a, b, r in limits]
    for s in rng.permutation(SETS)[:rng.integers(1, 4)]:
        low, high = T[of == s].min(), T[of == s].max()
        if rng.random() < 0.3:
            limits.append((s, -np.inf, np.inf, 1.001 + rng.uniform(0.3, 1.2) * (high / low - 1)))
        else:
            lower = low * rng.uniform(0.6, 1.5) if rng.random() < 0.7 else -np.inf
            upper = high * rng.uniform(0.7, 1.4) if rng.random() < 0.7 or lower < 0 else np.inf
            limits.append((s, lower, max(upper, 1.01 * lower), np.inf))
    return [(s, float(f"{a:.6g}"), float(f"{b:.6g}"), float(f"{r:.6g}")) for s, a, b, r in limits]


def write_limits(folder, text, limits):
    number = lambda v: "null" if np.isinf(v) else f"{v:.6g}"
    (folder / "case.yaml").write_text(text + "  limits:\n" + "".join(
        f"    - {{figure: ratio, set: {s}, bounds: [1, {r:.6g}]}}\n" if np.isfinite(r) else
        f"    - {{figure: tension, set: {s}, bounds: [{number(a)}, {number(b)}]}}\n" for s, a, b, r in limits))


def loosened(A, T, low, high, of, limits):
    """The minimum amount by which all limits must be loosened."""
    n, rows, right = len(T), [], []
    width = n + 1 + len(limits)
    def add(sign, e, bound, k=None, by=0.0):
        row = np.zeros(width)
        row[e], row[n] = -sign, -1
        if k is not None: row[n + 1 + k] = -by
        rows.append(row)
        right.append(-bound)
    for k, (s, a, b, r) in enumerate(limits):
        for e in np.flatnonzero(of == s):
            if np.isfinite(a): add(1, e, a)
            if np.isfinite(b): add(-1, e, -b)
            if np.isfinite(r): add(1, e, 0, k, -1); add(-1, e, 0, k, r)
    return minimum(np.r_[np.zeros(n), 1, np.zeros(len(limits))], rows, right, A, T, low, high, 1 + len(limits))


def minimum(cost, rows, right, A, T, low, high, n_more):
    bounds = [*zip(low, high)] + [(-1e3, 1e3)] * n_more
    bounds[len(T)] = (0, 1e3)
    answer = linprog(cost, np.array(rows), right, np.c_[A, np.zeros((len(A), n_more))], A @ T, bounds, "highs-ds")
    return answer.fun if answer.status == 0 else np.nan


def least_ratio(A, T, low, high, of, s, ratio):
    """The minimum ratio of a set, by bisection."""
    least, most = ratio, T[of == s].max() / T[of == s].min()
    for _ in range(40):
        middle = (least + most) / 2
        missed = loosened(A, T, low, high, of, [(s, -np.inf, np.inf, middle)]) > 1e-9
        least, most = (middle, most) if missed else (least, middle)
    return most


def check(program, folder, *more):
    run = subprocess.run([program, "check", "case.yaml", *more], cwd=folder, capture_output=True, text=True)
    lines = [line for line in run.stderr.splitlines() if "no design at the target positions" in line]
    return run, lines


def judge(program, folder, rng, x, fixed, ends):
    """Returns what is wrong, or None, and the kind of the case."""
    of, reach, text = write(folder, rng, x, fixed, ends)
    run = subprocess.run([program, "run", "case.yaml", "-o", "r.h5", "--restart"], cwd=folder, capture_output=True,
                         text=True)
    if "no tensions above zero" in run.stderr: return None, "not held"
    with h5py.File(folder / "r.h5") as file: T = file["form/tension_N"][:]
    A, low, high = equations(x, fixed, ends), T * (1 - reach), T * (1 + reach)
    limits = limits_of(rng, of, T, A, low, high)
    write_limits(folder, text, limits)
    run, said = check(program, folder)
    if run.returncode: return f"exit status {run.returncode}: {run.stderr}", "?"
    amount = loosened(A, T, low, high, of, limits)
    if not amount >= 0 or 0 < amount < NONE_KNOWN * T.max(): return None, "unknown"
    if bool(said) != (amount > 0): return f"loosened by {amount}, but: {said}", "?"
    for line in said:
        wrong = judge_line(line, A, T, low, high, of, limits, amount)
        if wrong: return wrong, "?"
    advised = re.search(r"form.pretension_N to ([0-9.e+-]+) N", "".join(said))
    if advised:
        again = check(program, folder, "--set", f"form.pretension_N={advised[1]}")[1]
        if again: return f"in spite of the advice: {again}", "?"
    kind = "met" if not said else "together" if "together" in said[0] else "alone"
    return None, kind + (", advised" if advised else "")


def judge_line(line, A, T, low, high, of, limits, amount):
    if "together" in line:
        found = float(re.search(r"loosened by ([0-9.e+-]+) N", line)[1])
        if abs(found - amount) > 0.006 * amount + 1e-6 * T.max(): return f"{found} beside {amount}: {line}"
        for row in limits:
            s, lower, upper, ratio = row
            for side in (s, lower, np.inf, np.inf), (s, -np.inf, upper, np.inf), (s, -np.inf, np.inf, ratio):
                if np.isfinite(side[1:]).any() and loosened(A, T, low, high, of, [side]) > NONE_KNOWN * T.max():
                    return f"{side} cannot be met alone: {line}"
        return None
    found = re.search(
        r"limits\.(\d+): .*\(tension (ratio )?of \w+ at (least|most) .*\)\. There, .* is at \w+ ([0-9.e+-]+)", line)
    if not found: return f"no figure: {line}"
    row, kind, side, best = found.groups()
    s, lower, upper, ratio = limits[int(row)]
    if kind:
        right = least_ratio(A, T, low, high, of, s, ratio)
    elif side == "least":
        right = lower - loosened(A, T, low, high, of, [(s, lower, np.inf, np.inf)])
    else:
        right = upper + loosened(A, T, low, high, of, [(s, -np.inf, upper, np.inf)])
    is_met = right >= lower if side == "least" and not kind else right <= (ratio if kind else upper)
    if is_met: return f"it can be met, {right}: {line}"
    off = (right - float(best)) * (1 if side == "least" and not kind else -1) / right  # rounded to the safe side
    return None if -1e-5 < off < 1.1e-3 else f"{right} beside {best}: {line}"


def main():
    program, n = str(Path(sys.argv[1]).resolve()), int(sys.argv[2])
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    kinds, n_wrong = {}, 0
    with tempfile.TemporaryDirectory() as folder:
        for k in range(n):
            rng = np.random.default_rng([seed, k])
            x, fixed, ends, _ = net(rng)
            wrong, kind = judge(program, Path(folder), rng, x, fixed, ends)
            kinds[kind] = kinds.get(kind, 0) + 1
            if wrong: print(f"net {k} of seed {seed}: {wrong}", file=sys.stderr)
            n_wrong += wrong is not None
    print(f"{n} nets: {n_wrong} wrong; " + ", ".join(f"{v} {k}" for k, v in sorted(kinds.items())))
    return n_wrong > 0


if __name__ == "__main__":
    sys.exit(main())
