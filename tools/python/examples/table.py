"""A table of designs with pandas: finds what the best tenth of the designs have in common.

    python3 tools/python/examples/table.py configs/chen2022.yaml
"""
import sys

import numpy as np
import pandas as pd

import hifdm

if len(sys.argv) < 2:
    sys.exit("usage:" + __doc__.split("\n\n")[1].rstrip())
case = hifdm.open(sys.argv[1])
designs = case.initial + np.random.default_rng(1).uniform(-1, 1, (1000, case.n_variable))
table = pd.DataFrame(case.evaluate(designs).columns())
print(table.groupby("status").psi_m.describe())
best = pd.DataFrame(designs - case.initial, columns=case.variables)[table.psi_m < table.psi_m.quantile(0.1)]
print("mean tensions of the best tenth, N above the initial design, at the five cables that differ most:")
print(best.mean().sort_values(key=np.abs).tail(5).round(3).to_string())
