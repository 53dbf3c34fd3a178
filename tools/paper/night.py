"""Finds the best pretension. Runs the studies below and writes a table of each and night.svg. The figure shows, over
the pretension, psi of the design and the psi that 95 % of the as-built nets do not exceed, for each error of the cut
lengths. It marks the minimum, and the pretension from which 95 % of the nets have no slack cable."""
import argparse
import csv
import math
import pathlib
import subprocess

import h5py

from draw import BLACK, BLUE, CYAN, RED, Plot, figure, path_of


STUDIES = (("pretension-night", "paper's reflector"), ("pretension-night-12m", "12 m offset reflector"))


def read(path):
    with h5py.File(path) as file:
        points = file["points"]
        columns = [points[name][:] for name in ("input/form.pretension_N", "input/tolerance.sigma_cut_m",
                                                "refine/psi_m", "tolerance/psi_95_m", "tolerance/n_with_slack",
                                                "tolerance/samples", "tolerance/n_failed")]
    return sorted(zip(*(c.tolist() for c in columns)), key=lambda row: (row[1], row[0]))


def best_of(rows):
    """Returns the row in which psi of 95 % of the nets is minimal, unless it is at an end, and the first taut row."""
    best = min(rows, key=lambda row: row[3])
    taut = next((row for row in rows if row[4] <= 0.05 * row[5]), None)
    return best if best not in (rows[0], rows[-1]) else None, taut


def panel(title, rows):
    """Draws taut pretensions as solid lines, and those at which more than 5 % of the nets have slack cables as dashed
    lines."""
    sigmas, top = sorted({row[1] for row in rows}), 1e3 * max(row[3] for row in rows)
    first = [row for row in rows if row[1] == sigmas[0]]
    end = 10 * math.ceil(first[-1][0] / 10)
    plot = Plot(f"pretension Td (N), {title}", "psi (mm)", (0, end), (0, math.ceil(top)), height=400)
    plot.curve([row[0] for row in first], [row[2] * 1e3 for row in first], "design", BLACK)
    for sigma, colour in zip(sigmas, (CYAN, BLUE, RED)):
        of = [row for row in rows if row[1] == sigma]
        best, taut = best_of(of)
        slack = [row for row in of if not taut or row[0] <= taut[0]]
        plot.curve([row[0] for row in of if taut and row[0] >= taut[0]],
                   [row[3] * 1e3 for row in of if taut and row[0] >= taut[0]], f"95 %, cut to {sigma * 1e3:g} mm",
                   colour)
        plot.body.append(path_of([plot.at(row[0], row[3] * 1e3) for row in slack], colour, 1.8, True))
        if best:
            plot.dots([best[0]], [best[3] * 1e3], None, colour, 5)
    return plot.draw()


def run(o, name):
    study, folder, merged = f"configs/{name}.yaml", o.work / name, o.work / f"{name}.h5"
    subprocess.run([o.program, "sweep", study, "--dir", folder], check=True)
    subprocess.run([o.program, "merge", study, "--dir", folder, "-o", merged, "--force"], check=True)
    rows = read(merged)
    with open(o.out / f"{name.removeprefix('pretension-')}.csv", "w", newline="") as file:
        write = csv.writer(file, lineterminator="\n")
        write.writerow(["pretension_N", "sigma_cut_m", "psi_m", "psi_95_m", "with_slack", "samples", "failed"])
        write.writerows([f"{value:.6g}" for value in row] for row in rows)
    return rows


def tell(title, rows):
    for sigma in sorted({row[1] for row in rows}):
        of = [row for row in rows if row[1] == sigma]
        best, taut = best_of(of)
        grows = of[-1][3] > of[0][3]
        least = f"least psi of 95 % of the nets {best[3] * 1e3:.3f} mm at {best[0]:.2f} N" if best else \
            f"psi of 95 % of the nets {'grows' if grows else 'falls'} all the way"
        end = f"; 95 % of the nets are taut from {taut[0]:.2f} N" if taut else ""
        print(f"{title}, cut to {sigma * 1e3:g} mm: {least}{end}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("program", "work", "out"):
        parser.add_argument(f"--{name}", required=True, type=pathlib.Path)
    o = parser.parse_args()
    o.work.mkdir(parents=True, exist_ok=True)
    o.out.mkdir(parents=True, exist_ok=True)
    found = [(title, run(o, name)) for name, title in STUDIES]
    figure(o.out / "night.svg", [panel(title, rows) for title, rows in found],
           "psi of reflectors on trusses that give way, optimised by Levenberg-Marquardt at each pretension, and the "
           "psi that 95 % of the nets as built keep. Broken: more than 5 % of the nets have slack cables. Dots: least "
           "values.", "configs/pretension-night*.yaml: make pretension-night")
    for title, rows in found:
        tell(title, rows)


if __name__ == "__main__":
    main()
