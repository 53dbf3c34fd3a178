"""Runs the commands and files in the pages of src/manual: blocks.py --program build/hifdm --work FOLDER [PAGE...]

Each page has its own folder, with links to the configs and tools of the sources. In the order of the page,

    ```yaml file=NAME        writes the block to that file (any language)
    ```console               runs the lines that begin with "$ ", with bash; their output is not in the source

These words may follow `console`. status=N is the exit status of every command of the block (default 0). With quiet the
page does not show the output, and with lines=N only its first N lines. With by=FILE that script runs the commands, and
it must contain these words. The last block must have printed the words of {out}`WORDS` in a text, whatever blanks are
between the words."""
import argparse
import glob
import os
import re
import shutil
import subprocess
import sys

LIMIT_S = 120


class Fault(Exception):
    pass


def prepare(folder, program):
    """Makes the folder of the page. Returns an environment in which the program and this Python have their plain
    names."""
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    names = os.path.join(os.path.dirname(folder), ".bin")
    os.makedirs(names, exist_ok=True)
    for name, path in (("hifdm", os.path.abspath(program)), ("python3", sys.executable)):
        if not os.path.lexists(f"{names}/{name}"):
            os.symlink(path, f"{names}/{name}")
    for name in ("configs", "tools"):
        os.symlink(os.path.abspath(name), f"{folder}/{name}")
    library = os.path.join(os.path.dirname(os.path.abspath(program)), "libhifdm.so")
    return {**os.environ, "PATH": f"{os.path.abspath(names)}:{os.environ['PATH']}", "LC_ALL": "C.UTF-8",
            "PYTHONPATH": os.path.abspath("tools/python"), "HIFDM_LIBRARY": library, "PYTHONDONTWRITEBYTECODE": "1"}


def commands(lines):
    """Yields the lines that begin with "$ ", each with the lines that a backslash joins to it."""
    command = []
    for line in lines:
        if command or line.startswith("$ "):
            command.append(line)
        if command and not line.endswith("\\"):
            yield command
            command = []


def run(command, status, folder, env):
    line = "\n".join(command)[2:]
    done = subprocess.run(["bash", "-c", line], cwd=folder, env=env, text=True, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LIMIT_S)
    if done.returncode != status:
        raise Fault(f"exit status {done.returncode} and not {status}: {line}\n{done.stdout}")
    return done.stdout


def console(lines, options, folder, env):
    """Returns the block as the page shows it, and the output."""
    if "by" in options:
        text = open(options["by"], encoding="utf-8").read()
        for command in commands(lines):
            if command[0][2:] not in text:
                raise Fault(f"{options['by']} does not run {command[0][2:]}")
        return lines, ""
    shown, said = [], ""
    for command in commands(lines):
        printed = run(command, int(options.get("status", 0)), folder, env)
        said += printed
        shown += command
        out = printed.rstrip("\n").split("\n") if printed and "quiet" not in options else []
        most = int(options.get("lines", len(out)))
        shown += out[:most] + (["..."] if len(out) > most else [])
    return shown, said


def words(text):
    return " ".join(text.split())


def run_page(path, folder, program):
    """Returns the lines of a page with the output of its commands."""
    env = prepare(folder, program)
    made, said, block, head = [], "", None, ""
    for number, line in enumerate(open(path, encoding="utf-8").read().split("\n"), 1):
        fence = re.match(r"```(\w+)?(.*)", line)
        try:
            if fence and block is None and fence[1]:
                block, head = [], fence
            elif line == "```" and block is not None:
                options = dict((word.split("=", 1) + [""])[:2] for word in head[2].split())
                if "file" in options:
                    name = os.path.join(folder, options["file"])
                    os.makedirs(os.path.dirname(name), exist_ok=True)
                    open(name, "w", encoding="utf-8").write("\n".join(block) + "\n")
                    made += [f"```{{code-block}} {head[1]}", f":caption: {options['file']}", "", *block, "```"]
                else:
                    if head[1] == "console":
                        block, said = console(block, options, folder, env)
                    made += [f"```{head[1]}", *block, "```"]
                block = None
            elif block is not None:
                block.append(line)
            else:
                for figure in re.findall(r"\{out\}`([^`]*)`", line):
                    if words(figure) not in words(said):
                        raise Fault(f'"{figure}" is not printed:\n{said}')
                made.append(re.sub(r"\{out\}`([^`]*)`", r"\1", line))
        except Fault as fault:
            raise Fault(f"{path}:{number}: {fault}") from None
    return made


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True)
    parser.add_argument("page", nargs="*", default=sorted(glob.glob("src/manual/**/*.md", recursive=True)))
    a = parser.parse_args()
    for path in a.page:
        try:
            run_page(path, os.path.join(a.work, re.sub(r"\W+", "-", path[:-3])), a.program)
        except Fault as fault:
            sys.exit(str(fault))
        print(f"{path}: its commands do what it says")


if __name__ == "__main__":
    main()
