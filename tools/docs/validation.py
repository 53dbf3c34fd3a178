"""Makes the page of validation: every figure that the suites below have compared with a source (tests/figures.h)."""
import os
import re
import subprocess

from reference import plain as escaped
from split import Page

SUITES = "verify cli/reflectors cli/tolerance cli/limits cli/workshop"


def run_suites(make, file):
    if os.path.exists(file):
        os.remove(file)
    done = subprocess.run([*make.split(), "-s", "test", f"SUITE={SUITES}"], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, env={**os.environ, "HIFDM_FIGURES": os.path.abspath(file)})
    if done.returncode:
        raise SystemExit(done.stdout)


def measured(make, file):
    """Runs the suites, which append one line per figure to the file. A failure stops here. HIFDM_FIGURES may name a
    file of all tests that have just been run; then the suites do not run."""
    given = os.environ.get("HIFDM_FIGURES")
    if given:
        file = given
    else:
        run_suites(make, file)
    rows = {}  # for a figure with several cases the worst one remains
    for line in open(file, encoding="utf-8"):
        r = line.rstrip("\n").split("\t")
        key = tuple(r[:4])
        if key not in rows or abs(float(r[4]) - float(r[5])) > abs(float(rows[key][4]) - float(rows[key][5])):
            rows[key] = r
    return sorted(rows.values(), key=lambda r: (r[0], natural(r)))


def natural(row):
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", row[1] + row[3])]


def said_on_top(path):
    """Returns the first comment or docstring of a test: its title, and its paragraphs in Markdown."""
    text = open(path, encoding="utf-8").read()
    if path.endswith(".py"):
        top = re.match(r'(?:#[^\n]*\n)*"""(?:\w+\.py [A-Z_ ]+: )?(.*?)"""', text, re.S)[1]
    else:
        top = re.sub(r"(?m)^ \* ?", "", re.match(r"/\* (.*?)\*/", text, re.S)[1])
    paragraphs = [p.strip("\n") for p in top.split("\n\n") if not re.match(r"\s+\w+\.py ", p)]  # usages are left out
    title = re.split(r"[:.](?:\s|$)", " ".join(paragraphs[0].split()))[0]
    return title, [p if p.startswith("    ") else plain(" ".join(p.split())) for p in paragraphs]


def plain(text):
    """Returns a text that is shown unchanged, except for `names`."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(part if part.startswith("`") else escaped(part) for part in parts)


def shown(value):
    return f"{float(value):.7g}"


def table(rows):
    """Returns a table of figures and those of the source; for many figures at once only the maximum difference."""
    lines = []
    for kind, figure, ours, reference, tolerance in rows:
        difference = float(ours) - float(reference)
        if kind == "worst":
            lines.append(f"| {plain(figure)} | | | {difference:.1e} | {float(tolerance):.1e} |")
            continue
        limit = {"=": f"{float(tolerance):.2g}", "<=": "at most the source's", "not met": "**not met**"}[kind]
        lines.append(f"| {plain(figure)} | {shown(ours)} | {shown(reference)} | {difference:+.1e} | {limit} |")
    if all(kind == "worst" for kind, *_ in rows):
        lines = [line.replace(" | | | ", " | ") for line in lines]
        return ["| figures | maximum difference | tolerance |", "|---|---|---|", *lines, ""]
    return ["| figure | hifdm | source | difference | tolerance |", "|---|---|---|---|---|", *lines, ""]


def page(make, work):
    rows = measured(make, f"{work}/figures.tsv")
    if not rows:
        raise SystemExit("no figures were measured")
    worst = sum(kind == "worst" for _, _, kind, *_ in rows)
    missed = sum(kind == "not met" for _, _, kind, *_ in rows)
    lines = ["# Figures compared with cited sources", "",
             "This page compares figures of the tests with figures of cited sources. The tests ran when this page was "
             "made, with the program of this manual.", "",
             f"There are {len(rows)} comparisons. {worst} of them give only the maximum difference of many figures, "
             f"and {missed} figures are not met. If any other figure is outside its tolerance, `make docs` stops. The "
             "tolerance is half a unit of the last digit that the source prints, or the value that the test states.",
             ""]
    for path in sorted({r[0] for r in rows}):
        title, paragraphs = said_on_top(path)
        lines += [f"## {plain(title)}", ""]
        for paragraph in paragraphs[paragraphs[0].rstrip(".:") == plain(title) :]:
            lines += [paragraph, ""]
        lines += [f"In `{path}`:", "", *table([(kind, *values) for file, _, kind, *values in rows if file == path])]
    return Page("validation", "src/manual/index.md", lines)
