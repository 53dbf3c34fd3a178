#!/usr/bin/env python3
"""Draws sentences of hifdm and of SQLite's documentation, mixed, for readers who do not know which is which.

    tools/sample_prose.py --seed 1 --out DIR            writes DIR/sentences.txt and DIR/key.tsv
    tools/sample_prose.py --judge DIR RATING...         prints the share that each reader would rewrite

Half of the sentences are ours, evenly from README, manual, method, architecture, contributing, changelog, help and
explain, schema, messages, pages, Python docstrings and public headers. The others are SQLite's, from the Debian package
sqlite3-doc, which is fetched into build/prose/control. The draw depends on the seed and the texts alone. A rating is
a line "number TAB ok|rewrite TAB why". Ours pass with at most 8 % to rewrite, or no more than the control."""
import argparse
import html.parser
import random
import re
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
CONTROL = TOP / "build" / "prose" / "control"
sys.path.insert(0, str(TOP / "tools" / "prose"))
import strings  # noqa: E402


def sentences(paragraph):
    """Yields the sentences of a paragraph: those with a verb's worth of words that begin and end as sentences do."""
    paragraph = re.sub(r"\s+", " ", paragraph).strip()
    for text in re.split(r"(?<=[.!?])\s+(?=[A-Z\"`'(]|hifdm )", paragraph):
        words = text.split()
        if 6 <= len(words) <= 60 and re.match(r"[A-Z]|hifdm ", text) and re.search(r"[.!?]$", text) and \
                not text.startswith("Pipeline:"):  # a drawing
            yield text


def of_markdown(text):
    text = re.sub(r"^---\n.*?\n---\n|```.*?```|<!--.*?-->|\$\$.*?\$\$", "\n\n", text, flags=re.S)
    for block in re.split(r"\n\s*\n", text):
        lines = [line for line in block.split("\n") if not re.match(r"\s*(\||#|>|!\[)", line)]
        for item in re.split(r"\n\s*(?:[-*]|\d+\.)\s+", "\n" + "\n".join(lines)):
            yield from sentences(re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", item).replace("**", ""))


def join(found):
    """Joins the lines that follow each other to paragraphs."""
    last, words = None, ""
    for i, text in sorted(found, key=lambda item: item[0]):
        if last is not None and i > last + 1:
            yield words
            words = ""
        last, words = i, f"{words} {text}".strip()
    yield words


def of_messages(path):
    """Yields the messages of a C file as a user sees them: with "Error: " and the name of the file in front. They get a
    full stop, and help texts a capital. X stands for an inserted value."""
    code = re.sub(r'"\s*\n\s*"', "", strings.COMMENT.sub("", path.read_text(encoding="utf-8")))
    begin = {"hf_error": "Error: ", "hf_warning": "Warning: "}
    for call in re.finditer(r'(hf_error\b|hf_warning\b|\.help =|\.about =)[^"]*"((?:[^"\\]|\\.)*)"', code):
        text = begin.get(call.group(1), "") + re.sub(r"^%s:(%d:(%d:)?)? ", "FILE: ", call.group(2))
        text = text.replace("%%", "per cent").replace('\\"', '"').replace("\\n", " ")
        text = re.sub(r"%[-+ #0-9.*]*(?:ll|l|z)?[a-zA-Z]", "X", text)
        if text.endswith(": "):
            continue  # the rest is inserted
        for part in re.split(r"(?<=[.!?])\s+(?=[A-Z]|hifdm )", text):
            part = part.strip()
            yield from sentences((part if part.startswith("hifdm ") else part[:1].upper() + part[1:]) +
                                 ("" if part.endswith((".", "!", "?")) else "."))


def ours():
    """Returns {kind: [(source, sentence)]}."""
    def markdown(*patterns):
        paths = sorted(p for pattern in patterns for p in TOP.glob(pattern)
                       if p.name not in ("renames.md", "glossary.md"))
        return [(p.relative_to(TOP), s) for p in paths for s in of_markdown(p.read_text(encoding="utf-8"))]

    found = {"README": markdown("README.md"), "manual": markdown("src/manual/**/*.md"),
             "method": markdown("src/METHOD.md"),
             "architecture": markdown("src/ARCHITECTURE.md"), "contributing": markdown(".github/CONTRIBUTING.md"),
             "changelog": markdown("CHANGELOG.md"), "explain": [
                 (p.relative_to(TOP), s) for p in [TOP / "src/manual/glossary.md"]
                 for s in of_markdown(p.read_text(encoding="utf-8"))], "messages": [
                 (p.relative_to(TOP), s) for p in sorted(TOP.glob("src/**/*.c")) for s in of_messages(p)],
             "schema": markdown("src/case/keys.md")}
    for name, _, lines in strings.texts():
        kind = {"include": "headers", "tools": "docstrings"}.get(name.parts[0])
        if name.suffix in (".html", ".js"):
            kind = "pages"
        if kind:
            texts = [text for _, text in lines] if kind == "pages" else join(list(lines))
            found.setdefault(kind, []).extend((name, s) for words in texts for s in sentences(words))
    return {kind: sorted(set(all_of)) for kind, all_of in found.items() if all_of}


class Text(html.parser.HTMLParser):
    """Collects the text of paragraphs."""

    def __init__(self):
        super().__init__()
        self.found, self.on = [], False

    def handle_starttag(self, tag, attributes):
        if tag in ("p", "li", "dd"):
            self.found.append("")
            self.on = True
        if tag in ("pre", "table", "svg", "h1", "h2", "h3", "script", "style"):
            self.on = False

    def handle_data(self, data):
        if self.on:
            self.found[-1] += data


def control():
    if not list(CONTROL.glob("usr")):
        CONTROL.mkdir(parents=True, exist_ok=True)
        subprocess.run(["apt-get", "download", "sqlite3-doc"], cwd=CONTROL, check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["dpkg", "-x", next(CONTROL.glob("*.deb")), CONTROL], check=True)
    found = []
    for path in sorted(CONTROL.glob("usr/share/doc/sqlite3/*.html")):
        page = Text()
        page.feed(path.read_text(encoding="utf-8", errors="replace"))
        found.extend((path.name, s) for words in page.found for s in sentences(words))
    return sorted(set(found))


def draw(seed, n, out):
    rng, kinds, rows = random.Random(seed), ours(), []
    names = sorted(kinds)
    for i in range(n):
        kind = names[i % len(names)]
        if not kinds[kind]:  # few sentences are of this kind: the largest one takes its turn
            kind = max(names, key=lambda name: len(kinds[name]))
        source, text = kinds[kind].pop(rng.randrange(len(kinds[kind])))
        rows.append(("ours", f"{kind}: {source}", text))
    rows += [("control", source, text) for source, text in rng.sample(control(), n)]
    rng.shuffle(rows)
    out.mkdir(parents=True, exist_ok=True)
    (out / "sentences.txt").write_text("".join(f"{i}\t{row[2]}\n" for i, row in enumerate(rows, 1)), encoding="utf-8")
    key = "".join(f"{i}\t{row[0]}\t{row[1]}\n" for i, row in enumerate(rows, 1))
    (out / "key.tsv").write_text(key, encoding="utf-8")


def judge(folder, ratings):
    key = dict(line.split("\t")[:2] for line in (folder / "key.tsv").read_text(encoding="utf-8").splitlines())
    passed = True
    for path in ratings:
        rows = [line.split("\t") for line in Path(path).read_text(encoding="utf-8").splitlines() if line.strip()]
        if {row[0] for row in rows} != set(key) or any(row[1] not in ("ok", "rewrite") for row in rows):
            sys.exit(f"{path}: has not one line 'number TAB ok|rewrite TAB why' for each of {len(key)} sentences")
        share = {of: sum(key[r[0]] == of and r[1] == "rewrite" for r in rows) / sum(k == of for k in key.values())
                 for of in ("ours", "control")}
        good = share["ours"] <= max(0.08, share["control"])
        passed = passed and good
        print(f"{path}: ours {100 * share['ours']:.0f} % to rewrite, control {100 * share['control']:.0f} %: "
              f"{'passed' if good else 'failed'}")
    sys.exit(0 if passed else 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--n", type=int, default=50, help="sentences of ours, and of the control")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--judge", nargs="+", metavar="DIR RATING")
    o = parser.parse_args()
    if o.judge and len(o.judge) > 1:
        judge(Path(o.judge[0]), o.judge[1:])
    elif o.seed is not None and o.out:
        draw(o.seed, o.n, o.out)
    else:
        parser.error("needs --seed and --out, or --judge with a folder and ratings")


if __name__ == "__main__":
    main()
