"""Evaluations until targets are reached, as in COCO (Hansen et al., Optimization Methods and Software 36, 2021).

A target is a distance from psi*, the best known psi of a net, in % of psi*. A run reaches the target at the first
evaluation whose psi is at most psi* (1 + target / 100). The expected running time (ERT) is the number of evaluations of
all seeds over the number of seeds that reach the target. A seed that does not reach it counts with all its
evaluations. An optimiser that stops early has fewer of them than the limit."""
import csv
import math
from bisect import bisect_left, bisect_right

LIMIT = 20000  # evaluations of a run
TARGETS_PERCENT = [10 ** (2 - k / 5) for k in range(41)]  # 100 % to 1e-6 %, five to a decade
HEAD = ["net", "optimiser", "variables", "target_percent", "seeds", "successes", "evaluations", "reached_after"]


class Run:
    """The improvements of one run: the evaluations `at`, counted from 1, and the costs (m), both in order."""

    def __init__(self, used=0, at=(), costs_m=()):
        self.used, self.at, self.costs_m = used, list(at), list(costs_m)

    def note(self, costs_m):
        """Adds the costs of the next evaluations. Evaluations after the limit do not count."""
        for cost in costs_m[:LIMIT - self.used]:
            self.used += 1
            if cost < (self.costs_m[-1] if self.costs_m else math.inf):
                self.at.append(self.used)
                self.costs_m.append(cost)

    def best_m(self, evaluations):
        """Returns the minimum cost in the first evaluations."""
        n = bisect_right(self.at, evaluations)
        return self.costs_m[n - 1] if n else math.inf

    def reached(self, cost_m):
        """Returns the first evaluation with at most this cost, or None."""
        i = bisect_left(self.costs_m, -cost_m, key=lambda cost: -cost)
        return self.at[i] if i < len(self.at) else None


def reach(runs, star_m, percent):
    """Returns the evaluations of the runs that reach the target, in ascending order, and those of all runs."""
    first = [run.reached(star_m * (1 + percent / 100)) for run in runs]
    return (sorted(at for at in first if at is not None),
            sum(run.used if at is None else at for run, at in zip(runs, first)))


def running_time(runs, star_m, percent):
    """Returns the ERT. It is infinite if no run reaches the target."""
    hits, evaluations = reach(runs, star_m, percent)
    return evaluations / len(hits) if hits else math.inf


def rows_of(net, key, runs, star_m):
    """Yields a row for each target. After the first target, rows without a success are left out."""
    for percent in TARGETS_PERCENT:
        hits, evaluations = reach(runs, star_m, percent)
        if hits or percent == TARGETS_PERCENT[0]:
            yield [net, *key, f"{percent:.4g}", len(runs), len(hits), evaluations, " ".join(map(str, hits))]


def read_rows(path, head):
    """Returns the rows below the head; none if there is no file. Raises ValueError if the columns differ."""
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
    except FileNotFoundError:
        return []
    if not rows or rows[0] != head:
        raise ValueError(f"{path}: the columns are those of another version. Delete the file, or run without --only.")
    return rows[1:]


def write_rows(path, head, rows, order):
    """Writes the rows in the order of their nets. Rows of other nets are left out."""
    at = {net: i for i, net in enumerate(order)}
    rows = sorted((row for row in rows if row[0] in at), key=lambda row: at[row[0]])
    with open(path, "w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


class Times:
    """The running times of one optimiser on one net."""

    def __init__(self, seeds):
        self.seeds, self.hits, self.ert, self.successes = seeds, [], {}, {}

    def share(self, evaluations):
        """Returns the share of all pairs of target and seed that are reached within the evaluations."""
        return bisect_right(self.hits, evaluations) / (self.seeds * len(TARGETS_PERCENT))


def read_times(path):
    """Returns {net: {(optimiser, variables): Times}}."""
    nets = {}
    for net, optimiser, variables, percent, seeds, successes, evaluations, hits in read_rows(path, HEAD):
        times = nets.setdefault(net, {}).setdefault((optimiser, variables), Times(int(seeds)))
        times.hits.extend(map(int, hits.split()))
        times.successes[percent] = int(successes)
        times.ert[percent] = int(evaluations) / int(successes) if int(successes) else math.inf
    for of_net in nets.values():
        for times in of_net.values():
            times.hits.sort()
    return nets


def mean_share(several, evaluations):
    """Returns the mean of the shares over nets: several Times."""
    return sum(times.share(evaluations) for times in several) / len(several)
