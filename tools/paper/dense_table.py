"""Writes dense.md: the net of configs/chen2022-dense.yaml at the paper's stop and at equilibrium, beside the figures of
the paper, and the nets of dense.csv that are closest to them."""
import csv
import json
import os
import textwrap

import yaml

from dense import COLUMNS, FIGURES, KEPT, NEAR, NEIGHBOURS, moves
from kept import Kept, export
from runs import DENSE, DENSE_CSV, DENSE_TRUSS_CSV, TRUSS

HEAD = """# The paper at its own stop

This page describes a net that has most figures of the paper if every form-finding ends by the paper's rule. The rule
ends an iteration when psi changes by less than 0.001 mm. `make paper` runs this net, `configs/chen2022-dense.yaml`, and
writes this page. `make paper-search` tries the nets and writes `results/chen2022/dense.csv`, with a row for each net
and its misfit.

The inner tension ratio of the paper is 1.0011. At equilibrium, Eq. 7 makes this ratio 1. The figures of the paper are
therefore those of an iteration that has not reached equilibrium. Quad nets with some hundred free nodes and with an
edge on short ties have such a ratio at the paper's stop.

In the table, psi and boundary ratios within 2 % of the paper are met. Inner ratios are met within 0.0002 of 1.0011,
0.0005 of 1.001 and 0.0075 of 1.0372.

"""
SPACE = """
## The search

- The nets have the pattern `quad`, 6 to 12 x 6 to 10 modules, and 3x2, 2x3, 2x2, 3x3, 4x2 or 2x4 cells per module. The
  spacing is `equal_arc` or `equal_projected`. Ties of 0.06, 0.1, 0.15, 0.2 or 0.3 m hold the edge at the corners of the
  modules.
- Nets of the same modules with 2x2, 2x1 or 1x2 cells and without ties are included, because they can hold at equal
  tensions.
- For the {neighbours} best combinations of modules, cells and spacing, the search also tries ties in steps of 10 mm.

The search solves for the focal length (12 to 500 m) and the scallop of each net that give 6.6 mm and 4.8445 within
{near:g} %. Nets that stop at an earlier turning point of psi, with an inner ratio above 1.0025, are not followed. The
genetic algorithm runs if the inner ratio is 1.0007 to 1.0018 and psi of the same tensions, solved anew, is 4.1 to 5 mm.
The truss and equal tensions follow for the {kept} best nets.

Other patterns, other supports and modules of different sizes were not searched at this stop. All nets share the truss
of `configs/chen2022-truss.yaml`, and only the net with the smallest misfit was tried on other trusses.

{counts}
The misfit is the mean of ten terms. Eight terms are the difference from a figure of the paper, divided by the
difference that counts as met: 2 % of psi and of boundary ratios, 0.0002, 0.0005 and 0.0075 for the inner ratios 1.0011,
1.001 and 1.0372. The eight figures are the six of the net on rigid supports, and both ratios on the truss. The other
two terms are 0 if the edge moves more than three times as far as the inner nodes in the first step at equal tensions
(Fig. 2), and if the net holds at equal tensions (Fig. 3). Otherwise they are 10, the maximum of each term.
A figure that was not computed also counts 10. psi on the truss is solved for, and the loops are only listed.

These are the nets with the smallest misfit:

"""
BEST = ["modules", "cells", "spacing", "tie_m", "focal_length_m", "scallop", *FIGURES, "loops", "met", "misfit"]
N_BEST = 12


def rows(path=DENSE_CSV):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class Figures:
    """The runs of configs/chen2022-dense.yaml that this page prints."""

    def __init__(self, runs):
        self.runs = runs
        with open(DENSE) as file:
            case = yaml.safe_load(file)
        self.row = row_of(case)
        exact = ("form.method=auto", "form.stop=residual", "optimize.rule=force_density")
        self.stop = self.run("dense", DENSE)
        self.anew = self.run("dense-anew", DENSE, "optimize.range_N=1e-9", "optimize.generations=1")
        self.exact = self.run("dense-exact", DENSE, *exact, "optimize.refine=false")
        self.equal = self.run("dense-equal", DENSE, "form.method=iterative_fdm")
        self.moves_mm = list(moves(runs, DENSE, ("--set", "optimize.generations=1")))
        with open(TRUSS) as file:
            truss = yaml.safe_load(file)["truss"] | {"match_tolerance_m": 0.5}
        path = runs.case("dense-on-truss", DENSE, drop=["optimize"], truss=truss,
                         coupling={"scheme": "plain", "tof_m": 1e-3})
        kept_E, formed_E = (f"truss.E_Pa={self.row[name]}e9" for name in ("truss_E_GPa", "form_E_GPa"))
        self.formed = self.run("dense-formed", path, formed_E)
        self.formed_exact = self.run("dense-formed-exact", path, kept_E, *exact[:2], "coupling.scheme=auto",
                                     "coupling.tof_m=1e-6")
        net, on_truss = (export(runs, c, {}, name) for c, name in ((DENSE, "dense-net"), (path, "dense-truss")))
        self.kept = Kept(runs, net, on_truss, "dense-kept").run(1e9 * float(self.row["truss_E_GPa"]))

    def run(self, name, case, *overrides):
        keys = [word for key in overrides for word in ("--set", key)]
        out = self.runs.call("run", case, *keys, "-o", os.path.join(self.runs.work, name + ".h5"), "--force", "--json",
                             allowed=(0, 3, 4))
        return json.loads(out)


def row_of(case):
    """Returns the row of dense.csv of the net of a case."""
    c = case["scene"]["parabolic_cylinder"]
    key = ["x".join(map(str, c[name])) for name in ("modules", "cells_per_module")]
    key += [c["spacing"], *(f"{c[name]:.5g}" for name in ("edge_tie_m", "focal_length_m", "scallop"))]
    for row in rows():
        if [row[name] for name in BEST[:4]] + [row["focal_length_m"], row["scallop"]] == key:
            return row
    raise SystemExit(f"{DENSE}: not in {DENSE_CSV}")


def of(stage):
    """Returns psi in mm and both ratios of a stage as text."""
    return (f"{1e3 * stage['psi_m']:.3f}", f"{stage['inner_tension_ratio']:.4f}",
            f"{stage['boundary_tension_ratio']:.3f}")


def line(*cells):
    return "| " + " | ".join(cells) + " |"


def met(name, value):
    paper, near = FIGURES[name]
    return "yes" if abs(float(value) - paper) <= near else "no"


def figures_table(f):
    form, ga, exact, exact_ga = of(f.stop["form"]), of(f.stop["search"]), of(f.exact["form"]), of(f.exact["search"])
    kept, formed = f.kept, of(f.formed["form"])
    on, equilibrium = (f"{1e3 * kept['psi_m']:.3f}", f"{kept['inner']:.4f}", f"{kept['boundary']:.3f}"), \
        of(f.formed_exact["form"])
    loops = [str(f.formed["coupling"]["iterations"] - 1), str(kept["loops"])]
    rows = [("form-finding: psi (mm)", "6.6", form[0], "solved for: focal length", exact[0]),
            ("inner tension ratio", "1.0011", form[1], met("inner", form[1]), exact[1]),
            ("boundary tension ratio", "4.8445", form[2], "solved for: scallop", exact[2]),
            ("genetic algorithm: psi (mm)", "4.3", ga[0], met("ga_psi_mm", ga[0]), exact_ga[0]),
            ("inner tension ratio", "1.001", ga[1], met("ga_inner", ga[1]), exact_ga[1]),
            ("boundary tension ratio", "5.608", ga[2], met("ga_boundary", ga[2]), exact_ga[2]),
            ("on the truss: psi (mm)", "8.38", on[0], "solved for: Young's modulus", equilibrium[0]),
            ("inner tension ratio", "1.0372", on[1], met("truss_inner", on[1]), equilibrium[1]),
            ("boundary tension ratio", "5.5898", on[2], met("truss_boundary", on[2]), equilibrium[2]),
            ("loops until 1 mm", "4", loops[1], "yes" if loops[1] == "4" else "no", "-")]
    marks = [row[3] for row in rows]
    n_solved, n_met = sum(mark.startswith("solved") for mark in marks), marks.count("yes")
    table = [line("figure", "paper", "at the paper's stop", "met", "at equilibrium"), line(*["---"] * 5),
             *(line(*row) for row in rows)]
    return table, n_solved, n_met, formed, loops[0], rows


def gain_table(f):
    first, anew, ga = (1e3 * value for value in (f.stop["form"]["psi_m"], f.anew["search"]["psi_m"],
                                                 f.stop["search"]["psi_m"]))
    exact, exact_ga = 1e3 * f.exact["form"]["psi_m"], 1e3 * f.exact["search"]["psi_m"]
    case = "hifdm run configs/chen2022-dense.yaml"
    back = " --set form.stop=residual --set form.method=auto --set optimize.rule=force_density"

    def down(a, b):
        return f"{100 * (1 - b / a):.1f} %"

    return [line("step", "psi (mm)", "gain", "command"), line(*["---"] * 4),
            line("form-finding, where the paper's rule stops", f"{first:.3f}", "-", f"`{case}`"),
            line("the same tensions, solved anew from q = T'/L\\*", f"{anew:.3f}", down(first, anew),
                 f"`{case} --set optimize.range_N=1e-9 --set optimize.generations=1`"),
            line("the genetic algorithm within 1 N", f"{ga:.3f}", f"{down(anew, ga)}; {down(first, ga)} in all",
                 f"`{case}`"),
            line("form-finding at equilibrium, without a search", f"{exact:.3f}", down(first, exact),
                 f"`{case}{back}`"),
            line("the genetic algorithm at equilibrium", f"{exact_ga:.3f}", down(exact, exact_ga),
                 "the same, row `search`")]


def best_table():
    table = [line(*(name.replace("_", " ") for name in BEST)), line(*["---"] * len(BEST)),
             line("**paper**", *["-"] * 5, *(f"{value:g}" for value, _ in FIGURES.values()), "4", "8", "0")]
    return table + [line(*(row[name] or "-" for name in BEST)) for row in rows()[:N_BEST]]


def write(runs):
    """Returns the text of dense.md."""
    f, every = Figures(runs), rows()
    table, n_solved, n_met, formed, formed_loops, figures = figures_table(f)
    found = [row for row in every if row["status"] == "found"]
    equal = [row for row in every if row["fdm"]]
    searched, best = sum(bool(row["ga_psi_mm"]) for row in found), max(int(row["met"]) for row in found)
    counts = paragraphs(
        f"""`dense.csv` has {len(every)} nets. For {len(found)} of them, the search found a focal length and a scallop
        that give 6.6 mm and 4.8445, and the genetic algorithm ran for {searched} of these. The best net meets {best} of
        the eight figures that the misfit counts, and no net meets all of them. Of the {len(equal)} best nets,
        {sum(row["fdm"] == "ok" for row in equal)} hold at equal tensions. The search found no net without ties that has
        a boundary tension ratio of 4.8445.""")
    if any(float(row["tie_m"]) == 0 for row in found):
        raise SystemExit("dense_table.py: a net without ties was found; the text says that there is none")
    if best == len(FIGURES):
        raise SystemExit("dense_table.py: a net meets all figures; the text says that there is none")
    space = SPACE.format(neighbours=NEIGHBOURS, near=100 * NEAR, kept=KEPT, counts=counts)
    missed = [f"{row[0]} ({row[1]})" for row in figures if row[3] == "no"]
    state = paragraphs(
        f"""**This net is a fit, not a prediction.** Ten parameters are tuned. Focal length, scallop and Young's modulus
        are solved for. The search selects the tie, the spacing, the modules and the cells in both directions, and one
        of two readings of the truss. Of the ten figures in the table, {n_solved} are solved for, and {n_met} others are
        met. A net with more tuned parameters than figures that it meets does not predict them. The agreement is
        consistent with the paper, and does not prove that the paper's net is of this kind.""",
        f"""On the truss, every cable keeps the force density that it has after the genetic algorithm. The paper's text
        also allows another reading: form-finding on the truss. At the paper's stop and with {f.row["form_E_GPa"]} GPa,
        form-finding on the truss gives {formed[0]} mm, {formed[1]} and {formed[2]}, and the loop compares displacements
        {times(formed_loops)}. The column "at equilibrium" contains form-finding on the truss of the first reading. This
        truss has a Young's modulus of {f.row["truss_E_GPa"]} GPa, but CFRP has about 130 GPa. The paper prints no
        dimensions of its truss.""",
        other_trusses(),
        f"""**Not met:** {"; ".join(missed) or "nothing"}. At equal tensions, the first step moves inner nodes by up to
        {f.moves_mm[0]:.0f} mm and nodes of the edge by up to {f.moves_mm[1]:.0f} mm (Fig. 2). Further steps (Fig. 3)
        end with the status `{f.equal["status"]}`, because a tie with 10 N cannot hold the inner cable and the two edge
        cables at its node. Every net with ties collapses for this reason.""",
        "## What the gain is made of")
    warn = paragraphs(
        """At this stop, most of the gain is not the gain of the search. The second form-finding starts from
        q = T'/L\\*, nearer to equilibrium than the first one, and stops later on its way there.""",
        """During the iteration, psi falls, rises and falls again. The rule can stop at each of these turning points.
        For a reflector that will be built, set `form.stop` to `residual`. The equilibrium is unique, and no figure then
        depends on the start of the iteration.""")
    return HEAD + "\n".join(table) + "\n\n" + state + "\n" + "\n".join(gain_table(f)) + "\n\n" + warn + space + \
        "\n".join(best_table()) + "\n"


def other_trusses():
    """Returns a sentence about the trusses of dense-truss.csv."""
    every = rows(DENSE_TRUSS_CSV)
    soft = [row for row in every if row["psi_mm"]]
    between = [f"{low} to {high}" for low, high in ((min(v), max(v)) for v in (
        [row[name] for row in soft] for name in ("inner", "boundary", "loops")))]
    return f"""`results/chen2022/dense-truss.csv` has {len(every)} trusses for this net, which differ in depth, main
        units, supports and tubes. With {len(soft)} of them, psi reaches 8.38 mm. Their inner ratios are {between[0]},
        their boundary ratios are {between[1]}, and the loop compares displacements {between[2]} times."""


def paragraphs(*texts):
    """Returns paragraphs with lines of at most 120 characters."""
    return "\n".join(textwrap.fill(" ".join(text.split()), 120, break_long_words=False, break_on_hyphens=False) + "\n"
                     for text in texts)


def times(count):
    return {"1": "once", "2": "twice"}.get(count, f"{count} times")
