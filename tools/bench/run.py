#!/usr/bin/env python3
"""Runs the whole benchmark: the C driver, the peers in Python and the program in interleaved rounds. It takes medians
and writes tables (CSV) and figures (SVG) into a folder of OUT for this processor. Times are compared within one run
only. No time is asserted anywhere.

    run.py --driver build/bench/bench --program build/hifdm --work build/bench --out results/bench --flags TEXT
"""
import argparse
import json
import math
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
import time
from collections import defaultdict
from datetime import datetime, timezone

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import svg  # noqa: E402

LANE_SCENES = ["21x25 f=15", "21x25 f=15 tied", "21x25 f=15 tied and held"]
SCENES = ["straight-edges", "21x25 f=15", "imported 31x37", "41x49 f=5"]
KERNEL_NET = "21x25 perimeter"
# Nets of equilibrium.c.
FORM_FINDINGS = ["21x25 f=15", "41x49 f=5", "on its truss", "on a truss 300 times as soft", "21x25 elastic",
                 "21x25 elastic; cut with errors of 0.5 mm", "21x25 tension; length and elastic"]
# Methods of precision.csv in its picture, in the order of the legend: words and style.
PICTURE = {
    "scipy fixed point": ("scipy, fixed point", "line"),
    "CHOLMOD fixed point": ("CHOLMOD in C, fixed point", "line"),
    "fixed point": ("hifdm, fixed point", "line"),
    "path, cold": ("hifdm, path, cold start", "line"),
    "newton": ("hifdm, Newton", "line"),
    "chord": ("hifdm, population of 50", "line"),
    "paper's stop": ("the paper's stop", "mark"),
}
BOUND = "its error bound"
BUILT_NET = "21x25 f=7.2 as built"
BUILT_MM = ["0.01", "0.03", "0.1", "0.5"]  # errors of cut lengths of the as-built net
PATTERN_DEG = ["2", "5"]  # ends of the 721 angles of the far field
SCALES = {1: 3, 2: 3, 4: 3, 8: 2, 16: 1}  # nets of the cost growth: rounds, fewer for nets that take seconds
BIG = "scene.parabolic_cylinder.cells_per_module=[4,4]"
# Arguments of the program. The refinement is not measured here, and takes long.
GA_CASES = {
    "straight-edges": ["configs/straight-edges.yaml"],
    "41x49 f=5": ["configs/reflector.yaml", "--set", BIG, "--set", "scene.parabolic_cylinder.focal_length_m=5",
                  "--set", "form.method=auto"],
}
GA_GENERATIONS = (400, 100)
# Cases that show what is skipped if a scene does not need it: a case file and overrides each.
STAGE_CASES = {
    "FDM only": ["configs/reflector.yaml", "form.method=fdm"],
    "HIFDM": ["configs/reflector.yaml", "form.method=hifdm"],
    "HIFDM + GA": ["configs/straight-edges.yaml"],
}


class Samples:
    """All samples of the run by (section, scene, method, parameter, quantity)."""

    def __init__(self):
        self.values = defaultdict(list)

    def add(self, section, scene, method, parameter, quantity, value):
        self.values[section, scene, method, float(parameter), quantity].append(float(value))

    def read(self, output):
        for row in output.splitlines():
            self.add(*row.split("\t"))

    def keys(self, section):
        """Returns (scene, method, parameter) of a section, in the order of arrival."""
        return list(dict.fromkeys(k[1:4] for k in self.values if k[0] == section))

    def get(self, section, scene, method, parameter, quantity):
        found = [v for v in self.values.get((section, scene, method, float(parameter), quantity), []) if v == v]
        return statistics.median(found) if found else None

    def paired(self, section, scene, over, under):
        """Returns the median of ratios of samples taken one after the other. over, under: (method, parameter,
        quantity)."""
        a, b = (self.values.get((section, scene, m, float(p), q), []) for m, p, q in (over, under))
        return statistics.median([x / y for x, y in zip(a, b)]) if a and b else None

    def any(self, section, scene, method, quantity):
        for key in self.keys(section):
            if key[:2] == (scene, method) and self.get(section, *key, quantity) is not None:
                return self.get(section, *key, quantity)
        return None


class Bench:
    def __init__(self, arguments):
        self.a, self.samples = arguments, Samples()
        self.processor = processor()
        self.out = os.path.join(self.a.out, re.sub(r"[^a-z0-9]+", "-", self.processor.lower()).strip("-"))
        # as the program sets them for itself
        self.env = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_WAIT_POLICY="passive", GOMP_SPINCOUNT="2000")
        self.start = time.monotonic()
        peer = subprocess.run([sys.executable, f"{HERE}/peers.py", "version"], capture_output=True, text=True)
        self.peer_version = peer.stdout.strip() if peer.returncode == 0 else None

    def say(self, words):
        print(f"  {time.monotonic() - self.start:5.0f} s  {words}", flush=True)

    def call(self, command):
        done = subprocess.run(command, env=self.env, stdout=subprocess.PIPE, text=True)
        if done.returncode != 0:  # earlier samples stay; the gap is visible in the tables
            print(f"bench: failed ({done.returncode}): {' '.join(command)}", file=sys.stderr)
        self.samples.read(done.stdout)

    def driver(self, section, *what):
        self.call([self.a.driver, section, self.a.work, *map(str, what)])

    def peers(self, *what):
        if self.peer_version:
            self.call([sys.executable, f"{HERE}/peers.py", what[0], self.a.work, *what[1:]])

    def program(self, name, threads, generations, policy="passive"):
        """Runs the program once with its genetic algorithm, and keeps times, memory and bytes of the whole process."""
        path = f"{self.a.work}/ga.h5"
        command = [self.a.program, "run", *GA_CASES[name], "-o", path, "--force", "--json", "--quiet",
                   "--threads", str(threads)]
        for key, value in {"population": 50, "generations": generations, "stagnation_generations": 400,
                           "refine_steps": 1}.items():
            command += ["--set", f"optimize.{key}={value}"]
        command += ["--set", "form.residual_tolerance=1e-9"]  # 1e-8 N at a pretension of 10 N
        start = time.monotonic()
        env = dict(self.env, OMP_WAIT_POLICY=policy)
        if policy == "active":
            del env["GOMP_SPINCOUNT"]
        child = subprocess.Popen(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        output = child.stdout.read()
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = status
        wall_s = time.monotonic() - start
        ga = json.loads(output)["search"]
        row = {"process_wall_s": wall_s, "process_cpu_s": usage.ru_utime + usage.ru_stime,
               "peak_MiB": usage.ru_maxrss / 1024, "file_MB": os.path.getsize(path) / 1e6,
               "ga_wall_s": ga["wall_s"], "ga_cpu_s": ga["cpu_s"], "evaluations": ga["evaluations"],
               "evaluations_per_s": ga["evaluations"] / ga["wall_s"],
               "utilisation": ga["cpu_s"] / ga["wall_s"] / threads, "residual_N": ga["residual_N"]}
        for quantity, value in row.items():
            self.samples.add("ga", name, f"{threads} threads, {policy}", generations, quantity, value)

    # ---- measurements ----

    def sweep(self, files):
        """Runs the 64 points of configs/pretension-sweep.yaml and measures how busy two cores are, from start to
        end."""
        folder, study = f"{self.a.work}/sweep.d", f"{self.a.work}/sweep.yaml"
        with open("configs/pretension-sweep.yaml") as file:
            text = file.read().replace("base: ", f"base: {os.path.abspath('configs')}/")
        with open(study, "w") as file:
            file.write(text + f"  files: {files}\n")
        shutil.rmtree(folder, ignore_errors=True)
        idle, start = idle_s(), time.monotonic()
        child = subprocess.Popen([self.a.program, "sweep", study, "--dir", folder, "--threads", "2", "--quiet"],
                                 stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = status
        wall_s, cpu_s = time.monotonic() - start, usage.ru_utime + usage.ru_stime
        idle = idle_s() - idle
        shutil.rmtree(folder, ignore_errors=True)
        for quantity, value in {"wall_s": wall_s, "cpu_s": cpu_s, "utilisation": cpu_s / 2 / wall_s,
                                "busy": 1 - idle / wall_s / os.cpu_count()}.items():
            self.samples.add("sweep", "pretension-sweep", f"files: {files}", 2, quantity, value)

    def measure(self):
        for r in range(self.a.rounds):
            self.say(f"round {r + 1} of {self.a.rounds}: steps, peak, phases, stages")
            self.driver("step")
            self.driver("frame")
            self.peers("step")
            self.driver("peak")
            for scene in (KERNEL_NET, *SCENES):
                self.driver("phases", scene)
            for name, case in STAGE_CASES.items():
                self.driver("stages", name, *case)
            self.say("work-precision, one evaluation")
            for scene in SCENES:
                if scene != SCENES[-1] or r == 0:  # there the fixed point takes 20 s
                    self.driver("precision", scene)
                    self.peers("precision", scene)
            for scene in (KERNEL_NET, *SCENES):
                if scene != SCENES[-1] or r < 2:
                    self.driver("single", scene)
                    self.peers("single", scene)
            for net in FORM_FINDINGS:
                self.driver("equilibrium", net)
            self.say("the net as built")
            for sigma in BUILT_MM:
                self.driver("built", sigma)
                self.peers("built", sigma)
            self.say("the far field")
            for to_deg in PATTERN_DEG:
                self.driver("pattern", to_deg)
                self.peers("pattern", to_deg)
            self.say("cost growth")
            for scale, rounds in SCALES.items():
                if r < rounds:
                    self.driver("growth", scale)
            self.say("populations")
            for _ in range(3):
                for scene in LANE_SCENES:
                    self.driver("lanes", scene)
                self.driver("population", "straight-edges")
                self.driver("whole", STAGE_CASES["HIFDM + GA"][0])
                self.program("straight-edges", 2, GA_GENERATIONS[0])
                self.program("straight-edges", 2, GA_GENERATIONS[0], "active")  # as a user who sets nothing
            self.driver("population", SCENES[-1])
            self.say("a sweep")
            for files in ("all", "none"):
                self.sweep(files)
        self.say("memory of the program")
        for name in GA_CASES:
            for generations in GA_GENERATIONS:
                self.program(name, 2, generations)
        self.checks = {name: self.check(*case) for name, case in STAGE_CASES.items()}

    def check(self, path, *overrides):
        """Returns the rows of `hifdm check` about what runs, what is skipped and which memory is allocated."""
        command = [self.a.program, "check", path, "--threads", "2"]
        for override in overrides:
            command += ["--set", override]
        done = subprocess.run(command, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        rows, title = [], ""
        for line in done.stdout.splitlines()[1:]:
            title = line[2:15].strip() or title
            if title in ("will run", "skipped"):
                rows.append([title, line[16:].strip(), ""])
            elif title in ("memory", "result file"):
                rows.append([title, line[16:54].strip(), line[55:].strip()])
        return rows

    def header(self):
        about = subprocess.run([self.a.driver, "about"], capture_output=True, text=True).stdout.split("\n")
        return [f"date {datetime.now(timezone.utc):%Y-%m-%d %H:%M} UTC",
                f"cpu {self.processor}, {os.cpu_count()} available",
                f"build {self.a.flags}", *filter(None, about), f"python peers {self.peer_version or 'not there'}",
                f"medians of interleaved samples; load average at the end {os.getloadavg()[0]:.2f}"]

    # ---- output ----

    def table(self, name, columns, rows):
        with open(f"{self.out}/{name}.csv", "w") as file:
            file.write("".join(f"# {row}\n" for row in self.head))
            file.write(",".join(columns) + "\n")
            for row in rows:
                file.write(",".join("" if v is None else v if isinstance(v, str) else f"{v:.6g}" for v in row) + "\n")

    def wide(self, name, section, quantities, labels=("scene", "method", "parameter")):
        """Writes a table with one row per (scene, method, parameter) and one column per quantity."""
        rows = []
        for key in self.samples.keys(section):
            values = [self.samples.get(section, *key, q) for q in quantities]
            if any(v is not None for v in values):
                # commas separate columns
                rows.append([key[0].replace(",", ";"), key[1].replace(",", ";"), key[2], *values])
        self.table(name, [*labels, *quantities], rows)

    def write_precision(self):
        quantities = ["time_s", "error_m", "bound_m", "estimate_m", "iterations", "relative_residual", "setup_s"]
        self.wide("precision", "precision", quantities, ("scene", "method", "tolerance"))
        panels = {}
        for method, (title, _) in PICTURE.items():
            for scene, of, parameter in self.samples.keys("precision"):
                point = [self.samples.get("precision", scene, method, parameter, q) for q in ("time_s", "error_m")]
                if of == method and None not in point:
                    panels.setdefault(scene, {}).setdefault(title, []).append(point)
                bound_m = self.samples.get("precision", scene, method, parameter, "bound_m")
                if of == method and bound_m:
                    panels[scene].setdefault(BOUND, []).append([point[0], bound_m])
        svg.loglog(f"{self.out}/precision.svg", panels, "time per evaluation (s)", "true position error (m)",
                   "\n".join(self.head), styles={**dict(PICTURE.values()), BOUND: "dash"})

    def write_single(self):
        rows = []
        for scene, method, _ in self.samples.keys("single"):
            value = {q: self.samples.any("single", scene, method, q) for q in ("time_s", "error_m", "iterations")}
            ours = {m: self.samples.any("single", scene, m, "time_s") for m in ("newton", "chord")}
            rows.append([scene, method.replace(",", ";"), value["time_s"], value["error_m"], value["iterations"],
                         *(value["time_s"] / ours[m] if ours[m] else None for m in ours)])
        columns = ["scene", "method", "time_s", "error_m", "iterations", "times_newton", "times_chord"]
        self.table("single", columns, rows)
        self.wide("form", "form", ["time_s", "iterations", "residual_N", "position_error_estimate_m"],
                  ("scene", "method", "tolerance"))

    def write_equilibrium(self):
        self.wide("equilibrium", "equilibrium", ["time_s", "error_m", "steps", "n_slack"], ("net", "by", "wanted_m"))

    def write_built(self):
        self.wide("built", "built", ["samples_per_s", "cpu_s", "steps", "slack_cables", "loose_nodes", "residual",
                                     "error_m", "missed"], ("net", "method", "sigma_mm"))
        self.wide("built_precision", "built_precision", ["cpu_s", "error_m"], ("net", "sigma", "tolerance"))
        lines = {}
        for scene, method, tolerance in self.samples.keys("built_precision"):
            point = [self.samples.get("built_precision", scene, method, tolerance, q) for q in ("cpu_s", "error_m")]
            lines.setdefault(method, []).append(point)
        for scene, method, sigma in self.samples.keys("built"):
            if method.startswith("scipy"):
                point = [self.samples.get("built", scene, method, sigma, q) for q in ("cpu_s", "error_m")]
                lines.setdefault("scipy, residual 1e-8", []).append(point)
        svg.loglog(f"{self.out}/built.svg", {"the net as built, 525 nodes": lines}, "processor time per sample (s)",
                   "largest true position error (m)", "\n".join(self.head), columns=1,
                   styles={"scipy, residual 1e-8": "mark"})

    def write_pattern(self):
        self.wide("pattern", "pattern", ["wall_s", "points", "difference"], ("reflector", "method", "to_deg"))

    def write_step(self):
        base, rows = self.samples.any("step", KERNEL_NET, "dpbtrf", "time_s"), []
        for scene, method, n_free in self.samples.keys("step"):
            seconds = self.samples.get("step", scene, method, n_free, "time_s")
            if seconds:
                rows.append([method, n_free, 1e6 * seconds, seconds / base,
                             self.samples.get("step", scene, method, n_free, "difference_m")])
        self.table("step", ["method", "n_free", "time_us", "times_dpbtrf", "difference_m"], rows)

    def write_peak(self):
        self.wide("peak", "peak", ["factor_us", "flops", "flops_of_band", "factor_GFs", "fma_peak_GFs",
                                   "share_of_fma_peak"],
                  ("net", "instruction_set", "half_bandwidth"))

    def write_growth(self):
        self.wide("growth", "growth", ["n_free", "half_bandwidth", "time_s", "bytes", "iterations"],
                  ("net", "method", "nodes"))
        panels, rows = {}, []
        for quantity, title in (("time_s", "time (s)"), ("bytes", "memory (bytes)")):
            for net, method, nodes in self.samples.keys("growth"):
                value = self.samples.get("growth", net, method, nodes, quantity)
                if value:
                    panels.setdefault(title, {}).setdefault(method, []).append((nodes, value))
            for method, points in panels[title].items():
                if len(points) >= 3:  # over all sizes, and over the upper three, where it is constant
                    rows.append([method.replace(",", ";"), quantity, slope(points), slope(points[-3:])])
        self.table("growth_exponents", ["method", "quantity", "exponent", "exponent_upper_three"], rows)
        svg.loglog(f"{self.out}/growth.svg", panels, "nodes", "per solve or evaluation", "\n".join(self.head))

    def write_phases(self):
        bars, rows = {}, []
        for key, values in self.samples.values.items():
            section, scene, method, phase, quantity = key
            if section != "phases" or quantity == "share":
                continue
            share = self.samples.get("phases", scene, method, phase, "share")
            bars.setdefault(f"{scene}, {method}", {})[quantity] = share
            rows.append([scene, method.replace(",", ";"), quantity, statistics.median(values), share])
        self.table("phases", ["scene", "method", "phase", "time_s", "share"], rows)
        svg.shares(f"{self.out}/phases.svg", bars, "\n".join(self.head))

    def write_stages(self):
        keys = self.samples.keys("stages")
        rows = []
        for stage, i in dict.fromkeys(k[1:] for k in sorted(keys, key=lambda k: k[2])):
            row = [stage]
            for case in STAGE_CASES:
                time_s = self.samples.get("stages", case, stage, i, "time_s")
                row += ["skipped" if time_s is None else time_s,
                        self.samples.get("stages", case, stage, i, "kept_bytes")]
            rows.append(row)
        columns = [f"{case}: {quantity}" for case in STAGE_CASES for quantity in ("time_s", "kept_bytes")]
        self.table("stages", ["stage", *columns], rows)
        self.table("check", ["case", "row", "what", "how_much"],
                   [[case, *(cell.replace(",", ";") for cell in row)]
                    for case, check in self.checks.items() for row in check])

    def write_lanes(self):
        self.wide("lanes", "lanes", ["half_bandwidth", "iterations", "design_s", "iteration_dof_s", "band_GFs"],
                  ("scene", "lanes", "degrees_of_freedom"))

    def write_population(self):
        self.wide("ga", "ga", ["ga_wall_s", "ga_cpu_s", "utilisation", "evaluations", "evaluations_per_s", "residual_N",
                               "process_wall_s", "process_cpu_s", "peak_MiB", "file_MB"],
                  ("scene", "threads", "generations"))
        self.wide("population", "population",
                  ["wall_s", "store_s", "store_share", "utilisation", "evaluations", "evaluations_per_s",
                   "worst_residual_N", "file_MB", "written_MB"],
                  ("scene", "mode", "threads"))

    def write(self):
        os.makedirs(self.out, exist_ok=True)
        self.head = self.header()
        self.wide("frame", "frame", ["time_s", "half_bandwidth"], ("truss", "what", "unknowns"))
        for name in ("precision", "single", "equilibrium", "built", "pattern", "step", "peak", "growth",
                     "phases", "stages", "lanes", "population"):
            getattr(self, f"write_{name}")()
        rows = list(summary(self.samples))
        self.table("summary", ["figure", "wanted", f"measured on {self.processor}"], rows)
        print(f"  {'':<76} {'wanted':>10} measured on {self.processor}")
        for figure, wanted, measured in rows:
            print(f"  {figure:<76} {wanted:>10} {'-' if measured is None else f'{measured:.4g}':>10}")


def processor():
    """Returns the name of the processor without commas, with family and model, because hypervisors shorten names."""
    with open("/proc/cpuinfo") as file:
        rows = dict(row.split(":", 1) for row in file.read().split("\n\n")[0].splitlines() if ":" in row)
    row = {key.strip(): value.strip().replace(",", " ") for key, value in rows.items()}
    name = row.get("model name", platform.machine())
    return name + "".join(f" {key} {row[word]}" for key, word in (
        ("family", "cpu family"), ("model", "model"), ("part", "CPU part")) if word in row)


def slope(points):
    """Returns the exponent by least squares."""
    x, y = [[math.log(p[i]) for p in points] for i in (0, 1)]
    mx, my = statistics.mean(x), statistics.mean(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def ratio(a, b):
    return a / b if a and b else None


def idle_s():
    """Returns how long the cores of this machine have been idle or have only waited for the disk, s."""
    with open("/proc/stat") as file:
        ticks = file.readline().split()[4:6]
    return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


def milli(value):
    return None if value is None else 1e3 * value


def summary(s):
    """Yields rows (figure, wanted, measured) that compare with the numbers that the project has set itself."""
    def step(method):
        return s.any("step", KERNEL_NET, method, "time_s")

    nets = [key for key in s.keys("growth") if key[1] == "FDM step, band"]
    faster = [n[2] for n in nets if (ratio(s.get("growth", *n, "time_s"),
                                           s.get("growth", n[0], "FDM step, CHOLMOD", n[2], "time_s")) or 0) > 1]
    yield ["FDM step: smallest net where CHOLMOD overtakes the band; nodes", "", min(faster, default=None)]
    base = step("lanes") or step("dpbtrf")
    name = "lanes" if step("lanes") else "dpbtrf (no lane path yet)"
    for method, wanted in (("dpbtrf", "6"), ("CHOLMOD", "4"), ("scipy solveh_banded", "12"), ("scipy splu", "")):
        yield [f"FDM step, 437 free: {method} / {name}", wanted, ratio(step(method), base)]
    best = {key[0]: key for key in s.keys("peak")}  # the program chooses the last instruction set
    for net, isa, half_bandwidth in list(best.values())[1:]:
        yield [f"lane factorisation / FMA peak ({isa}); half-bandwidth {half_bandwidth:.0f}", "0.65",
               s.get("peak", net, isa, half_bandwidth, "share_of_fma_peak")]
    for lanes in ("shared matrix", "matrix per design"):
        single, *tied = [s.any("lanes", scene, lanes, "band_GFs") for scene in LANE_SCENES]
        yield [f"populations; {lanes}: speed of the lanes on a tied net / on a single one", "1", ratio(tied[0], single)]
    for sigma, wanted in zip(BUILT_MM, ("10000", "", "1000", "")):
        yield [f"net as built; cuts {sigma} mm off: samples/s on 2 threads", wanted,
               s.get("built", BUILT_NET, "hifdm, 2 threads", float(sigma), "samples_per_s")]
        yield [f"net as built; cuts {sigma} mm off: scipy / hifdm on one core", "",
               ratio(s.get("built", BUILT_NET, "scipy Newton; splu", float(sigma), "cpu_s"),
                     s.get("built", BUILT_NET, "hifdm, 1 thread", float(sigma), "cpu_s"))]
    for truss, what, unknowns in s.keys("frame"):
        if what.endswith("five load cases"):  # Frame3DD needed 2.2 s and 9.9 s for such trusses
            wanted = "0.5" if what.startswith("factor") else ""
            yield [f"{truss}: {what}; s", wanted, s.get("frame", truss, what, unknowns, "time_s")]
    for scene in (KERNEL_NET, *SCENES):
        for peer, wanted in (("fixed point", "300"), ("scipy fixed point, band", "1000")):
            for method in ("newton", "chord"):
                value = ratio(s.any("single", scene, peer, "time_s"), s.any("single", scene, method, "time_s"))
                if value:
                    yield [f"to 1e-6 m; {scene}: {peer.replace(',', ';')} / {method}", wanted, value]
    for scene, memory in (("straight-edges", "64"), ("41x49 f=5", "256")):
        def ga(threads, quantity, generations=400, policy="passive"):
            return s.get("ga", scene, f"{threads} threads, {policy}", generations, quantity)
        limit = "2" if scene == "straight-edges" else ""
        yield [f"50x400 GA; {scene}: wall s on 2 threads", limit, ga(2, "ga_wall_s")]
        active = ga(2, "ga_wall_s", 400, "active")
        if active:
            yield [f"50x400 GA; {scene}: the same with OMP_WAIT_POLICY=active", "", active]
        def population(mode, threads, quantity):
            return s.get("population", scene, mode, threads, quantity)
        one, two, stored = ("not stored", 1, "wall_s"), ("not stored", 2, "wall_s"), ("stored", 2, "wall_s")
        for threads in (1, 2):
            yield [f"50x400 GA; {scene}: evaluations/s; threads {threads}; nothing stored", "",
                   population("not stored", threads, "evaluations_per_s")]
        yield [f"50x400 GA; {scene}: 1 thread / 2 threads; nothing stored", "1.9",
               s.paired("population", scene, one, two)]
        for mode in ("not stored", "stored"):
            yield [f"50x400 GA; {scene}: CPU utilisation on 2 threads; {mode}",
                   "" if scene == "straight-edges" else "0.95", population(mode, 2, "utilisation")]
        yield [f"50x400 GA; {scene}: share of the time spent storing; threads 1", "0.05",
               population("stored", 1, "store_share")]
        yield [f"50x400 GA; {scene}: stored / not stored; threads 1", "1.05",
               s.paired("population", scene, ("stored", 1, "wall_s"), one)]
        yield [f"50x400 GA; {scene}: stored / not stored; threads 2", "1.05",
               s.paired("population", scene, stored, two)]
        yield [f"50x400 GA; {scene}: the file's bytes by write(2) alone; ms", "",
               milli(population("write(2) alone", 1, "wall_s"))]
        yield [f"50x400 GA; {scene}: the same and fsync; ms", "",
               milli(population("write(2) and fsync alone", 1, "wall_s"))]
        yield [f"50x400 GA; {scene}: MB written", "", population("stored", 2, "written_MB")]
        yield [f"50x400 GA; {scene}: largest residual of all individuals N", "1e-8",
               population("stored", 2, "worst_residual_N")]
        yield [f"50x400 GA; {scene}: peak MiB", memory, ga(2, "peak_MiB")]
        yield [f"50x100 GA; {scene}: peak MiB", memory, ga(2, "peak_MiB", 100)]
    case = STAGE_CASES["HIFDM + GA"][0]
    yield [f"hifdm run {case} on 2 threads: stored / not stored", "1.05",
           s.paired("whole", case, ("stored", 2, "wall_s"), ("not stored", 2, "wall_s"))]
    for files in ("all", "none"):
        yield [f"64-point sweep on 2 threads; files: {files}: share of the time that the cores are busy", "0.97",
               s.get("sweep", "pretension-sweep", f"files: {files}", 2, "busy")]
        yield [f"64-point sweep on 2 threads; files: {files}: its processor time over wall time and threads", "0.97",
               s.get("sweep", "pretension-sweep", f"files: {files}", 2, "utilisation")]
        yield [f"64-point sweep on 2 threads; files: {files}: wall s", "",
               s.get("sweep", "pretension-sweep", f"files: {files}", 2, "wall_s")]



def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for option in ("driver", "program", "work", "out"):
        parser.add_argument(f"--{option}", required=True)
    parser.add_argument("--flags", default="unknown")
    parser.add_argument("--rounds", type=int, default=3)
    bench = Bench(parser.parse_args())
    bench.measure()
    bench.write()
    bench.say(f"done: {bench.out}")


if __name__ == "__main__":
    main()
