#!/usr/bin/env python3
"""abi.py LIBRARY: compares what the shared library exports with the public headers and with tests/abi.txt.

The library must export exactly the functions and variables that include/hifdm declares. tests/abi.txt lists them for
the SOVERSION of the Makefile. A missing name breaks programs that were linked before, so SOVERSION must then increase.
`abi.py --write LIBRARY` writes the list again."""
import re
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
LIST = TOP / "tests/abi.txt"
HEAD = "# What libhifdm.so.{} exports. `make abi` compares; {} --write LIBRARY writes this file anew."


def exported(library):
    table = subprocess.run(["nm", "--dynamic", "--defined-only", "--format=posix", library], check=True,
                           capture_output=True, text=True).stdout
    return {line.split()[0] for line in table.splitlines()}


def declared():
    """Returns the names of functions and variables at the outermost level of the public headers, without static
    ones."""
    text = "".join(f"#include <hifdm/{p.name}>\n" for p in sorted((TOP / "include/hifdm").glob("*.h")))
    code = subprocess.run(["cc", "-E", "-std=c11", f"-I{TOP}/include", "-x", "c", "-"], input=text, check=True,
                          capture_output=True, text=True).stdout
    ours, lines = False, []
    for line in code.splitlines():
        if line.startswith("# "):
            ours = "/include/hifdm/" in line
        elif ours and not line.startswith("#"):
            lines.append(line)
    code, depth, outer = "\n".join(lines), 0, []
    for c in code:
        depth += (c == "{") - (c == "}")
        outer.append(c if depth == 0 or c == "{" else "")
    names = set()
    for statement in re.split(r"[;}]", "".join(outer)):
        words = statement.split()
        if not words or words[0] in ("typedef", "static", "_Static_assert"):
            continue
        function = re.search(r"\b(hf_\w+)\s*\(", statement)
        variable = re.search(r"\bextern\b.*?\b(hf_\w+)\s*(?:\[[^\]]*\]\s*)*$", statement, re.S)
        if function or variable:
            names.add((function or variable).group(1))
    return names


def soversion():
    return re.search(r"^SOVERSION := (\d+)", (TOP / "Makefile").read_text(), re.M).group(1)


def main(words):
    is_write = words[:1] == ["--write"]
    if len(words) != 1 + is_write:
        sys.exit(__doc__)
    here, said, head = exported(words[-1]), declared(), HEAD.format(soversion(), Path(__file__).name)
    wrong = [f"{name}: exported, but no public header declares it" for name in sorted(here - said)]
    wrong += [f"{name}: declared in a public header, but not exported" for name in sorted(said - here)]
    if is_write and not wrong:
        LIST.write_text("\n".join([head, *sorted(here)]) + "\n")
    listed = LIST.read_text().splitlines()
    before = set(listed[1:])
    if listed[0] == head:
        wrong += [f"{name}: is gone; raise SOVERSION in the Makefile" for name in sorted(before - here)]
        wrong += [f"{name}: is new; add it to {LIST.name}: abi.py --write" for name in sorted(here - before)]
    else:
        wrong.append(f"{LIST.name}: is of another SOVERSION: abi.py --write")
    for line in wrong:
        print(f"abi: {line}", file=sys.stderr)
    print(f"abi: {len(here)} exported, {len(said)} declared, {len(wrong)} wrong")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
