"""Checks the running times of `make bench-optimisers` against a computation from all evaluations, and its option --only
with a driver and a program that only pretend to compute."""
import csv
import math
import os
import random
import re
import subprocess
import sys
import unittest
from pathlib import Path

from common import main, source, temp

TOOLS = source("tools/optimisers")
sys.path.insert(0, TOOLS)
import page  # noqa: E402
import running_times  # noqa: E402

DRIVER = """#!{python}
import os, struct, sys
import numpy as np
shift = float(os.environ["SHIFT"])
if sys.argv[2] != "serve":
    for seed in range(1, int(sys.argv[2]) + 1):
        for name in ("ours", "ours (variation chain)", "pagmo xnes"):
            for variables in ("gene", "chain")[:1 + name.startswith("pagmo")]:
                print(name, variables, seed, 20000, 1, 1000, 50 + seed, shift + 1, 700, shift, sep=",")
    print("nlopt BOBYQA", "gene", 1, 90, 1, 5 * shift, 60, shift * 1.005, sep=",")
while sys.argv[2] == "serve" and (head := sys.stdin.buffer.read(8)):
    by_chain, n = struct.unpack("ii", head)
    if n > 0:
        sys.stdin.buffer.read(8 * 3 * n)
        answer = np.full(n, 1.5 * shift)  # equal costs, so scipy stops early
    else:
        answer = np.concatenate([[3], np.random.default_rng(1).random(150)])
    sys.stdout.buffer.write(answer.astype(float).tobytes())
    sys.stdout.buffer.flush()
"""
PROGRAM = """#!{python}
print('{{"form": {{"psi_m": 9.0}}, "refine": {{"psi_m": 50.0, "evaluations": 6}}}}')
"""


def random_costs(rng):
    """Returns the costs of all evaluations of a run, some of them above the cap (1 km and more)."""
    low = rng.uniform(-12, 0)
    return [1e3 + rng.random() if rng.random() < 0.4 else 1 + 10 ** rng.uniform(low, 0.3)
            for _ in range(rng.choice((40, 700, 2500)))]


def first_hit(costs, limit):
    """Returns the first evaluation with at most this cost, found by looking at each, or None."""
    for i, cost in enumerate(costs):
        if cost <= limit:
            return i + 1
    return None


class RunningTimes(unittest.TestCase):
    def test_definition(self):
        """Two of three seeds reach 10 %: (100 + 300 + 600) / 2 evaluations. No seed reaches 1 %."""
        runs = [running_times.Run(500, [1, 100], [2.0, 1.1]), running_times.Run(400, [300], [1.05]),
                running_times.Run(600, [5], [1.2])]
        self.assertEqual(running_times.running_time(runs, 1.0, 10.0000001), 500)
        self.assertEqual(running_times.running_time(runs, 1.0, 100), (1 + 300 + 5) / 3)
        self.assertEqual(running_times.running_time(runs, 1.0, 1), math.inf)

    def test_equal_to_all_evaluations(self):
        rng, nets, rows = random.Random(5), {}, []
        for net in "abcdef":
            nets[net] = {(name, "gene"): [random_costs(rng) for _ in range(3)] for name in ("ours", "pagmo xnes")}
            for key, of in nets[net].items():
                runs = []
                for costs in of:
                    run = running_times.Run()
                    run.note(costs[:50])
                    run.note(costs[50:])
                    runs.append(run)
                    for budget in (1, 39, 1000):
                        self.assertEqual(run.best_m(budget), min(costs[:budget]))
                rows += running_times.rows_of(net, key, runs, 1.0)
        path = temp("runs.csv")
        running_times.write_rows(path, running_times.HEAD, rows, list("abcdef"))
        read = running_times.read_times(path)
        with open(path, encoding="utf-8", newline="") as file:
            written = {(row["net"], row["optimiser"], row["target_percent"]): row for row in csv.DictReader(file)}
        kinds = set()
        for net, of_net in nets.items():
            for key, of in of_net.items():
                hits = {}
                for k in range(41):
                    percent = 10 ** (2 - 0.2 * k)
                    word, first = f"{percent:.4g}", [first_hit(costs, 1 + percent / 100) for costs in of]
                    hits[word] = [at for at in first if at]
                    spent = sum(at or len(costs) for at, costs in zip(first, of))
                    row = written.get((net, key[0], word))
                    kinds.add(len(hits[word]))
                    if not hits[word]:
                        self.assertTrue(row is None or k == 0)
                        continue
                    self.assertEqual((int(row["successes"]), int(row["evaluations"])), (len(hits[word]), spent))
                    self.assertEqual(read[net][key].ert[word], spent / len(hits[word]))
                for x in (1, 10, 77, 500, 3000):
                    reached = sum(at <= x for of_target in hits.values() for at in of_target)
                    self.assertAlmostEqual(read[net][key].share(x), reached / (3 * 41), places=14)
        self.assertEqual(kinds, {0, 1, 2, 3})  # all cases occur
        both = [read[net]["ours", "gene"] for net in "af"]
        self.assertAlmostEqual(running_times.mean_share(both, 500), (both[0].share(500) + both[1].share(500)) / 2)

    def test_limit(self):
        run = running_times.Run()
        run.note([2.0] * 19999 + [1.5, 1.0])
        self.assertEqual((run.used, run.at, run.best_m(20000)), (20000, [1, 20000], 1.5))


class Only(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.words = []
        for name, text in (("driver", DRIVER), ("program", PROGRAM)):
            path = temp(name, text.format(python=sys.executable))
            os.chmod(path, 0o755)
            cls.words += ["--" + name, path]

    def run_only(self, only, shift, folder, status=0):
        os.makedirs(folder, exist_ok=True)
        done = subprocess.run([sys.executable, f"{TOOLS}/run.py", *self.words, "--seeds", "1", "--only", only, "--out",
                               folder], env={**os.environ, "SHIFT": str(shift)}, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        if status:
            return done.stderr
        rows = {}
        for name in ("optimisers.csv", "optimisers_lost.csv", "optimisers_runs.csv"):
            with open(os.path.join(folder, name), encoding="utf-8", newline="") as file:
                for row in list(csv.reader(file))[1:]:
                    rows.setdefault(row[0], []).append([name, *row])
        return rows

    def test_replaces_only_its_nets(self):
        folder, quads, capped = temp("out"), "quads 6x2, 6 N", "quads 6x2, 6 N, cap 1.2"
        first = self.run_only("flagship, cap", 1, folder)
        self.assertEqual(list(first), ["flagship, cap 4.6"])
        second = self.run_only(quads, 2, folder)
        self.assertEqual(set(second), {quads, capped, "flagship, cap 4.6"})
        self.assertEqual(second["flagship, cap 4.6"], first["flagship, cap 4.6"])
        third = self.run_only(capped, 3, folder)
        self.assertEqual(list(third), [quads, capped, "flagship, cap 4.6"])  # in the order of the nets
        self.assertEqual([third[name] for name in (quads, "flagship, cap 4.6")],
                         [second[name] for name in (quads, "flagship, cap 4.6")])
        self.assertNotEqual(third[capped], second[capped])
        self.assertEqual(len(third[capped]), len(second[capped]))
        text = Path(folder, "optimisers.html").read_text(encoding="utf-8")
        self.assertEqual([name for name in (quads, capped) if f'<th scope="row">{name}</th>' in text], [quads, capped])
        # On the first net psi* is 2 m. BOBYQA reaches 1 % after 60 evaluations, and ours only after 700.
        row = re.search(f'<th scope="row">{quads}</th>.*', text).group()
        self.assertIn('<td class="number ours">700</td><td class="number best">60<br>nlopt BOBYQA</td>', row)
        self.assertEqual(page.label_of(("pagmo cstrs xnes", "gene")), "pagmo xnes, constraint")

    def test_rejects(self):
        folder = temp("old")
        self.assertIn("no net has 'hexagon'", self.run_only("hexagon", 1, folder, 2))
        Path(folder, "optimisers.csv").write_text("net,psi\n", encoding="utf-8")
        self.assertIn("columns are those of another version", self.run_only("flagship", 1, folder, 1))


if __name__ == "__main__":
    main()
