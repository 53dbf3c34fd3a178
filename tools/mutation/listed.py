"""Reads the lists of edits: tests/mutants.txt and tests/mutants_equivalent.txt."""

import re
import sys


class Mutant:
    def __init__(self, name, path, words, where):
        self.name, self.path, self.words, self.where = name, path, words, where
        self.old, self.new = [], []

    def edited(self, text):
        """Returns the text with the old lines, which must occur once, replaced. Indentation does not count."""
        pattern = r"\n[ \t]*".join(re.escape(part) for part in self.old)
        found = re.findall(pattern, text)
        if len(found) != 1:
            n = len(found)
            sys.exit(f"{self.where}: {self.name}: its old text stands {n} times in {self.path}")
        new = "\n".join(self.new)
        return re.sub(pattern, lambda _: new, text)


def read_mutants(top, name):
    """Returns the rows of a list: NAME FILE: WORD..., which may continue in indented lines, then '- old' and '+ new'.
    Each edit must apply to the sources."""
    mutants = []
    for n, line in enumerate((top / name).read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        if line[0] in "-+":
            (mutants[-1].old if line[0] == "-" else mutants[-1].new).append(line[2:].strip())
        elif line.startswith("    "):
            mutants[-1].words += line.split()
        else:
            head, _, words = line.partition(":")
            mutants.append(Mutant(*head.split(), words.split(), f"{name}:{n}"))
    for m in mutants:
        if not m.old or not m.new:
            sys.exit(f"{m.where}: needs '- old' and '+ new'")
        m.edited((top / m.path).read_text())
    return mutants
