"""Makes an as-built net with errors that only the test knows: an imported net of elastic cables, cut with errors.

    twin.py built CUT.csv SHAPE CABLES.csv NODES.csv SIGMA_M SEED    tables of the net, cut lengths with random errors
    twin.py weighed CUT.csv NODES.csv KG_PER_M OUT.csv               these nodes with the weights of their cables
    twin.py missed ANSWER.json CUT.csv CABLES.csv                    RMS of estimated errors minus true ones, m
    twin.py measured SHAPE MEASURED.csv SIGMA_M SEED                 measured positions of all nodes, with noise
    twin.py turned CABLES.csv MOVES.csv TURNED.csv                   the net after the adjustments of `hifdm adjust`
    twin.py distance SHAPE SHAPE                                     RMS of inner nodes between two shapes, m

CUT.csv is a cut list of `hifdm export --cutlist`, MOVES.csv a table of `hifdm adjust`, and SHAPE a folder of
`--csv`."""
import csv
import json
import math
import random
import sys


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def write(path, keys, rows):
    with open(path, "w", newline="") as file:
        table = csv.DictWriter(file, keys, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


CABLE = ("id", "i", "j", "group", "law", "value", "EA_N")
PLACE = ("x_m", "y_m", "z_m")


def built(cut, shape, cables, nodes, sigma_m, seed):
    dice = random.Random(int(seed))
    write(cables, CABLE, [{**c, "law": "elastic",
                           "value": repr(float(c["unstressed_length_m"]) + dice.gauss(0, float(sigma_m)))}
                          for c in read(cut)])
    write(nodes, ("id", *PLACE, "role"), [{**n, **{k: n[k.replace("_", "0_")] for k in PLACE}}
                                          for n in read(f"{shape}/nodes.csv")])


def measured(shape, path, sigma_m, seed):
    dice = random.Random(int(seed))
    write(path, ("id", *PLACE), [{**n, **{k: repr(float(n[k]) + dice.gauss(0, float(sigma_m))) for k in PLACE}}
                                 for n in read(f"{shape}/nodes.csv")])


def weighed(cut, nodes, kg_per_m, path):
    weight = {n["id"]: 0.0 for n in read(nodes)}
    for c in read(cut):
        for end in "ij":
            weight[c[end]] += float(kg_per_m) * float(c["unstressed_length_m"]) * 9.81 / 2
    write(path, ("id", *PLACE, "role", "Fz_N"), [{**n, "Fz_N": repr(-weight[n["id"]])} for n in read(nodes)])


def missed(answer, cut, cables):
    with open(answer) as file:
        found = json.load(file)["errors_m"]
    designed = {c["id"]: float(c["unstressed_length_m"]) for c in read(cut)}
    square = [(found[c["id"]] - (float(c["value"]) - designed[c["id"]]))**2 for c in read(cables)]
    print(repr(math.sqrt(sum(square) / len(square))))


def turned(cables, moves, path):
    by = {m["cable"]: float(m["turnbuckle_mm"]) / 1e3 for m in read(moves)}
    write(path, CABLE, [{**c, "value": repr(float(c["value"]) + by.get(c["id"], 0))} for c in read(cables)])


def distance(a, b):
    there = {n["id"]: n for n in read(f"{b}/nodes.csv")}
    square = [sum((float(n[k]) - float(there[n["id"]][k]))**2 for k in PLACE)
              for n in read(f"{a}/nodes.csv") if n["role"] == "inner"]
    print(repr(math.sqrt(sum(square) / len(square))))


if __name__ == "__main__":
    globals()[sys.argv[1]](*sys.argv[2:])
