#!/usr/bin/env python3
"""Searches for the paper's net at the paper's own stop (RMS change below 0.001 mm), among quad nets whose edge hangs on
short ties.

    dense.py --program build/hifdm --work build/paper-search     # writes results/chen2022/dense.csv, dense-truss.csv

1. Focal length and scallop of every net are solved for 6.6 mm and 4.8445.
2. The tensions of each net found are solved anew, as the genetic algorithm does with its first individual.
3. The genetic algorithm, 50 x 400 within 1 N, `rule: seeded`, on the nets near the paper's figures.
4. Around the best of these nets, ties in small steps go through stages 1 to 3.
5. The iterative force density method, and two readings of the truss, on the nets closest to the paper.
6. The net with the smallest misfit on other trusses.

Each round is kept in WORK/dense.json, and a search that was stopped resumes there. dense.csv has one row per net,
dense-truss.csv one row per truss."""
import argparse
import csv
import itertools
import json
import os

import h5py
import numpy as np

from kept import export, on_truss
from runs import DENSE_CSV, DENSE_TRUSS_CSV, NET, TRUSS, Runs, words
from search import KEY, PSI_M, RATIO, TRUSS_PSI_M, scene, solve

NEAR = 0.002  # how closely focal length and scallop are solved for PSI_M and RATIO
STOP = {"method": "hifdm", "pretension_N": 10, "stop": "rms_change"}  # form-finding as in the paper
FOCAL_M, SCALLOP = (12.0, 500.0), (0.003, 0.16)
EARLY = 1.0025  # a stop with a larger inner ratio is at an earlier turning point of psi, on another branch
ASIDE = ((1.02, 1.0), (0.96, 1.03), (1.1, 0.97), (0.88, 1.06), (1.25, 0.94), (0.75, 1.1))  # from an early stop
ROUNDS, START, AGAIN = 32, (1 / 70.0**2, 0.027), (1 / 50.0**2, 0.038)
TIES_M = (0.06, 0.1, 0.15, 0.2, 0.3)
STEP_M, STEPS, NEIGHBOURS, KEPT = 0.01, 4, 24, 24
# The eight figures: what the paper prints, and the difference that counts as met. 8.38 mm is solved for.
FIGURES = {"psi_mm": (6.6, 0.132), "inner": (1.0011, 0.0002), "boundary": (4.8445, 0.097), "ga_psi_mm": (4.3, 0.086),
           "ga_inner": (1.001, 0.0005), "ga_boundary": (5.608, 0.112), "truss_inner": (1.0372, 0.0075),
           "truss_boundary": (5.5898, 0.112)}
CAP = 10  # of a term of the misfit
# Trusses for the best net: depths, intervals of main units, supports, and tubes that are wider or thinner.
TRUSSES = ((0.3, 1, 3), (1, 2, 4), ("central_module_rear", "central_module"),
           (("as in chen2022-truss", ()), ("wide bud", (("bud.diameter_m", 0.06),)),
            ("thin bud", (("bud.wall_m", 2e-4),)), ("wide mbug", (("mbug.diameter_m", 0.06),)),
            ("thin mbug and abug", (("mbug.wall_m", 2e-4), ("abug.wall_m", 2e-4)))))
TRUSS_COLUMNS = ["depth_m", "main_every", "supports", "tubes", "E_GPa", "psi_mm", "inner", "boundary", "loops"]
NAMES = ("pattern", "supports", "modules", "cells", "spacing", "tie_m")
COLUMNS = ["modules", "cells", "spacing", "tie_m", "status", "focal_length_m", "scallop", *list(FIGURES)[:3],
           "anew_psi_mm", "anew_boundary", *list(FIGURES)[3:6], "fdm", "fdm_inner_mm", "fdm_edge_mm", "truss_E_GPa",
           "truss_psi_mm", *list(FIGURES)[6:], "loops", "form_E_GPa", "form_psi_mm", "form_inner", "form_boundary",
           "form_loops", "met", "misfit"]
GA = {"rule": "seeded", "population": 50, "generations": 400, "range_N": 1, "seed": 2022,
      "stagnation_generations": 400, "refine": False}


def net(modules, cells, spacing, tie_m):
    return ("quad", "module_corners", list(modules), list(cells), spacing, tie_m)


def nets():
    """Yields the nets of the first stage. Without ties, only nets with at most one inner cable per edge can hold at
    equal tensions (Fig. 3)."""
    for spacing, mx, my in itertools.product(("equal_arc", "equal_projected"), range(6, 13), range(6, 11)):
        for cells, tie in itertools.product(((3, 2), (2, 3), (2, 2), (3, 3), (4, 2), (2, 4)), TIES_M):
            yield net((mx, my), cells, spacing, tie)
        for cells in ((2, 2), (2, 1), (1, 2)):
            yield net((mx, my), cells, spacing, 0)


def label(n):
    return f"{n[2][0]}x{n[2][1]} of {n[3][0]}x{n[3][1]} {n[4]} {n[5]:g}"


def rounded(at):
    """Returns focal length and scallop of a point (1/f^2, scallop), with the digits that are stored."""
    return float(f"{at[0] ** -0.5:.5g}"), float(f"{at[1]:.5g}")


def room(n):
    """Returns the largest scallop whose edges stay clear of the next nodes."""
    _, _, modules, cells, _, _ = n
    span, pitch = [(10, 12)[k] / modules[k] for k in (0, 1)], [(10, 12)[k] / modules[k] / cells[k] for k in (0, 1)]
    return min([SCALLOP[1]] + [0.8 * pitch[1 - k] / span[k] for k in (0, 1) if cells[k] > 1])


class Root:
    """Solves for 6.6 mm and 4.8445 by Broyden's method in 1/f^2 and scallop, in which both figures are nearly
    linear."""

    def __init__(self, n, start=START):
        self.net, self.top, self.starts = n, 0.9 * room(n), [start, AGAIN]
        self.begin()

    def begin(self):
        w, s = self.starts.pop(0)
        s = min(s, 0.7 * self.top)
        self.status, self.seen, self.n_out, self.n_early, self.n_step = "", [], 0, 0, 0
        self.queue = [(w, s), (1.4 * w, s), (w, 1.3 * s)]

    def take(self, at, *figures):
        """Adds the figures of a point, and queues the next point or sets the status. A failure starts once more."""
        self.judge(at, *figures)
        if self.status and self.status != "found" and self.starts:
            self.begin()

    def judge(self, at, psi_m, ratio, inner):
        if np.isfinite(psi_m) and inner > EARLY and self.n_early < len(ASIDE):
            self.queue.insert(0, tuple(np.multiply(at, ASIDE[self.n_early])))
            self.n_early += 1
            return
        if not np.isfinite(psi_m) or inner > EARLY:
            self.status = "no shape" if not np.isfinite(psi_m) else "early stop"
            return
        x, y = np.array(at), np.array([psi_m / PSI_M - 1, ratio / RATIO - 1])
        if np.abs(y).max() < NEAR:
            self.status, self.found = "found", rounded(at)
            return
        self.seen.append((x, y))
        self.n_early, self.n_step = 0, self.n_step + 1
        if len(self.seen) < 3:
            return
        if self.n_step > 12:
            self.status = "no convergence"
            return
        if len(self.seen) == 3:
            (x0, y0), (x1, y1), (x2, y2) = self.seen
            dX = np.column_stack([x1 - x0, x2 - x0])
            if abs(np.linalg.det(dX)) < 1e-14:
                self.status = "no step"
                return
            self.J = np.column_stack([y1 - y0, y2 - y0]) @ np.linalg.inv(dX)
            x, y = min(self.seen, key=lambda p: np.abs(p[1]).max())
        else:
            xb, yb = self.last
            d, scale = x - xb, np.array([1e-4, 1e-2]) ** -2
            self.J += np.outer(y - yb - self.J @ d, scale * d) / (d @ (scale * d))
        if abs(np.linalg.det(self.J)) < 1e-3:
            self.status = "no step"
            return
        step = np.clip(-np.linalg.solve(self.J, y), [-0.8 * x[0], -0.5 * x[1]], [2 * x[0], x[1]])
        at = np.clip(x + step, [FOCAL_M[1] ** -2, SCALLOP[0]], [FOCAL_M[0] ** -2, self.top])
        self.n_out = self.n_out + 1 if np.any(at != x + step) else 0
        if self.n_out > 2 or np.all(at == x):
            self.status = "out of range"
            return
        self.last = (x, y)
        self.queue.append(tuple(at))


class Search:
    def __init__(self, runs):
        self.runs, self.path = runs, os.path.join(runs.work, "dense.json")
        self.rows = {}
        if os.path.exists(self.path):
            with open(self.path) as file:
                self.rows = json.load(file)
        self.form = runs.case("dense-form", NET, drop=["optimize"], form=STOP)
        self.anew = runs.case("dense-anew", NET, form=STOP, optimize=GA | {"range_N": 1e-9, "generations": 1})
        self.ga = runs.case("dense-ga", NET, form=STOP, optimize=GA)

    def save(self):
        with open(self.path + ".part", "w") as file:
            json.dump(self.rows, file)
        os.replace(self.path + ".part", self.path)

    def roots(self, every, starts=None):
        """Solves for focal length and scallop of all nets that have no row."""
        every = [n for n in every if label(n) not in self.rows]
        for k in range(0, len(every), 500):
            roots = [Root(n, (starts or {}).get(label(n), START)) for n in every[k:k + 500]]
            for _ in range(ROUNDS):
                points = [(r, r.queue.pop(0)) for r in roots if not r.status and r.queue]
                if not points:
                    break
                table = solve(self.runs, "dense-root", self.form, [scene(r.net, *rounded(at)) for r, at in points])
                for i, (r, at) in enumerate(points):
                    if not r.status:
                        r.take(at, *(table[f"form/{name}"][i] for name in
                                     ("psi_m", "boundary_tension_ratio", "inner_tension_ratio")))
                        if r.status == "found":
                            r.figures = [float(table[f"form/{name}"][i]) for name in
                                         ("psi_m", "inner_tension_ratio", "boundary_tension_ratio")]
            for r in roots:
                row = dict(zip(NAMES, r.net)) | {"status": r.status or "no convergence"}
                if r.status == "found":
                    row |= dict(zip(("focal_length_m", "scallop"), r.found))
                    row |= {"psi_mm": 1e3 * r.figures[0], "inner": r.figures[1], "boundary": r.figures[2]}
                self.rows[label(r.net)] = row
            self.save()

    def stage(self, name, case, missing, rows, figures, share=100):
        """Runs a case on all rows without the key `missing` and stores figures of the search."""
        rows = [row for row in rows if missing not in row]
        for k in range(0, len(rows), share):
            part = rows[k:k + share]
            table = solve(self.runs, f"dense-stage-{name}", case, [self.scene(row) for row in part],
                          **{"optimize.seed": GA["seed"]})
            for i, row in enumerate(part):
                row |= {key: number(factor * table[f"search/{column}"][i]) for key, column, factor in figures}
            self.save()

    @staticmethod
    def scene(row):
        return scene([row[name] for name in NAMES], row["focal_length_m"], row["scallop"])

    def found(self):
        return [row for row in self.rows.values() if row["status"] == "found"]

    def climb(self):
        """Runs stages 2 and 3 on the rows that have come so far."""
        self.stage("anew", self.anew, "anew_psi_mm", self.found(),
                   [("anew_psi_mm", "psi_m", 1e3), ("anew_boundary", "boundary_tension_ratio", 1)])
        self.stage("ga", self.ga, "ga_psi_mm", [row for row in self.found() if deserves_ga(row)],
                   [("ga_psi_mm", "psi_m", 1e3), ("ga_inner", "inner_tension_ratio", 1),
                    ("ga_boundary", "boundary_tension_ratio", 1)], 20)

    def neighbours(self):
        """Solves ties in small steps around the nets of the first stage that are closest in the six figures on rigid
        supports. A search that resumes selects the same nets."""
        best = [row for row in self.found() if row.get("ga_psi_mm") is not None and row["tie_m"] in TIES_M]
        best.sort(key=on_rigid_supports, reverse=True)
        family = list({str([row[k] for k in NAMES[:5]]): row for row in best}.values())[::-1]
        family = sorted(family, key=on_rigid_supports)[:NEIGHBOURS]
        every, starts = [], {}
        for row in family:
            for k in range(-STEPS, STEPS + 1):
                n = net(row["modules"], row["cells"], row["spacing"], round(row["tie_m"] + k * STEP_M, 4))
                if n[5] > 0.02:
                    every.append(n)
                    starts[label(n)] = (row["focal_length_m"] ** -2, row["scallop"])
        self.roots(every, starts)

    def finish(self, kept):
        """Runs the figures of stage 5 on the nets that are closest after stage 4."""
        best = [row for row in self.found() if row.get("ga_psi_mm") is not None]
        best = sorted(best, key=on_rigid_supports)[:kept]
        for row in best:
            if "fdm" not in row:
                row |= self.equal_tensions(row)
            if "loops" not in row:
                row |= self.on_truss(row)
            if "form_loops" not in row:
                row |= self.formed_on_truss(row)
            self.save()

    def equal_tensions(self, row):
        """Returns the figures of the iterative force density method, Figs. 2 and 3, with all cables at 10 N."""
        keys = [word for key, value in self.scene(row).items() for word in ("--set", f"{key}={value}")]
        out = self.runs.call("run", self.form, *keys, "--set", "form.method=iterative_fdm", "--json", "--force", "-o",
                             os.path.join(self.runs.work, "dense-fdm.h5"), allowed=(0, 3, 4))
        inner, edge = moves(self.runs, self.form, keys)
        return {"fdm": json.loads(out)["status"], "fdm_inner_mm": inner, "fdm_edge_mm": edge}

    def on_truss(self, row):
        point = self.scene(row)
        found = on_truss(self.runs, export(self.runs, self.ga, point, "kept-net"), point, TRUSS_PSI_M)
        return {"loops": None} if found is None else {
            "truss_E_GPa": found["E_Pa"] / 1e9, "truss_psi_mm": 1e3 * found["psi_m"], "truss_inner": found["inner"],
            "truss_boundary": found["boundary"], "loops": found["loops"]}

    def formed_on_truss(self, row):
        """Returns the figures of a form-finding on the truss, with Young's modulus nearest to 8.38 mm."""
        E = np.geomspace(2e8, 2e11, 61)
        case = self.runs.case("dense-truss", TRUSS, form=STOP)
        more = {"truss.match_tolerance_m": f"{1.5 * row['tie_m'] + 0.01:.3g}", "coupling.scheme": "plain",
                "coupling.tof_m": "1e-3"}
        table = solve(self.runs, "dense-formed", case, [self.scene(row) | more | {"truss.E_Pa": f"{e:.4g}"} for e in E])
        psi = table["form/psi_m"]
        if not np.isfinite(psi).any():
            return {"form_loops": None}
        k = int(np.nanargmin(np.abs(psi - TRUSS_PSI_M)))
        return {"form_E_GPa": E[k] / 1e9, "form_psi_mm": 1e3 * float(psi[k]),
                "form_inner": float(table["form/inner_tension_ratio"][k]),
                "form_boundary": float(table["form/boundary_tension_ratio"][k]),
                "form_loops": int(table["coupling/iterations"][k]) - 1}

    def trusses(self, path):
        """Writes the figures of the best net on other trusses."""
        best = min(self.found(), key=lambda row: terms(row)[0])
        point, net = self.scene(best), export(self.runs, self.ga, self.scene(best), "kept-net")
        with open(path, "w", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            out.writerow(TRUSS_COLUMNS)
            for depth, every, supports, (tubes, keys) in itertools.product(*TRUSSES):
                truss = [("depth_m", depth), ("main_every", every), ("supports", supports), *keys]
                found = on_truss(self.runs, net, point, TRUSS_PSI_M, truss)
                out.writerow([depth, every, supports, tubes] + (["", "", "", "", ""] if found is None else [
                    f"{found['E_Pa'] / 1e9:.5g}", f"{1e3 * found['psi_m']:.4f}", f"{found['inner']:.4f}",
                    f"{found['boundary']:.4f}", found["loops"]]))

    def write(self, path):
        """Writes the row of every net, the best first. The order does not depend on when a row was added."""
        with open(path, "w", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            out.writerow(COLUMNS)
            for row in sorted(self.rows.values(), key=lambda r: (terms(r)[0], label([r[k] for k in NAMES]))):
                total, n = terms(row)
                cells = row | {"modules": "x".join(map(str, row["modules"])), "cells": "x".join(map(str, row["cells"])),
                               "met": n if row["status"] == "found" else None,
                               "misfit": total if row["status"] == "found" else None}
                out.writerow([text(cells.get(name), name) for name in COLUMNS])


def moves(runs, case, keys):
    """Returns the maximum displacements of inner nodes and of edge nodes, mm, in the first step at equal tensions."""
    path = os.path.join(runs.work, "dense-step.h5")
    runs.call("run", case, *keys, "--set", "form.method=fdm", "-o", path, "--force", "--quiet")
    with h5py.File(path, "r") as file:
        role = words(file["scene/node/role"])
        move = 1e3 * np.linalg.norm(file["form/position_m"][:] - file["scene/node/position_m"][:], axis=1)
    return (float(max(move[role == name], default=0)) for name in ("inner", "edge"))


def number(value):
    """Returns a number for JSON, or None if the run of the net failed."""
    return float(value) if np.isfinite(value) else None


def text(value, name):
    if value is None:
        return ""
    if not isinstance(value, float):
        return str(value)
    return f"{value:.4f}" if "inner" in name and "mm" not in name else f"{value:.5g}"


def differences(row, names):
    """Returns the differences from figures of the paper, over those that count as met. A missing one counts as CAP."""
    return [min(abs(row[k] - FIGURES[k][0]) / FIGURES[k][1], CAP) if row.get(k) is not None else CAP for k in names]


def on_rigid_supports(row):
    """Returns the rank of a row for the next stage: the six figures of the net on rigid supports."""
    return sum(differences(row, list(FIGURES)[:6]))


def terms(row):
    """Returns the misfit of a row and how many of the eight figures it meets. A net that collapses at equal tensions
    (Figs. 2 and 3) counts as CAP."""
    term = differences(row, FIGURES)
    holds = row.get("fdm") == "ok"
    moves = row.get("fdm_edge_mm", 0) > 3 * row.get("fdm_inner_mm", np.inf)
    return (sum(term) + CAP * (not holds) + CAP * (not moves)) / (len(FIGURES) + 2), sum(t <= 1 for t in term)


def deserves_ga(row):
    """Rule for the genetic algorithm, which takes 3 to 6 % off psi and adds up to 0.4 to the ratio."""
    return 1.0007 <= row["inner"] <= 1.0018 and row["anew_psi_mm"] is not None and 4.1 <= row["anew_psi_mm"] <= 5.0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True, help="folder for studies, their results and the rows so far")
    parser.add_argument("--out", default=DENSE_CSV)
    parser.add_argument("--out-truss", default=DENSE_TRUSS_CSV)
    a = parser.parse_args()
    search = Search(Runs(a.program, a.work))
    search.roots(nets())
    search.climb()
    search.neighbours()
    search.climb()
    search.finish(KEPT)
    search.write(a.out)
    search.trusses(a.out_truss)


if __name__ == "__main__":
    main()
