#!/usr/bin/env python3
"""Chen et al. 2022, figure by figure: runs the program and writes one SVG per figure of the paper, table.md, and the
tables of the nets that were tried: search.md (at equilibrium) and dense.md (at the paper's own stop).

    paper.py --program build/hifdm --work build/paper --out results/chen2022
    paper.py --program build/hifdm --work build/paper --check results/chen2022     # compares the tables only
"""
import argparse
import os
import sys

import dense_table
import figures
import search_table
import table
import truss_figures
from runs import Runs, net_runs, truss_runs


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True, help="folder for cases and result files")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--out", help="folder for the figures and the table")
    what.add_argument("--check", help="folder with the table to compare with")
    a = parser.parse_args()

    runs = Runs(a.program, a.work)
    found = net_runs(runs) | truss_runs(runs)
    texts = {"table.md": table.write(found, runs.call("schema")), "search.md": search_table.write(runs),
             "dense.md": dense_table.write(runs)}
    if a.check:
        wrong = []
        for name, text in texts.items():
            with open(os.path.join(a.check, name)) as file:
                wrong += [f"{name}: {line}" for line in table.differences(file.read(), text)]
        sys.exit("\n".join(["`make paper` writes anew what differs from what the program gives now:"] + wrong)
                 if wrong else 0)
    os.makedirs(a.out, exist_ok=True)
    for number in range(2, 23):
        getattr(figures if number < 15 else truss_figures, f"fig{number:02d}")(found, a.out)
    for name, text in texts.items():
        with open(os.path.join(a.out, name), "w") as file:
            file.write(text)
    print(f"{a.out}: figures 2 to 22, {', '.join(texts)}")


main()
