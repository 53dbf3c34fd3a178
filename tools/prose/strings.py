#!/usr/bin/env python3
"""Writes the texts of the program as Markdown for the linter of `make prose`.

    tools/prose/strings.py OUT

Each source gets a file OUT/PATH.md with the same number of lines. A line holds the words that the source has there:
string literals of C and JavaScript with a blank in them, comments of public headers, text of HTML, and docstrings of
Python. All other lines are empty, so the linter reports the line of the source."""
import ast
import html.parser
import re
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.S)
MARKS = re.compile(r"%[-+ #0-9.*]*(?:l|ll|h|z)?[a-zA-Z]|\\[nt\"]|[<>*_#`|\[\]{}~$]")


def blank(text):
    return re.sub(r"[^\n]", " ", text)


def of_c(text, is_header):
    """Yields (line, words) of the string literals, and of the comments of a public header."""
    if is_header:
        for comment in COMMENT.finditer(text):
            first = text.count("\n", 0, comment.start())
            for i, line in enumerate(comment.group().split("\n")):
                yield first + i, line.strip(" /*")
    code = COMMENT.sub(lambda m: blank(m.group()), text)
    for i, line in enumerate(code.split("\n")):
        if not line.startswith("#include"):
            for literal in LITERAL.findall(line):
                if " " in literal.strip(): # others are names, also those of 0.2
                    yield i, literal


def of_script(text):
    code = COMMENT.sub(lambda m: blank(m.group()), text)
    for i, line in enumerate(code.split("\n")):
        for words in re.findall(r"\"((?:[^\"\\]|\\.)*)\"|'((?:[^'\\]|\\.)*)'|`((?:[^`\\]|\\.)*)`", line):
            yield i, re.sub(r"\$\{[^}]*\}", "X", "".join(words))


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.found = []

    def handle_data(self, data):
        self.found.extend((self.getpos()[0] - 1 + i, line) for i, line in enumerate(data.split("\n")))


def of_page(text):
    page = Page()
    page.feed(text)
    return page.found


def of_python(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node):
            for i, line in enumerate(node.body[0].value.value.split("\n")):
                yield node.body[0].lineno - 1 + i, line


def texts():
    """Yields (path, [(line, words)])."""
    for path in sorted([*TOP.glob("src/**/*.[ch]"), *TOP.glob("include/**/*.h"), *TOP.glob("src/out/report/*"),
                        *TOP.glob("tools/python/**/*.py")]):
        text, name = path.read_text(encoding="utf-8"), path.relative_to(TOP)
        kind = path.suffix
        found = (of_c(text, name.parts[0] == "include") if kind in (".c", ".h") else
                 of_script(text) if kind == ".js" else
                 of_page(text) if kind == ".html" else of_python(text) if kind == ".py" else [])
        yield name, text.count("\n") + 1, found


def main(out):
    for name, n_line, found in texts():
        lines = [""] * n_line
        for i, words in found:
            words = MARKS.sub(" ", words).strip()
            if re.search(r"[a-zA-Z] +[a-zA-Z]", words):
                lines[i] += (" " if lines[i] else "") + words
        path = Path(out) / f"{name}.md"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
