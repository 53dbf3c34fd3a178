"""The data of attack.py: cases, commands, files that may be damaged, and which errors fit which call."""

NET = """scene:
  paraboloid: {aperture_m: 3, focal_length_m: 2, rings: 2, rear_distance_m: 0.8}
  EA_inner_N: 1e5
  EA_boundary_N: 1e5
form: {pretension_N: 20, prestress: exact}
"""
TRUSS = """truss:
  expansion_per_K: 0
  ring: {cells_per_bay: 2, bracing: single, held: bay, longeron: {diameter_m: 0.03, wall_m: 0.001}}
"""
SEARCH = """optimize:
  variables: [{set: boundary, vary: force_density, range: 10 %%}]
  population: %d
  generations: %d
  stagnation_generations: 999
  seed: 5
  %s
"""
LATER = """surface: {frequencies_Hz: [2e9]}
cables: [{expansion_per_K: -1e-6}]
load_cases: [{name: cold, temperature_K: -60}]
tolerance: {sigma_cut_m: 1e-4, samples: 300}
"""
FILES = {
    "form.yaml": NET,
    "ga.yaml": NET + SEARCH % (12, 60, "refine: false"),
    "lm.yaml": NET + TRUSS + "optimize: {method: lm, variables: [{set: all, vary: force_density, range: 50 %}]}\n",
    "all.yaml": NET + TRUSS + LATER + SEARCH % (8, 5, "method: ga+lm\n  refine_steps: 2"),
    "front.yaml": NET + SEARCH % (8, 5, "front: [{figure: psi}, {figure: ratio, set: boundary}]"),
    "cut.yaml": NET + "tolerance: {sigma_cut_m: 1e-4, samples: 1500}\n",
    "adjust.yaml": NET + "tolerance: {sigma_cut_m: 1e-3, samples: 50}\n"
    "adjust: {set: tie, range_m: 0.002, step_m: 1e-4, max_adjustments: 2, sigma_m: 1e-4}\n",
    "small.yaml": NET + SEARCH % (8, 4, "refine: false"),
    "s.yaml": "base: small.yaml\nsweep:\n  form.pretension_N: [15, 20, 25, 30]\n",
    "own.yaml": "scene: {import: {nodes: nodes.csv, cables: cables.csv}}\n",
}
TASK = "t.h5.tolerance-%d-of-2.journal"
BASE = ("run all.yaml -o r.h5 --quiet", "run front.yaml -o f.h5 --quiet", "run adjust.yaml -o j.h5 --quiet",
        "sweep s.yaml --quiet", "merge s.yaml -o m.h5", "export j.h5 --csv .", "report f.h5 -o r.html",
        "evaluate ga.yaml --template d.csv", "tolerance cut.yaml -o t.h5 --task 0 --tasks 2 --quiet",
        "tolerance cut.yaml -o t.h5 --task 1 --tasks 2 --quiet")
KILLED = "run ga.yaml -o n.h5 --quiet"  # n.h5 is what a kill leaves of this run

# ---- commands: name: (words, what is in out/ before, exit status) ----

UNFINISHED = {"n.h5": "n.h5", "n.h5.journal": "n.h5.journal"}
TASKS = {TASK % i: TASK % i for i in (0, 1)}
ADJUST = "adjust adjust.yaml --measured m.csv --result j.h5 -o out/moves.csv --report out/moves.html --quiet"
WRITERS = {
    "run, GA": ("run ga.yaml -o out/a.h5 --quiet", {}, 0),
    "run, LM": ("run lm.yaml -o out/a.h5 --quiet", {}, 0),
    "run, all": ("run all.yaml -o out/a.h5 --quiet", {}, 0),
    "run, front": ("run front.yaml -o out/a.h5 --quiet", {}, 0),
    "run, point": ("run front.yaml --point f.h5:1 -o out/a.h5 --quiet", {}, 0),
    "run --restart": ("run ga.yaml -o out/a.h5 --restart --quiet", {"a.h5": "r.h5"}, 0),
    "run, resumed": ("run ga.yaml -o out/n.h5 --quiet", UNFINISHED, 0),
    "run, to a link": ("run all.yaml -o out/link.h5 --quiet", {"link.h5": "-> there.h5"}, 0),
    "tolerance": ("tolerance cut.yaml -o out/t.h5 --quiet", {}, 0),
    "tolerance --task": ("tolerance cut.yaml -o out/t.h5 --task 0 --tasks 2 --quiet", {}, 0),
    "tolerance --tasks": ("tolerance cut.yaml -o out/t.h5 --tasks 2 --quiet", TASKS, 0),
    "sweep": ("sweep s.yaml --dir out/s.d --quiet", {}, 0),
    "merge": ("merge s.yaml --dir s.d -o out/m.h5", {}, 0),
    "merge, again": ("merge s.yaml --dir s.d -o out/m.h5", {"m.h5": "m.h5"}, 0),
    "report": ("report r.h5 -o out/r.html", {}, 0),
    "report of two": ("report r.h5 f.h5 -o out/r.html --force", {"r.html": "r.html"}, 0),
    "export": ("export r.h5 --csv out/csv --vtk out/vtk --cutlist out/cut.csv --rf out/rf", {}, 0),
    "export --force": ("export r.h5 --csv out --cutlist out/cut.csv --force", {"nodes.csv": "m.csv"}, 0),
    "adjust": (ADJUST, {}, 0),
    "evaluate": ("evaluate ga.yaml --designs d.csv -o out/e.csv --jacobian out/j.csv --residuals out/f.csv --quiet",
                 {}, 0),
}
# What has to be refused is what a fault must not let through.
OTHERS = {
    "recover": ("recover out/n.h5", UNFINISHED, 0),
    "show": ("show r.h5 --verbose", {}, 0),
    "show --json": ("show r.h5 --json", {}, 0),
    "show, merge": ("show m.h5", {}, 0),
    "diff": ("diff r.h5 f.h5", {}, 1),
    "status": ("status s.yaml --dir s.d", {}, 0),
    "check": ("check all.yaml", {}, 0),
    "run onto a result": ("run lm.yaml -o out/a.h5 --quiet", {"a.h5": "r.h5"}, 5),
    "run onto no result": ("run lm.yaml -o out/m.csv --quiet", {"m.csv": "m.csv"}, 5),
    "new onto a case": ("new out/s", {"s.yaml": "s.yaml"}, 5),
    "merge onto a result": ("merge s.yaml --dir s.d -o out/a.h5", {"a.h5": "r.h5"}, 5),
    "merge onto its base": ("merge out/s.yaml --dir s.d -o out/small.yaml --force",
                            {"s.yaml": "s.yaml", "small.yaml": "small.yaml"}, 5),
    "merge onto a point": ("merge s.yaml --dir s.d -o out/l.h5 --force", {"l.h5": "-> ../s.d/{point}"}, 5),
    "export onto a table": ("export r.h5 --cutlist out/m.csv", {"m.csv": "m.csv"}, 5),
    "export onto itself": ("export out/a.h5 --cutlist out/a.h5 --force", {"a.h5": "r.h5"}, 5),
    "report onto a page": ("report r.h5 -o out/r.html", {"r.html": "r.html"}, 5),
    "report onto itself": ("report out/a.h5 -o out/l.h5 --force", {"a.h5": "r.h5", "l.h5": "-> a.h5"}, 5),
    "evaluate onto itself": ("evaluate ga.yaml --designs out/d.csv -o out/d.csv --force", {"d.csv": "d.csv"}, 5),
    "adjust onto itself": (ADJUST.replace("m.csv", "out/moves.csv") + " --force", {"moves.csv": "m.csv"}, 5),
}

# ---- damage: name: (which file of out/, what is there, commands) ----
# {0} is the damaged file, {1} the whole one.

RESULT = ("show {0}", "show {0} --json", "show {0} --verbose", "diff {0} {1}", "diff {1} {0}",
          "report {0} -o out/p.html", "report {1} {0} -o out/p.html", "export {0} --csv out/csv",
          "export {0} --vtk out/vtk", "export {0} --cutlist out/cut.csv", "export {0} --rf out/rf",
          "run all.yaml -o {0} --quiet", "recover {0}")
FRONT = (*RESULT[:7], "export {0} --front out/front.csv", "run front.yaml -o {0} --quiet",
         "run front.yaml --point {0}:1 -o out/point.h5 --quiet")
SWEEP = ("status s.yaml --dir out/s.d", "status s.yaml --dir out/s.d --json", "merge s.yaml --dir out/s.d -o out/m.h5",
         "sweep s.yaml --dir out/s.d --quiet")
OWN = {name: name for name in ("own.yaml", "nodes.csv", "cables.csv")}
DAMAGED = {
    "result": ("r.h5", {"r.h5": "r.h5"}, RESULT),
    "front": ("f.h5", {"f.h5": "f.h5"}, FRONT),
    "unfinished": ("n.h5", UNFINISHED, ("show {0}", "diff {0} {1}", "recover {0}", "run ga.yaml -o {0} --quiet")),
    "journal": ("n.h5.journal", UNFINISHED, ("recover out/n.h5", "run ga.yaml -o out/n.h5 --quiet")),
    "samples": (TASK % 0, TASKS, ("tolerance cut.yaml -o out/t.h5 --tasks 2 --quiet",
                                  "tolerance cut.yaml -o out/t.h5 --task 0 --tasks 2 --quiet")),
    "ledger": ("s.d/*.tsv", {"s.d": "s.d"}, SWEEP),
    "point": ("s.d/*.h5", {"s.d": "bare.d"}, (SWEEP[0], SWEEP[3])),
    "merge": ("m.h5", {"m.h5": "m.h5"}, ("show {0}", "show {0} --json", "report {0} -o out/p.html", "diff {0} {1}",
                                         "merge s.yaml --dir s.d -o {0}")),
    "adjusted": ("j.h5", {"j.h5": "j.h5"}, (ADJUST.replace("j.h5", "out/j.h5"),)),
    "designs": ("d.csv", {"d.csv": "d.csv"}, ("evaluate ga.yaml --designs {0} -o out/e.csv --quiet",)),
    "measured": ("m.csv", {"m.csv": "m.csv"}, (ADJUST.replace("m.csv", "out/m.csv"),)),
    "nodes": ("nodes.csv", OWN, ("check out/own.yaml", "run out/own.yaml -o out/a.h5 --quiet")),
    "cables": ("cables.csv", OWN, ("check out/own.yaml", "run out/own.yaml -o out/a.h5 --quiet")),
}

# ---- errors that fit a call; others have DEFAULT_ERRORS. EAGAIN of a lock would be an answer: another has it. ----

DEFAULT_ERRORS = "EIO ENOMEM EACCES"
WRITE_ERRORS, SYNC_ERRORS = "ENOSPC EIO EDQUOT EINTR EFBIG", "EIO ENOSPC EDQUOT EINTR"
ERRORS = {
    "open": "EACCES EIO EMFILE ENFILE ENOMEM ENOSPC EDQUOT EINTR",
    "read": "EIO EINTR ENOMEM", "pread": "EIO EINTR ENOMEM", "write": WRITE_ERRORS, "pwrite": WRITE_ERRORS,
    "fsync": SYNC_ERRORS, "fdatasync": SYNC_ERRORS, "close": SYNC_ERRORS, "ftruncate": SYNC_ERRORS,
    "rename": "EIO ENOSPC EACCES EDQUOT", "link": "EIO EPERM ENOSPC EMLINK", "unlink": "EACCES EIO EBUSY",
    "mkdir": "EACCES ENOSPC EIO EDQUOT", "fcntl": "ENOLCK EMFILE EINTR", "flock": "ENOLCK EINTR",
    "mmap": "ENOMEM EAGAIN ENFILE", "getrandom": "EINTR EAGAIN ENOSYS", "socketpair": "EMFILE ENFILE ENOMEM",
    "sendto": "EINTR EPIPE ENOBUFS", "recvfrom": "EINTR ENOMEM", "wait4": "EINTR ECHILD",
    "malloc": "ENOMEM", "calloc": "ENOMEM", "realloc": "ENOMEM", "aligned_alloc": "ENOMEM",
    "pthread_create": "EAGAIN", "fork": "EAGAIN ENOMEM",
}
