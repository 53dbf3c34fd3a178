"""Compares random and quasi-random samples of an as-built net: the error of the mean of psi^2 over samples and
processor time.

The script writes sampling.csv and sampling.svg. The net is that of configs/reflector.yaml with EA of 1e5 and 2e5 N. The
reference is the mean of many random samples, with the first order as control variate. It is known to about 1e-6 of
itself."""
import argparse
import csv
import json
import pathlib
import resource
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import svg  # noqa: E402

SIGMAS = {"1e-5": "cuts wrong by 0.01 mm", "1e-4": "cuts wrong by 0.1 mm"}


def case_of(work):
    root = pathlib.Path(__file__).resolve().parent.parent.parent
    text = (root / "configs/reflector.yaml").read_text().split("surface:")[0]
    text = text.replace("scene:\n", "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n", 1)
    path = work / "sampling.yaml"
    path.write_text(text + "tolerance: {sigma_cut_m: 1e-5}\n")
    return path


def run(o, case, sigma, samples, seed, sampling):
    keys = {"sigma_cut_m": sigma, "samples": samples, "seed": seed, "sampling": sampling}
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    words = [o.program, "tolerance", case, "-o", o.work / "sampling.h5", "--restart", "--json", "--threads", "1"]
    for key, value in keys.items():
        words += ["--set", f"tolerance.{key}={value}"]
    said = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=True).stdout
    result = json.loads(said)["tolerance"]
    return result, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("program", "work", "out"):
        parser.add_argument("--" + name, type=pathlib.Path, required=True)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--truth", type=int, default=20000)
    parser.add_argument("--sigmas", default="1e-5")
    o = parser.parse_args()
    o.work.mkdir(parents=True, exist_ok=True)
    case, rows, panels = case_of(o.work), [], {}
    for sigma in o.sigmas.split(","):
        truth = run(o, case, sigma, o.truth, 999, "random")[0]["controlled_rms_psi_m"] ** 2
        by_samples, by_time = {}, {}
        for samples in (64, 128, 256, 512, 1024, 2048, 4096):
            for sampling in ("random", "sobol"):
                found = [run(o, case, sigma, samples, seed, sampling) for seed in range(1, o.seeds + 1)]
                cpu = sorted(t for _, t in found)[len(found) // 2]
                for name, key in ((sampling, "rms_psi_m"), (sampling + ", controlled", "controlled_rms_psi_m")):
                    error = (sum((r[key] ** 2 / truth - 1) ** 2 for r, _ in found) / len(found)) ** 0.5
                    rows.append([sigma, name, samples, f"{error:.3g}", f"{cpu:.3g}"])
                    by_samples.setdefault(name, []).append((samples, error))
                    by_time.setdefault(name, []).append((cpu, error))
                    print(*rows[-1], flush=True)
        panels[SIGMAS.get(sigma, sigma) + ": error over samples"] = by_samples
        panels[SIGMAS.get(sigma, sigma) + ": error over processor time, s"] = by_time
    with open(o.out / "sampling.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([["sigma_cut_m", "samples of", "samples", "rms_relative_error", "cpu_s"]] + rows)
    svg.loglog(o.out / "sampling.svg", panels, "samples; s", "relative error of the mean of psi^2",
               f"{o.seeds} seeds; written by tools/bench/sampling.py")


main()
