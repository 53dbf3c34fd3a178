"""Runs a whole case with its progress, and reads its result.

    python3 tools/python/examples/run_and_read.py configs/straight-edges.yaml RESULT.h5 [PICTURE.png]
"""
import sys

import hifdm


def progress(now):
    if now.phase == "search" and now.done % 10 == 0:
        print(f"generation {now.done} of {now.all}: psi {now.best_psi_m * 1e3:.4f} mm")
    return now.elapsed_s < 60  # False stops the run; a call without restart resumes it


if len(sys.argv) < 3:
    sys.exit("usage:" + __doc__.split("\n\n")[1].rstrip())
case = hifdm.open(sys.argv[1], {"optimize.generations": 40})
run = case.run(sys.argv[2], restart=True, progress=progress)
print(f"{run.status}: psi {run['form']['psi_m'] * 1e3:.4f} mm -> {run['search']['psi_m'] * 1e3:.4f} mm")
with run.read() as result:
    shape = result.shape("search")
    print(f"tensions from {shape.tension_N.min():.2f} to {shape.tension_N.max():.2f} N; {', '.join(result.stages)}")
    if len(sys.argv) > 3:
        hifdm.plot_generations(result.best_psi_m).figure.savefig(sys.argv[3])
