"""The manual, `make docs`: build.py --program build/hifdm --version 0.1.0 --work FOLDER --out FOLDER.

Pages are those of src/manual, the sections of src/MANUAL.md, src/METHOD.md and src/ARCHITECTURE.md, the tables in
results/chen2022, and what the program prints about itself. Sphinx turns them into HTML; its warnings are errors."""
import argparse
import glob
import os
import re
import shutil
import subprocess
import sys

import check
import reference
from split import Links, Page, coloured, split


def read(path, name):
    return Page(name, path, open(path, encoding="utf-8").read().split("\n"))


def all_pages(program):
    guide = list(split("src/MANUAL.md", "guide"))
    for page in guide:
        page.lines = coloured(page.lines)
    method = list(split("src/METHOD.md", "method"))
    paths = sorted(glob.glob("src/manual/**/*.md", recursive=True))
    written = [read(path, path[len("src/manual/") : -3]) for path in paths]
    paper = [read(f"results/chen2022/{name}.md", f"paper/{name}") for name in ("table", "search")]
    inside = [read("src/ARCHITECTURE.md", "inside")]
    made = [reference.schema(program), reference.commands(program), *reference.headers()]
    return guide, method, written + paper + inside + made


def contents(line, guide, method):
    """`@guide` and `@method` in a list of contents stand for the pages of a document."""
    pages = {"@guide": guide, "@method": method}.get(line.strip())
    return ["/" + page.name for page in pages] if pages else [line]


def write(pages, guide, method, work):
    links = Links(pages)
    for page in pages:
        path = f"{work}/{page.name}.md"
        os.makedirs(os.path.dirname(path), exist_ok=True)
        lines = [more for line in links.rewritten(page) for more in contents(line, guide, method)]
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines))
        for picture in re.findall(r"!\[[^\]]*\]\(([^)\s]+)\)", "\n".join(page.lines)):
            source = os.path.join(os.path.dirname(page.source), picture)
            if os.path.exists(source):
                shutil.copy(source, os.path.dirname(path))


def mend_theme(out):
    """What Debian 12 makes of furo 2022.12: a style sheet and a script that ask a server for their parts, which a page
    opened from a disk has not; and the dark colours only by the button, not where the system is set to dark."""
    style, script = f"{out}/_static/styles/furo.css", f"{out}/_static/scripts/furo.js"
    text = open(style, encoding="utf-8").read()
    text = re.sub(r"@import url\([^)]*\);\n?", "", text)
    if "prefers-color-scheme" not in text:
        dark = re.search(r'body\[data-theme="dark"\] (\{\s*--[^}]*\})', text)
        text += f'@media screen and (prefers-color-scheme: dark) {{ body:not([data-theme="light"]) {dark[1]} }}\n'
    open(style, "w", encoding="utf-8").write(text)
    text = open(script, encoding="utf-8").read()
    part = re.match(r'import Gumshoe from "\./(.*)";\n', text)
    if part:
        gumshoe = open(f"{out}/_static/scripts/{part[1]}", encoding="utf-8").read()
        open(script, "w", encoding="utf-8").write(gumshoe + text[part.end() :])


def main():
    parser = argparse.ArgumentParser()
    for name in ("program", "version", "work", "out"):
        parser.add_argument(f"--{name}", required=True)
    a = parser.parse_args()
    shutil.rmtree(a.work, ignore_errors=True)
    shutil.rmtree(a.out, ignore_errors=True)
    os.makedirs(f"{a.work}/_static")
    for name in ("conf.py", "style.css"):
        shutil.copy(f"tools/docs/{name}", a.work if name == "conf.py" else f"{a.work}/_static")
    guide, method, others = all_pages(os.path.abspath(a.program))
    write(guide + method + others, guide, method, a.work)
    sphinx = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-d", f"{a.work}/.doctrees", a.work, a.out]
    subprocess.run(sphinx, check=True, env={**os.environ, "HIFDM_VERSION": a.version})
    shutil.rmtree(f"{a.out}/.doctrees", ignore_errors=True)
    mend_theme(a.out)
    found = sorted(set(check.faults(a.out)))
    if found:
        sys.exit("\n".join(found))
    print(f"{a.out}/index.html: {len(guide + method + others)} pages")


if __name__ == "__main__":
    main()
