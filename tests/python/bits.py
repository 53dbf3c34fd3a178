"""Checks that the package returns, bit by bit, what the program returns: form-finding, designs, derivatives, runs and
tolerances. A net of arrays must equal the net of the files."""
import csv
import json
import os
import unittest

import numpy as np

from common import SMALL, evaluate_by_program, main, near, program, same_bits, source, temp

import hifdm

SHORT = {"optimize.generations": 1, "optimize.refine_steps": 1}
# Cases, their overrides, and whether designs have derivatives.
CASES = [("configs/chen2022.yaml", SHORT, True), ("configs/straight-edges-truss.yaml", SHORT, True),
         ("configs/reflector.yaml", SHORT, True), ("configs/paraboloid-6m.yaml", {}, False)]
GOALS = "optimize: {variables: [{set: all, vary: tension, range: 20 %}], objective: [{figure: psi}, {figure: ratio, " \
        "set: all, weight: 1e-3}, {figure: tension, set: boundary, target: 12}]}\n"


class Bits(unittest.TestCase):
    def test_form_finding(self):
        for path, overrides, _ in CASES:
            out = temp("form.h5")
            case = hifdm.open(source(path), overrides)
            shape = case.form()
            program("run", source(path), "-o", out, "--force", "--quiet",
                    *(part for key, value in overrides.items() for part in ("--set", f"{key}={value}")))
            with hifdm.read(out) as result:
                self.assertEqual(result.stages[0], "form")
                stored = result.shape("form")
                for name in ("position_m", "length_m", "tension_N", "q_N_per_m"):
                    self.assertTrue(same_bits(getattr(shape, name), getattr(stored, name)), (path, name))
                coupled = [name for name in shape.figures if name.startswith("coupling_")]
                self.assertEqual(len(coupled) > 2, "coupling" in result.h5, path)
                for name in shape.figures:
                    if not isinstance(shape.figures[name], str):
                        owner = result.h5["coupling" if name.startswith("coupling_") else "form"].attrs
                        self.assertTrue(same_bits(shape.figures[name], owner[name.removeprefix("coupling_")]), name)
                self.assertTrue(np.array_equal(case.end, result.end))

    def check_designs(self, path, n, has_slopes=True):
        case = hifdm.open(path)
        designs = near(case, n)
        designs[n // 2] *= np.where(np.arange(case.n_variable) % 2, 3, 0.3)  # mostly infeasible
        slopes = temp("slopes.csv")
        rows = evaluate_by_program(path, case, designs, *(["--jacobian", slopes] if has_slopes else []))
        out = case.evaluate(designs)
        self.assertEqual(out.names, [name for name in rows[0] if name != "id"])
        self.assertEqual([row["status"] for row in rows], list(out.status))
        for name in out.names[1:]:
            self.assertTrue(same_bits([float(row[name]) for row in rows], out[name]), (path, name))
        if has_slopes:
            self.check_slopes(case, designs, slopes, out)
        shape = case.shape(designs[0])
        self.assertEqual((shape.psi_m, shape.status), (out.psi_m[0], out.status[0]))
        self.assertEqual(list(shape.objectives.values()), [out[name][0] for name in out.objective_names])
        return out

    def check_slopes(self, case, designs, path, out):
        with open(path, encoding="utf-8", newline="") as file:
            lines = list(csv.DictReader(file))
        jacobian = case.jacobian(designs)
        self.assertEqual(jacobian.shape, (len(designs), len(case.slope_names), case.n_variable))
        feasible = jacobian[out.feasible].reshape(-1, case.n_variable)
        self.assertTrue(np.isnan(jacobian[~out.feasible]).all())
        self.assertEqual(len(lines), len(feasible))
        for k, line in enumerate(lines):
            self.assertEqual(line["figure"], case.slope_names[k % len(case.slope_names)])
            self.assertTrue(same_bits([float(line[name]) for name in case.variables], feasible[k]))

    def test_designs(self):
        for path, _, has_slopes in CASES:
            self.check_designs(source(path), 20, has_slopes)

    def test_designs_with_weights(self):
        out = self.check_designs(temp("goals.yaml", SMALL + GOALS), 20)
        self.assertEqual(out.objective_names, ["objective_0_psi", "objective_1_ratio_all",
                                               "objective_2_tension_boundary"])
        merit = np.sqrt(out.objective_0_psi**2 + (1e-3 * out.objective_1_ratio_all)**2 +
                        out["objective_2_tension_boundary"]**2)
        self.assertGreater(out.feasible.sum(), 10)
        # of ratio the merit has the smooth value, which is at most n_cable^(1/8) times this one
        self.assertTrue((np.abs(merit / out.merit - 1)[out.feasible] < 0.01).all())

    def test_designs_with_objectives(self):
        objectives = GOALS.replace("objective:", "front:").replace(", weight: 1e-3", "")
        out = self.check_designs(temp("objectives.yaml", SMALL + objectives), 20)
        self.assertNotIn("merit", out.names)
        self.assertEqual(len(out.objective_names), 3)

    def test_run(self):
        text = SMALL + "optimize: {population: 6, generations: 3, seed: 7}\ncables: [{expansion_per_K: -1e-6}]\n" \
                       "load_cases: [{name: cold, temperature_K: -50}]\ntolerance: {samples: 200, sigma_cut_m: 5e-5}\n"
        path = temp("run.yaml", text.replace("scene:\n", "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n"))
        theirs = json.loads(program("run", path, "-o", temp("theirs.h5"), "--force", "--json"))
        seen = []
        ours = hifdm.open(path).run(temp("ours.h5"), restart=True, progress=seen.append)
        alone = hifdm.open(path).run()
        program("diff", temp("ours.h5"), temp("theirs.h5"))
        self.assertEqual(ours.file, temp("ours.h5"))
        self.assertIsNone(alone.file)
        for run in (ours, alone):
            for stage in ("form", "search", "tolerance", "load_cases"):
                self.assertEqual(*(json.dumps(strip(figures[stage])) for figures in (run, theirs)))
        self.assertEqual([now.phase for now in seen][0], "form")
        self.assertEqual([now.done for now in seen if now.phase == "search"], [1, 2, 3])
        self.assertEqual(seen[-1].phase, "tolerance")
        self.assertEqual((seen[-1].done, seen[-1].all), (200, 200))
        with ours.read() as result:
            self.assertIn("load_cases/cold", result.stages)
            self.assertEqual(result.psi_m.shape, (3, 6))
            self.assertEqual(result.best_psi_m[-1], ours["search"]["psi_m"])
            self.assertEqual(result.shape("search").position_m.shape, (len(result.h5["scene/node/id"]), 3))


def strip(item):
    """Returns the item without times."""
    if isinstance(item, dict):
        return {key: strip(value) for key, value in item.items() if not key.endswith(("wall_s", "cpu_s", "utilisation"))
                and "per_s" not in key}
    return [strip(value) for value in item] if isinstance(item, list) else item


class Arrays(unittest.TestCase):
    """Nets that the program exports as tables and imports, and the same nets given as arrays."""

    def test_net_of_arrays_is_the_imported_one(self):
        sections = {"form": {"pretension_N": 12}, "optimize": {"population": 6, "generations": 2}}
        first = temp("first.yaml", SMALL + "form: {pretension_N: 12}\n")
        os.makedirs(temp("net"), exist_ok=True)
        path = temp("net/case.yaml", json.dumps({"scene": {"import": {"nodes": "nodes.csv", "cables": "cables.csv"}},
                                                 **sections}))
        case = hifdm.open(first)
        nodes = [dict(id=name, x_m=repr(x), y_m=repr(y), z_m=repr(z), role=role)
                 for name, (x, y, z), role in zip(case.node_ids, case.target_position_m.tolist(), case.role)]
        cables = [dict(id=name, i=case.node_ids[i], j=case.node_ids[j], group=group, law=law,
                       value="" if np.isnan(value) else repr(value))
                  for name, (i, j), group, law, value in
                  zip(case.cable_ids, case.end, case.group, case.law, case.target.tolist())]
        for cable in cables[::3]:
            cable["value"] = ""  # the default
        for with_load in (False, True):
            if with_load:
                for row, node in enumerate(nodes):
                    node.update(Fx_N="0", Fy_N="0.01", Fz_N=repr(-0.001 * row))
                for row, cable in enumerate(cables):
                    cable.update(EA_N="" if row % 2 else "45000", set="odd;" if row % 2 else "")
            for name, rows in (("nodes", nodes), ("cables", cables)):
                with open(temp(f"net/{name}.csv"), "w", encoding="utf-8", newline="") as file:
                    writer = csv.DictWriter(file, rows[0])
                    writer.writeheader()
                    writer.writerows(rows)
            self.compare(path, sections, nodes, cables, with_load)

    def compare(self, path, sections, nodes, cables, with_load):
        number = {node["id"]: row for row, node in enumerate(nodes)}
        position = np.array([[float(node[c]) for c in ("x_m", "y_m", "z_m")] for node in nodes])
        end = np.array([[number[cable["i"]], number[cable["j"]]] for cable in cables], np.int32)
        value = np.array([float(cable["value"] or "nan") for cable in cables])
        more = {}
        if with_load:
            more = {"load_N": np.array([[float(node[c]) for c in ("Fx_N", "Fy_N", "Fz_N")] for node in nodes]),
                    "EA_N": np.array([float(cable["EA_N"] or "nan") for cable in cables]),
                    "sets": {"odd": [row for row, cable in enumerate(cables) if cable["set"]]}}
        ours = hifdm.net(position, end, role=[node["role"] for node in nodes], group=[c["group"] for c in cables],
                         law=[c["law"] for c in cables], value=value, node_ids=[*number],
                         cable_ids=[c["id"] for c in cables], **more, **sections)
        theirs = hifdm.open(path)
        for name in ("node_ids", "cable_ids", "variables"):
            self.assertEqual(getattr(ours, name), getattr(theirs, name))
        for name in ("role", "group", "law", "end"):
            self.assertTrue(np.array_equal(getattr(ours, name), getattr(theirs, name)), name)
        for name in ("target_position_m", "target", "initial", "lower", "upper"):
            self.assertTrue(same_bits(getattr(ours, name), getattr(theirs, name)), name)
        self.assertEqual([*ours.sets], [*theirs.sets])
        self.assertTrue(all(np.array_equal(ours.sets[name], theirs.sets[name]) for name in ours.sets))
        if with_load:
            self.assertEqual([*ours.sets], ["odd"])
            self.assertTrue(same_bits(ours.load_N, theirs.load_N) and same_bits(ours.EA_N, theirs.EA_N))
        self.assertTrue(same_bits(ours.form().position_m, theirs.form().position_m))
        designs = near(ours, 10)
        self.assertTrue(same_bits(ours.evaluate(designs).table, theirs.evaluate(designs).table))
        ours.run(temp("arrays.h5"), restart=True)
        theirs.run(temp("imported.h5"), restart=True)
        with hifdm.read(temp("arrays.h5")) as a, hifdm.read(temp("imported.h5")) as b:
            for name in ("form/position_m", "search/population/psi_m", "search/tension_N", "scene/cable/target"):
                self.assertTrue(same_bits(a.h5[name][:], b.h5[name][:]), name)

    def test_ids_and_words_have_defaults(self):
        position = np.array([[0, 0, 0], [1, 0, 0.5], [2, 0, 0], [1, 1, 0], [1, -1, 0.0]])
        end = np.array([[0, 1], [1, 2], [1, 3], [4, 1]], np.int32)
        role = np.array([0, 1, 0, 0, 0], np.uint8)
        case = hifdm.net(position, end, role=role, form={"pretension_N": 10})
        self.assertEqual((case.node_ids[4], case.cable_ids[3], case.n_variable), ("4", "3", 0))
        self.assertTrue(np.allclose(case.form().position_m[1], [1, 0, 0], atol=1e-9))  # by symmetry
        self.assertTrue(np.allclose(case.form().tension_N, 10))


if __name__ == "__main__":
    main()
