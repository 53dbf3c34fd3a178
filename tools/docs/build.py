"""Makes the manual, `make docs`: build.py --program build/hifdm --version 0.1.0 --make make --work FOLDER --out FOLDER.

The pages are those of src/manual, the sections of src/METHOD.md, src/ARCHITECTURE.md, the tables in results/chen2022,
and what the program prints about itself. src/manual/index.md lists them; a page that it does not list is an error.
Sphinx makes HTML of them; its warnings are errors."""
import argparse
import glob
import json
import os
import re
import shutil
import subprocess
import sys

import blocks
import check
import reference
import validation
from split import Links, Page, split


def read(path, name):
    return Page(name, path, open(path, encoding="utf-8").read().split("\n"))


def written(program, work):
    """Returns the pages of src/manual with the output of their commands, and the pages of hifdm report that they
    made."""
    pages = []
    for path in sorted(glob.glob("src/manual/**/*.md", recursive=True)):
        name = path[len("src/manual/") : -3]
        folder = f"{work}.run/{name.replace('/', '-')}"
        page = Page(name, path, blocks.run_page(path, folder, program))
        page.folder = folder
        pages.append(page)
    return pages


def report_parts(pages, work):
    """Replaces each ![words](report:FILE.html#PART) by a picture of a part of a page of `hifdm report` and a link to
    the whole page. ?press=LABEL takes the picture after pressing a button; ?only=ELEMENT takes the first such element
    in the part. Returns what must be drawn."""
    wanted = []
    for page in pages:
        for k, line in enumerate(page.lines):
            match = re.match(r"!\[(.*)\]\(report:([\w-]+)\.html#([\w-]+)(?:\?(press|only)=(\w+))?\)$", line)
            if match:
                words, report, part, option, value = match.groups()
                name = f"{page.name.replace('/', '-')}-{report}"
                shutil.copy(f"{page.folder}/{report}.html", f"{work}/_static/{name}.html")
                file = f"_static/{name}-{part}.png"
                wanted.append({"page": f"{page.folder}/{report}.html", "part": f"#{part}", "file": f"{work}/{file}",
                               **({option: value} if option else {})})
                up = "../" * page.name.count("/")
                page.lines[k] = (f"![{words}](/{file})\n\n" if browser() else "") + (
                    f'*{words}.* <a href="{up}_static/{name}.html">The whole page</a>.')
    return wanted


def browser():
    return all(shutil.which(name) for name in ("chromium", "node", "npm"))


def draw(wanted, work, build):
    if not wanted:
        return
    if not browser():
        print("the manual has no pictures: no chromium, node or npm")
        if os.environ.get("HIFDM_NO_SKIP"):
            sys.exit(1)
        return
    with open(f"{work}.run/pictures.json", "w", encoding="utf-8") as file:
        json.dump(wanted, file)
    command = ["tests/browser/run.sh", "--node", "tools/docs/pictures.mjs", f"{work}.run/pictures.json"]
    subprocess.run(command, check=True, env={**os.environ, "BUILD": build})


def all_pages(program, make, work):
    method = list(split("src/METHOD.md", "method"))
    ours = written(program, work)
    draw(report_parts(ours, work), work, os.path.dirname(work))
    paper = [read(f"results/chen2022/{name}.md", f"paper/{name}") for name in ("table", "search", "dense")]
    inside = [read("src/ARCHITECTURE.md", "inside")]
    made = [validation.page(make, f"{work}.run"), reference.schema(program), reference.commands(program)]
    made += reference.headers()
    return method, ours + paper + inside + made


def contents(line, method):
    """Returns the pages that `@method` in a list of contents stands for, or the line itself."""
    return ["/" + page.name for page in method] if line == "@method" else [line]


def write(pages, method, work):
    links = Links(pages)
    for page in pages:
        path = f"{work}/{page.name}.md"
        os.makedirs(os.path.dirname(path), exist_ok=True)
        lines = [more for line in links.rewritten(page) for more in contents(line, method)]
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines))
        for picture in re.findall(r"!\[[^\]]*\]\(([^)\s]+)\)", "\n".join(page.lines)):
            source = os.path.join(os.path.dirname(page.source), picture)
            if os.path.exists(source):
                shutil.copy(source, os.path.dirname(path))


def mend_theme(out):
    """Corrects what Debian 12 makes of furo 2022.12. A style sheet and a script ask a server for their parts, but a
    page that is opened from a disk has no server. The dark colours follow only the button, and not a system that is set
    to dark."""
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
    for name in ("program", "version", "make", "work", "out"):
        parser.add_argument(f"--{name}", required=True)
    a = parser.parse_args()
    shutil.rmtree(a.work, ignore_errors=True)
    shutil.rmtree(a.out, ignore_errors=True)
    os.makedirs(f"{a.work}/_static")
    for name in ("conf.py", "style.css"):
        shutil.copy(f"tools/docs/{name}", a.work if name == "conf.py" else f"{a.work}/_static")
    method, others = all_pages(a.program, a.make, a.work)
    write(method + others, method, a.work)
    sphinx = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-d", f"{a.work}/.doctrees", a.work, a.out]
    subprocess.run(sphinx, check=True, env={**os.environ, "HIFDM_VERSION": a.version})
    shutil.rmtree(f"{a.out}/.doctrees", ignore_errors=True)
    mend_theme(a.out)
    found = sorted(set(check.faults(a.out)))
    if found:
        sys.exit("\n".join(found))
    print(f"{a.out}/index.html: {len(method + others)} pages")


if __name__ == "__main__":
    main()
