"""A net from arrays: a square of cables between four walls, pulled down in its middle, and a picture of it.

    python3 tools/python/examples/net_of_arrays.py [PICTURE.png]
"""
import sys

import numpy as np

import hifdm

n = 9
x, y = np.meshgrid(np.linspace(-2, 2, n), np.linspace(-2, 2, n), indexing="ij")
position_m = np.stack([x, y, 0.05 * (x**2 - y**2)], axis=-1).reshape(-1, 3)
number = np.arange(n * n).reshape(n, n)
end = np.concatenate([np.stack([number[:-1], number[1:]], -1).reshape(-1, 2),
                      np.stack([number[:, :-1], number[:, 1:]], -1).reshape(-1, 2)]).astype(np.int32)
rim = np.ones((n, n), bool)
rim[1:-1, 1:-1] = False
end = end[~rim.ravel()[end].all(axis=1)]  # no cables along the walls
load_N = np.zeros((n * n, 3))
load_N[number[n // 2, n // 2], 2] = -5

case = hifdm.net(position_m, end, role=np.where(rim.ravel(), "support", "inner"), law="tension", load_N=load_N,
                 form={"pretension_N": 20})
shape = case.form()
middle = shape.position_m[number[n // 2, n // 2]]
print(f"{case.n_node} nodes, {case.n_cable} cables; residual {shape.residual_N:.1e} N; the middle is at z = "
      f"{middle[2] * 1e3:.2f} mm")
if len(sys.argv) > 1:
    hifdm.plot_net(shape.position_m, case.end, shape.tension_N).figure.savefig(sys.argv[1])
