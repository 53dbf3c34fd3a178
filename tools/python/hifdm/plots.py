"""Plots results with matplotlib. The plot functions import matplotlib only when they are called."""

from __future__ import annotations

import numpy as np


def plot_net(position_m: np.ndarray, end: np.ndarray, tension_N: np.ndarray | None = None, ax=None):
    """Plots the cables of a net. The colour of each cable shows its tension. Returns the axes.

    `position_m`: [n_node, 3] m, `end`: [n_cable, 2], `tension_N`: [n_cable] N
    """
    import matplotlib.pyplot as plt
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    ax = ax or plt.figure().add_subplot(projection="3d")
    lines = Line3DCollection(position_m[end], linewidths=0.8)
    if tension_N is not None:
        lines.set_array(tension_N)
        ax.figure.colorbar(lines, ax=ax, label="tension (N)", shrink=0.7, pad=0.15)
    ax.add_collection3d(lines)
    low, high = position_m.min(axis=0), position_m.max(axis=0)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2] + 1e-9))
    ax.set(xlabel="x (m)", ylabel="y (m)", zlabel="z (m)")
    ax.set_box_aspect(np.maximum(high - low, 0.1 * (high - low).max()))
    return ax


def plot_generations(best_psi_m: np.ndarray, ax=None):
    """Plots the best psi of each generation. Returns the axes. `best_psi_m`: [n_generation] m"""
    import matplotlib.pyplot as plt

    ax = ax or plt.figure().add_subplot()
    ax.plot(np.arange(len(best_psi_m)), np.asarray(best_psi_m) * 1e3)
    ax.set(xlabel="generation", ylabel="best psi (mm)")
    return ax
