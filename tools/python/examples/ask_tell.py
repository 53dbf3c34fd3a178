"""An optimiser of your own with an ask/tell interface: a simple evolution strategy.

    python3 tools/python/examples/ask_tell.py configs/chen2022.yaml
"""
import sys

import numpy as np

import hifdm


class Evolution:
    """Uses the best quarter of each generation as parents of the next generation. The standard deviation of a
    generation adapts to the standard deviation of its parents."""

    def __init__(self, initial, lower, upper, n=64, seed=1):
        self.random = np.random.default_rng(seed)
        self.mean, self.lower, self.upper, self.n = initial, lower, upper, n
        self.spread = 0.02 * np.abs(initial)
        self.best_x, self.best_y = initial, np.inf

    def ask(self):
        steps = self.random.standard_normal((self.n, len(self.mean)))
        return np.clip(self.mean + self.spread * steps, self.lower, self.upper)

    def tell(self, x, y):
        order = np.argsort(y)[:self.n // 4]
        if y[order[0]] < self.best_y:
            self.best_x, self.best_y = x[order[0]], y[order[0]]
        self.mean = x[order].mean(axis=0)
        self.spread = 0.8 * self.spread + 0.2 * x[order].std(axis=0)


if len(sys.argv) < 2:
    sys.exit("usage:" + __doc__.split("\n\n")[1].rstrip())
case = hifdm.open(sys.argv[1])
optimiser = Evolution(case.initial, case.lower, case.upper)
for generation in range(30):
    designs = optimiser.ask()
    out = case.evaluate(designs)  # uses all cores
    optimiser.tell(designs, np.where(out.feasible, out.merit, np.inf))
print(f"psi {case.form().psi_m * 1e3:.4f} -> {case.shape(optimiser.best_x).psi_m * 1e3:.4f} mm")
