"""read_example.py RESULT [-o PICTURE]: describes a result file of hifdm in words and in one picture.

The picture shows the net, coloured by the distance of its nodes from their target positions. If there was a search,
it also shows psi by generation. The script needs h5py and matplotlib (Debian: python3-h5py
python3-matplotlib). It is an example for scripts of your own."""
import argparse
import os

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")  # needs no screen
import matplotlib.pyplot as plt

STAGES = {"form": "form-finding", "search": "search", "refine": "refinement"}


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def print_summary(file):
    print(text(file.attrs["title"]))
    print(f"  {len(file['scene/node/id'])} nodes, {len(file['scene/cable/id'])} cables")
    for stage, name in STAGES.items():
        if stage not in file:
            continue
        figures, tension = file[stage].attrs, file[stage]["tension_N"][:]
        print(f"  {name}: psi {figures['psi_m'] * 1e3:.4f} mm, cables from {tension.min():.3f} "
              f"to {tension.max():.3f} N, residual {figures['residual_N']:.1e} N")
    if "search/population/psi_m" in file:
        psi = file["search/population/psi_m"][:]  # [generation, individual], NaN if infeasible
        first, last = np.nanmin(psi[0]) * 1e3, np.nanmin(psi[-1]) * 1e3
        print(f"  {len(psi)} generations, best psi {first:.4f} -> {last:.4f} mm")
    print(text(file.attrs["warnings"]), end="")


def draw_net(axes, file, stage):
    """Draws the net from above. Colours: the inner nodes, which are those that count in psi."""
    target, position = file["scene/node/position_m"][:], file[stage]["position_m"][:]
    roles = h5py.check_enum_dtype(file["scene/node/role"].dtype)  # word -> number
    inner = file["scene/node/role"][:] == roles["inner"]
    deviation_mm = np.linalg.norm(position - target, axis=1) * 1e3
    for i, j in file["scene/cable/end"][:]:
        axes.plot(*position[[i, j], :2].T, color="0.6", linewidth=0.8, zorder=1)
    dots = axes.scatter(*position[inner, :2].T, c=deviation_mm[inner], s=25, zorder=2)
    axes.figure.colorbar(dots, ax=axes, label="deviation, mm")
    axes.set(title=f"net after {STAGES[stage]}", xlabel="x, m", ylabel="y, m", aspect="equal")


def draw_generations(axes, file):
    for name in ("mean", "best"):
        axes.plot(file[f"search/population/{name}_psi_m"][:] * 1e3, label=name)
    axes.set(title="search", xlabel="generation", ylabel="psi, mm")
    axes.legend()


def main():
    parser = argparse.ArgumentParser(description="Print and draw a result file of hifdm.")
    parser.add_argument("result")
    parser.add_argument("-o", "--output", help="the picture (default: the result's name with .png, in this folder)")
    arguments = parser.parse_args()
    picture = arguments.output or os.path.splitext(os.path.basename(arguments.result))[0] + ".png"
    with h5py.File(arguments.result) as file:
        print_summary(file)
        figure = plt.figure(figsize=(12, 5))
        has_search = "search/population/psi_m" in file
        draw_net(figure.add_subplot(1, 1 + has_search, 1), file, "search" if "search" in file else "form")
        if has_search:
            draw_generations(figure.add_subplot(1, 2, 2), file)
        figure.tight_layout()
        figure.savefig(picture, dpi=120)
    print(f"  picture: {picture}")


if __name__ == "__main__":
    main()
