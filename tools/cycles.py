#!/usr/bin/env python3
"""Finds source files that call each other in a cycle: tools/cycles.py BUILD, after a build of the program.

A file depends on another one if its object file uses a symbol that the other one defines. At most four cycles may
exist, and none of more than three files. Prints each cycle with the symbols that close it."""
import subprocess
import sys
from pathlib import Path

CYCLES_MOST, FILES_MOST = 4, 3


def symbols(top, build):
    """Returns {file: symbols that it defines} and {file: symbols that it uses}, for each .c file below src."""
    defined, used = {}, {}
    for path in sorted((build / "src").rglob("*.o")):
        source = path.relative_to(build).with_suffix(".c")
        kernel = source.with_name(source.name.rsplit("_", 1)[0] + ".c")  # compiled once per instruction set
        file = next((f for f in (source, kernel) if (top / f).exists()), None)
        if file is None:
            continue  # the object of a file that is gone
        for line in subprocess.run(["nm", path], capture_output=True, text=True, check=True).stdout.splitlines():
            *_, kind, name = line.split()
            if kind == "U":
                used.setdefault(file, set()).add(name)
            elif kind.isupper():
                defined.setdefault(file, set()).add(name)
    return defined, used


def cycles(graph):
    """Returns the sets of more than one file in which each file reaches all others."""
    reached = {}
    for start in graph:
        seen, todo = set(), [start]
        while todo:
            new = graph.get(todo.pop(), set()) - seen
            seen |= new
            todo += new
        reached[start] = seen
    groups = {frozenset(b for b in graph if b in reached[a] and a in reached[b]) for a in graph if a in reached[a]}
    return sorted((g for g in groups if len(g) > 1), key=len, reverse=True)


def main():
    top, build = Path(__file__).resolve().parent.parent, Path(sys.argv[1]).resolve()
    defined, used = symbols(top, build)
    home = {name: file for file, names in defined.items() for name in names}
    graph = {file: {home[name] for name in names if name in home} - {file} for file, names in used.items()}
    if not graph:
        sys.exit(f"{build}: has no object files; build the program first")
    found = cycles(graph)
    for group in found:
        for file in sorted(group):
            for other in sorted(graph[file] & group):
                print(f"{file} -> {other}: {', '.join(sorted(used[file] & defined[other]))}")
    most = max(map(len, found), default=0)
    print(f"{len(graph)} files, {len(found)} cycles, the largest of {most} files")
    sys.exit(0 if len(found) <= CYCLES_MOST and most <= FILES_MOST else 1)


if __name__ == "__main__":
    main()
