"""Makes reference pages from the headers and from what the program prints about itself (`hifdm schema`, `hifdm
help`)."""
import glob
import os
import re
import subprocess

from split import Page


def ask(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout.rstrip("\n").split("\n")


def plain(text):
    """Returns the text in Markdown that shows it unchanged. What is in backticks is code."""
    return re.sub(r"(`[^`]*`)|([\\`*_<\[\]|#])", lambda m: m[1] or "\\" + m[2], text)


def schema_rows(comments):
    """Yields the keys of the rows of a list. A line "# set: text; required." has the key, and the line below its
    meaning."""
    for line in comments:
        key = re.match(r"  (\w+): (.*)", line)
        if key:
            yield f"\n`{key[1]}` – {plain(key[2].rstrip('.'))}"
        else:
            yield f": {plain(line.strip())}\n"


def schema(program):
    """Returns the keys of a case file by section. Every key has a comment with its meaning and one with its range."""
    lines = ["# Keys of a case file", "", "As `hifdm schema` prints them, which is a case file itself: a key, what it",
             "may be, and its default. The unit is the last part of a name.", ""]
    said, path = [], []
    for line in ask(program, "schema")[1:]:
        if not line.strip():
            continue
        key = re.match(r"( *)(# )?(\w+):(?: (.*))?$", line)
        if key and key[2] and not (said and said[-1].endswith("may be left out")):
            key = None
        if not key:
            said.append(line.strip()[2:])
            continue
        depth, name, default = len(key[1]) // 2, key[3], key[4]
        path[depth:] = [name]
        full = ".".join(path)
        if len(said) == 1:  # a section
            lines += [f"{'##' if depth == 0 else '###'} `{full}`", "", plain(said[0]), ""]
        elif len(said) > 2 and " rows " in said[1]:  # a list
            lines += [f"### `{full}`", "", plain(said[0]), "", plain(said[1].capitalize())]
            lines += [*schema_rows(said[2:]), ""]
        else:
            shown = f"; default `{default}`" if default else ""
            lines += [f"`{name}` – {plain(said[-1])}{shown}", f": {plain(' '.join(said[:-1]))}", ""]
        said = []
    return Page("reference/keys", "src/manual/index.md", lines)


def command_help(program, name):
    """Returns one command: its usage, what it does, options, examples."""
    usage, *rest = ask(program, "help", name)
    lines, option, examples = [f"## `{usage.split(' [OPTION]')[0]}`", ""], [], []
    part = "about"
    for line in rest:
        if line.startswith("Options"):
            part = "options"
        elif line.startswith("Examples"):
            part = "examples"
        elif part == "about":
            lines.append(plain(line.strip()))
        elif part == "examples" and line:
            examples.append("$ " + line.strip())
        elif part == "options" and re.match(r"  -", line):
            word, _, meaning = line.strip().partition("  ")
            option.append([word, [meaning.strip()]])
        elif part == "options" and line.strip():
            option[-1][1].append(line.strip())
    lines.append("")
    for word, meaning in option:
        lines += [f"`{word}`", f": {plain(' '.join(meaning).strip())}", ""]
    if examples:
        lines += ["```console", *examples, "```", ""]
    return lines


def commands(program):
    names = [line.split()[1] for line in ask(program, "help") if re.match(r"  hifdm [a-z]+ ", line)]
    lines = ["# Commands and options", "", "As `hifdm help COMMAND` prints them.", ""]
    for name in names:
        lines += command_help(program, name)
    return Page("reference/commands", "src/manual/index.md", lines)


def headers():
    """Returns a page for each public header, and one that lists the headers with their first comments."""
    lines = ["# Headers", "", "The library's interface, header by header: shapes, units and errors stand in the",
             "comments. `make api` makes pages of them with links between types and functions.", ""]
    pages = []
    for path in sorted(glob.glob("include/hifdm/*.h")):
        text = open(path, encoding="utf-8").read()
        name = os.path.basename(path)
        first = re.match(r"/\* \w+ - (.*?)(?:\.\s|:\s|;\s|\*/)", text, re.S)
        what = plain(" ".join(first[1].replace("\n *", " ").split())) if first else ""
        lines += [f"[`{name}`](page:reference/headers/{name[:-2]})", f": {what}", ""]
        page = [f"# `{name}`", "", "```c", *text.split("\n"), "```"]
        pages.append(Page(f"reference/headers/{name[:-2]}", path, page))
    contents = [f"headers/{page.name.rsplit('/', 1)[1]}" for page in pages]
    lines += ["```{toctree}", ":hidden:", "", *contents, "```"]
    return [Page("reference/headers", "src/manual/index.md", lines), *pages]
