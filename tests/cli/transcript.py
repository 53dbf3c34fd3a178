#!/usr/bin/env python3
"""Checks that the program prints what a transcript says. A transcript is a file of commands with their output.

    transcript.py FILE PROGRAM WORK            prints the differences and exits with status 1 if there are any
    transcript.py FILE PROGRAM WORK --write    writes the output of the program into FILE

The lines before the first command describe the file. A command is a line "$ ..." for sh, and lines "> ..." continue it.
The commands of a file run in one folder of their own. The output follows the command. Lines of standard error begin
with "! ", and the exit status is "[exit 2]" unless it is 0. In addition to hifdm there are three commands of this
script that make files comparable: `contents` lists a result, `files` lists tables and folders, and `page` prints what a
reader of a report sees.

What differs between two runs is masked: times, memory, rates, paths and versions. Two numbers are equal if they differ
by at most 1e-6 of them or by one unit of their last digit. Two numbers below 1e-9 are equal, too, because they are
rounding errors of sums. Error bounds are equal within a factor of 2. Whole numbers must be equal."""

import difflib
import json
import os
import re
import subprocess
import sys
import time
import zlib
from html.parser import HTMLParser
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w]*[\d_])")
MASKS = [
    (re.compile(r'((?:left|evaluations_per)_s": )[\d.e+-]+'), r"\1TIME"),
    (re.compile(r"the first \d+ tried"), "the first N tried"),
    (re.compile(r"(\(wall_s \* threads\) =) [\d.]+"), r"\1 PART"),
    (re.compile(r'("version": )"[^"]*"'), r'\1"VERSION"'),
    (re.compile(r"\b\d+ h \d+ min\b|\b\d+ min \d+ s\b"), "TIME"),
    (re.compile(r"\b\d+(?:\.\d+)? (?:ns|us|ms|s|min|h|d)\b(?! at| each)"), "TIME"),
    (re.compile(r"(TIME a step; about TIME) for (?:some )?\d+ steps?"), r"\1 for STEPS"),
    (re.compile(r"ended early: (?:some|with errors as they are at most about) TIME"), "ended early: TIME"),
    (re.compile(r'(condition"?:? )[\d.e+]+'), r"\1CONDITION"),
    (re.compile(r"\b\d+(?:\.\d+)? (?:B|kB|MB|GB)\b"), "BYTES"),
    (re.compile(r"\b[\d.]+ (designs|evaluations|solves|samples|nets|points)(/| per )(s|second)\b"), r"RATE \1"),
    (re.compile(r"\b\d{4}-\d\d-\d\dT?[ \d:.]*Z?"), "DATE"),
    (re.compile(r"\b[0-9a-f]{64}\b"), "SHA256"),
]
MEASURED = re.compile(r'((?:wall|cpu|elapsed)_s"?: )([-\d.e+]+|nan)')
BOUND = re.compile(r"(?:_bound_m\"?(?::| =)|no node is farther than|is right to) (-?[\d.]+(?:e[-+]?\d+)?)")
PROVENANCE = {"argv", "build_flags", "compiler", "git_describe", "gsl_version", "hdf5_version", "host", "lapack",
              "program", "version"}


def commands_of(text):
    """Returns the text before the first command, and pairs of a command and its output."""
    head, found = [], []
    for line in text.splitlines():
        if line.startswith("$ "):
            found.append([[line], []])
        elif found and line.startswith("> ") and not found[-1][1]:
            found[-1][0].append(line)
        elif found:
            found[-1][1].append(line)
        else:
            head.append(line)
    return head, found


def masked(text, work, longest_s):
    """Returns the text without what differs between two runs. Measured times are masked if they can be right."""
    text = MEASURED.sub(lambda m: m[1] + "TIME" if 0 <= float(m[2]) <= longest_s else m[0], text)
    text = text.replace(f"{work}/", "").replace(str(work), ".").replace(f"{TOP}/", "TOP/")
    for pattern, word in MASKS:
        text = pattern.sub(word, text)
    return text


def run(command, work, environment, start_s):
    script = "\n".join(line[2:] for line in command) + "\n"
    done = subprocess.run(["sh", "-c", script], cwd=work, env=environment, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, errors="backslashreplace", check=False)
    longest_s = 2 * (time.monotonic() - start_s)  # of two threads
    lines = masked(done.stdout, work, longest_s).splitlines()
    lines += ["! " + s for s in masked(done.stderr, work, longest_s).splitlines()]
    return [s.rstrip() for s in lines] + ([f"[exit {done.returncode}]"] if done.returncode else [])


def same_number(a, b):
    if re.fullmatch(r"-?\d+", a) and re.fullmatch(r"-?\d+", b):
        return a == b
    x, y = float(a), float(b)
    unit = max(last_digit(a), last_digit(b))
    return abs(x - y) <= max(1e-6 * abs(x), 1.001 * unit if unit < 1e-3 * abs(x) else 0) or max(abs(x), abs(y)) < 1e-9


def last_digit(number):
    mantissa, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def same_line(a, b):
    if a == b:
        return True
    bounds = [[float(x) for x in BOUND.findall(line)] for line in (a, b)]
    if any(not 0.5 * x <= y <= 2 * x for x, y in zip(*bounds)):
        return False
    return re.split(r"\s+", NUMBER.sub("0", a)) == re.split(r"\s+", NUMBER.sub("0", b)) and all(
        same_number(x, y) for x, y in zip(NUMBER.findall(a), NUMBER.findall(b)))


def with_tools(work, program):
    """Makes a folder with hifdm and the commands of this script. It is not in the folder of the commands. Returns the
    environment for them."""
    tools = Path(f"{work}.tools")
    tools.mkdir()
    (tools / "hifdm").symlink_to(program)
    for name in ("contents", "files", "page"):
        (tools / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" "{__file__}" {name} "$@"\n')
        (tools / name).chmod(0o755)
    return dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}", HIFDM_TOP=str(TOP))


def main(path, program, work, write=False):
    work = Path(work).resolve()
    work.mkdir()
    environment, start_s = with_tools(work, Path(program).resolve()), time.monotonic()
    head, commands = commands_of(Path(path).read_text())
    if not commands:
        sys.exit(f"{path}: has no command")
    new, n_different = list(head), 0
    for command, was in commands:
        now = run(command, work, environment, start_s)
        new += command + now
        if not write and (len(now) != len(was) or not all(map(same_line, was, now))):
            n_different += 1
            alike = [b if a is not None and same_line(a, b) else None for a, b in zip(was, now)]
            kept = [a if s is not None else b for a, b, s in zip(was, now, alike)] + now[len(was):]
            print(*command, *difflib.unified_diff(was, kept, "before", "now", lineterm="", n=1), sep="\n")
    if write:
        Path(path).write_text("\n".join(new) + "\n")
    return n_different


# ---- commands of transcripts ----

def digest(values):
    """Returns how many numbers there are, the sum of their absolute values, each weighted by its index, and how many
    are negative."""
    weight = [1 + (7 * i % 11) / 11 for i in range(len(values))]
    total = sum(w * abs(v) for w, v in zip(weight, values) if v == v and abs(v) != float("inf"))
    odd = sum(v != v or abs(v) == float("inf") for v in values)
    return f"{len(values)} sum {total:.9g} negative {sum(v < -1e-9 for v in values)}" + (f" nan {odd}" if odd else "")


def of_text(texts):
    return f"{len(texts)} crc {zlib.crc32(chr(0).join(texts).encode()):08x}"


def number_or_none(text):
    try:
        return float(text)
    except ValueError:
        return None


def contents(path):
    import h5py
    import numpy as np

    def shown(value):
        value = np.asarray(value)
        if value.dtype.kind in "SO":
            texts = [v.decode() if isinstance(v, bytes) else str(v) for v in value.ravel()]
            return repr(texts[0]) if len(texts) == 1 and len(texts[0]) < 200 else of_text(texts)
        if value.dtype.kind not in "biuf":
            return of_text([str(value)])
        if value.size == 1:
            return f"{value.ravel()[0]:.9g}" if value.dtype.kind == "f" else str(value.ravel()[0])
        return digest([float(v) for v in value.ravel()])

    def timed(name):
        return name.endswith(("_s", "_utc", "condition", "bytes")) or name in PROVENANCE or "identity" in name

    def visit(name, node):
        for key, value in sorted(node.attrs.items()):
            if key.endswith(("wall_s", "cpu_s")):
                print(f"{name}@{key}: {value:.9g}")
            if not timed(key) and key not in ("description", "units"):
                print(f"{name}@{key} = {shown(value)}")
        if isinstance(node, h5py.Dataset):
            words = [str(node.attrs[k].decode() if isinstance(node.attrs[k], bytes) else node.attrs[k])
                     for k in ("units", "description") if k in node.attrs]
            fields = node.dtype.names
            if fields:
                for field in fields:
                    print(f"{name}.{field} {node.dtype[field]} {node.shape}",
                          "" if timed(field) else shown(node[field]))
            else:
                print(f"{name} {node.dtype} {node.shape}", "" if timed(name) else shown(node[()]),
                      zlib.crc32("".join(words).encode()) if words else "no units")

    with h5py.File(path) as f:
        visit("", f)
        f.visititems(visit)


def table(path):
    lines = path.read_text(errors="backslashreplace").splitlines()
    cut = "," if path.suffix == ".csv" else None
    body = [line for line in lines if not line.startswith("#")]
    print(f"{path}: {len(lines)} lines, {body[0] if cut else of_text(body[:1])}")
    if cut:
        for i, name in enumerate(body[0].split(",")):
            column = [row[i] for row in (line.split(",") for line in body[1:]) if i < len(row)]
            numbers = [number_or_none(v) for v in column]
            print(f"  {name}:", of_text(column) if None in numbers else digest(numbers))
    else:
        words = " ".join(body).split()
        numbers = [number_or_none(w) for w in words]
        texts = [w for w, v in zip(words, numbers) if v is None]
        print(" ", digest([v for v in numbers if v is not None]), of_text(texts))


def files(*paths):
    for path in map(Path, paths):
        for file in sorted(p for p in ([path] if path.is_file() else path.rglob("*")) if p.is_file()):
            if file.suffix in (".vtkhdf", ".h5"):
                print(f"{file}:")
                contents(file)
            else:
                table(file)


class Page(HTMLParser):
    """The text of a page by line, the elements of each drawing with their numbers, and the numbers and texts of data by
    key."""

    def __init__(self):
        super().__init__()
        self.inside, self.kind, self.line, self.numbers, self.tags = [], None, "", [], {}

    def handle_starttag(self, tag, attrs):
        self.kind = dict(attrs).get("type") if tag == "script" else self.kind
        if tag in ("script", "style", "svg"):
            self.flush()
            self.inside.append(tag)
        if "svg" in self.inside:
            self.tags[tag] = self.tags.get(tag, 0) + 1
            for name, value in attrs:
                if name not in ("id", "class", "style", "xmlns"):
                    self.numbers += [float(n) for n in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", value or "")]
        elif tag in ("p", "div", "h1", "h2", "h3", "tr", "li", "section", "pre", "table", "label", "button", "figure"):
            self.flush()
        else:
            self.line += " "

    def handle_endtag(self, tag):
        if self.inside and self.inside[-1] == tag:
            self.inside.pop()
            if tag == "svg":
                print("  drawing:", *(f"{n} {t}," for t, n in sorted(self.tags.items())), digest(self.numbers))
                self.tags, self.numbers = {}, []

    def handle_data(self, data):
        if self.inside and self.inside[-1] == "script":
            if self.kind == "application/json":
                by_key(json.loads(data), "")
        elif not self.inside or self.inside[-1] != "style":
            self.line += data

    def flush(self):
        for line in self.line.splitlines():
            if line.strip():
                print(re.sub(r"\s+", " ", line.strip()))
        self.line = ""


def by_key(value, name):
    if isinstance(value, dict):
        for key, part in value.items():
            if key not in ("provenance", "version", "summary", "words"):
                by_key(part, f"{name}.{key}")
    elif isinstance(value, list):
        flat = []

        def collect(part):
            for one in part:
                collect(one.values() if isinstance(one, dict) else one) if isinstance(one, (list, dict)) else \
                    flat.append(one)
        collect(value)
        numbers = [float(v) for v in flat if isinstance(v, (int, float))]
        texts = [str(v) for v in flat if not isinstance(v, (int, float))]
        print(f"  {name}: {len(value)}", digest(numbers) if numbers else "", of_text(texts) if texts else "")
    else:
        print(f"  {name}: {json.dumps(value)}")


def page(path):
    reader = Page()
    reader.feed(Path(path).read_text())
    reader.flush()


if __name__ == "__main__":
    if sys.argv[1] in ("contents", "files", "page"):
        sys.exit(globals()[sys.argv[1]](*sys.argv[2:]))
    sys.exit(main(*sys.argv[1:4], write=sys.argv[4:] == ["--write"]) != 0)
