"""Makes pages of the manual from long documents such as src/METHOD.md, and the links between all pages."""
import os
import re

LONG = 250  # the parts of a section with more lines become pages of their own


def slug(title):
    """Returns the anchor of a heading, both on our pages and where the source is shown unchanged."""
    return re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")


class Page:
    def __init__(self, name, source, lines):
        self.name = name  # folder/name below the root of the manual, without suffix
        self.source = source  # path in the repository; links are relative to it
        self.lines = lines

    @property
    def title(self):
        return next(line.lstrip("# ").strip() for line in self.lines if line.startswith("# "))


def headings(lines):
    """Yields (number of line, level, title) of all headings outside of fenced blocks."""
    fence = None
    for k, line in enumerate(lines):
        mark = re.match(r"(```+|~~~+)", line)
        if mark and (fence is None or line.strip() == fence):
            fence = mark[1] if fence is None else None
        match = re.match(r"(#{1,6}) (.*)", line)
        if match and fence is None:
            yield k, len(match[1]), match[2]


def promoted(lines, by):
    levels = {k for k, _, _ in headings(lines)}
    return [line[by:] if k in levels else line for k, line in enumerate(lines)]


def split(path, folder):
    """Yields the pages of a document: one for each second-level heading, or one for each part of a long section. The
    text before the first of them is left out. It is a list of contents, and the manual makes its own."""
    lines = open(path, encoding="utf-8").read().split("\n")
    marks = [(k, level, title) for k, level, title in headings(lines) if level in (2, 3)] + [(len(lines), 2, "")]
    sections = [mark for mark in marks if mark[1] == 2]
    for (start, _, title), (end, _, _) in zip(sections, sections[1:]):
        parts = [mark for mark in marks if mark[1] == 3 and start < mark[0] < end]
        if end - start <= LONG:
            parts = []
        cuts = [k for k, _, _ in parts] + [end]
        yield Page(f"{folder}/{slug(title)}", path, promoted(lines[start : cuts[0]], 1))
        for (k, _, part), after in zip(parts, cuts[1:]):
            yield Page(f"{folder}/{slug(part)}", path, promoted(lines[k:after], 2))


class Links:
    """Finds the target of a link of a source in the manual."""

    def __init__(self, pages):
        self.target = {}  # (path in the repository, anchor) -> (page, anchor)
        for page in pages:
            first = True
            self.target.setdefault((page.source, ""), (page.name, ""))
            for _, _, title in headings(page.lines):
                self.target.setdefault((page.source, slug(title)), (page.name, "" if first else slug(title)))
                first = False

    def rewritten(self, page):
        """Yields the lines of a page with links to pages of the manual. Of a link to a file without a page only the
        words remain."""

        def to(name, anchor=""):
            return os.path.relpath(name, os.path.dirname(page.name)) + ".md" + ("#" + anchor if anchor else "")

        def link(match):
            words, target = match[1], match[2]
            if target.startswith("page:"):  # a page that is made
                return f"[{words}]({to(target[5:])})"
            if re.match(r"[a-z]+:", target):
                return match[0]
            path, _, anchor = target.partition("#")
            path = os.path.normpath(os.path.join(os.path.dirname(page.source), path)) if path else page.source
            if path == "README.md":
                return f"[{words}]({to('index')})"
            if (path, anchor) in self.target:
                return f"[{words}]({to(*self.target[path, anchor])})"
            if (path, "") in self.target or not os.path.exists(path):
                raise SystemExit(f"{page.source}: a link to {target}, which does not exist")
            return words

        fence = False
        for line in page.lines:
            fence ^= line.startswith("```")
            yield line if fence or line.startswith("    ") else re.sub(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)", link, line)
