"""expect.py FILE... -- EXPRESSION...: checks that every Python expression holds for the content of the files.

The files are a, b, c, ... in the order given. A .json file is its object, .h5 an open h5py.File, .csv a list of rows as
dictionaries, .yaml its document, and any other file its bytes. Expressions may also use the functions below. An
expression that does not hold is printed with the values of its two sides, and the exit status is 1."""
import ast
import base64
import csv
import hashlib
import importlib
import json
import sys


class Lazy:
    """A module that is imported when it is used. Most files are JSON, and importing numpy takes longer than they do."""

    def __init__(self, name):
        self.name = name

    def __getattr__(self, attribute):
        return getattr(importlib.import_module(self.name), attribute)


np, h5py = Lazy("numpy"), Lazy("h5py")


def load(path):
    if path.endswith(".h5"):
        return h5py.File(path, "r")
    if path.endswith(".csv"):
        with open(path, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))
    if path.endswith(".yaml"):
        import yaml

        with open(path, encoding="utf-8") as file:
            return yaml.safe_load(file)
    with open(path, "rb") as file:
        content = file.read()
    if not path.endswith(".json"):
        return content
    return json.loads(content.decode("utf-8"), parse_constant=refuse, object_pairs_hook=unpacked)


def unpacked(pairs):
    """Returns an object, which has each key once, or the numbers of a page, which stores them as base64 of their bytes
    (base/json.h)."""
    item = dict(pairs)
    if len(item) < len(pairs):
        raise ValueError(f"a key is there twice: {[name for name, _ in pairs]}")
    types = {"i32": "<i4", "f32": "<f4", "f64": "<f8"}
    for name, text in item.items():
        if name in types and len(item) == 1:
            return np.frombuffer(base64.b64decode(text, validate=True), types[name]).tolist()
    return item


def refuse(word):
    raise ValueError(f"{word} is no JSON")


def data_sets(file):
    """Returns {path: data set} of all data sets, without old names and without the links in the grid for ParaView."""
    found = {}
    for name, item in file.items():
        if isinstance(file.get(name, getlink=True), h5py.SoftLink):
            continue
        if hasattr(item, "dtype"):
            found[name] = item
        elif name != "VTKHDF":
            found.update({f"{name}/{below}": of for below, of in data_sets(item).items()})
    return found


def missing_names(old, new):
    """Returns the paths and attributes of a file that another one does not have, not even as links."""
    missing = []

    def look(name, item):
        if name.startswith("VTKHDF"):
            return
        if name not in new:
            missing.append(name)
        else:
            missing.extend(f"{name}@{key}" for key in item.attrs if key not in new[name].attrs)

    look("/", old)
    old.visititems(look)
    return missing


def close(a, b):
    return abs(a - b) <= 1e-9 * abs(b)


def contents(file):
    """Returns {path: (type, shape, bytes)} of all data sets. Two results are equal if all their bits are. Attributes do
    not count."""
    return {name: (str(d.dtype), d.shape, d[()].tobytes() if d.dtype.kind != "O" else repr(d[()]))
            for name, d in data_sets(file).items()}


def attributes(file):
    """Returns {(object, attribute): value} of all objects below the root, without times and without the case as it was
    typed."""
    found = {}
    file.visititems(lambda name, item: found.update({(name, k): str(v) for k, v in item.attrs.items()
                                                     if k[-2:] != "_s" and name != "case"}))
    return found


def differing(one, other):
    x, y = contents(one), contents(other)
    return sorted(name for name in x.keys() | y.keys() if x.get(name) != y.get(name))


def designs(file):
    """Returns the designs of the search of a result [generation][individual][variable]: those that it stored."""
    population = file["search/population"]
    return population["design"][:][population["design_row"][:]]


def n_new(design):
    """Returns how many designs [generation][individual][variable] are not those of the generation before."""
    return design.shape[1] + (design[1:] != design[:-1]).any(axis=2).sum()


def holds_of(thin, whole, store, every):
    """Checks that the rows of /search/population in `thin` are those that optimize.store keeps of the file `whole`, and
    that the last generation is there."""
    best = whole["search/population/best_individual"][:]
    rows = {"best": lambda v: v[np.arange(len(v)), best][:, None], "every": lambda v: v[::every]}[store]
    all_of, kept = whole["search/population"], thin["search/population"]
    per = [n for n, d in all_of.items() if hasattr(d, "shape") and d.shape[:2] == all_of["psi_m"].shape]
    per.remove("design_row")
    figures = [n for n, d in whole["search/population"].items() if hasattr(d, "shape") and d.shape == best.shape]
    return (len(per) > 10 and len(figures) == 7 and set(thin["search/population/last"]) == {*per, "design"} and
            designs(thin).tobytes() == rows(designs(whole)).tobytes() and
            kept["last/design"][()].tobytes() == designs(whole)[-1:].tobytes() and
            len(kept["design"]) == n_new(designs(thin)) and
            all(kept[n][()].tobytes() == rows(all_of[n][()]).tobytes() for n in per) and
            all(kept["last"][n][()].tobytes() == all_of[n][-1:].tobytes() for n in per) and
            all(kept[n][()].tobytes() == all_of[n][()].tobytes() for n in figures))


def facet_rms(grid, f, n):
    """Returns the RMS error along the normal of a grid of nodes [j][i][xyz] above the cylinder x^2/(4f). The cells are
    bilinear, with n x n points of Gauss-Legendre each; the mean is over the projected area."""
    at, weight = np.polynomial.legendre.leggauss(n)
    u, v = np.meshgrid((at + 1) / 2, (at + 1) / 2)
    a, b, c, d = (part[..., :, None, None] for part in (grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]))
    p = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    pu, pv = (1 - v) * (b - a) + v * (c - d), (1 - u) * (d - a) + u * (c - b)
    area = np.abs(pu[:, :, 0] * pv[:, :, 1] - pu[:, :, 1] * pv[:, :, 0]) * np.outer(weight, weight)
    x, z = p[:, :, 0], p[:, :, 2]
    return np.sqrt(np.sum(area * (z - x**2 / (4 * f))**2 / (1 + x**2 / (4 * f**2))) / np.sum(area))


def column(rows, *names):
    """Returns columns of a CSV file as numbers, one row of the array per line."""
    values = np.array([[float(row[name]) for name in names] for row in rows])
    return values[:, 0] if len(names) == 1 else values


def text(value):
    return value.decode("utf-8") if isinstance(value, bytes) else value


def texts(data_set):
    """Returns the strings of a data set, of any kind of string and any shape."""
    values = data_set[()]
    return [text(t) for t in values.tolist()] if isinstance(values, np.ndarray) else text(values)


def sets_of(file):
    """Returns {name: ids of the cables} of all sets."""
    ids, start, cable = texts(file["scene/cable/id"]), file["scene/set/start"][:], file["scene/set/cable"][:]
    names = texts(file["scene/set/name"])
    return {name: {ids[e] for e in cable[start[k] : start[k + 1]]} for k, name in enumerate(names)}


def attribute(item, name):
    return texts({(): item.attrs[name]})


def psi_m(file, position_m):
    """Returns psi by Eq. 10, computed here and not by the program."""
    inner = file["scene/node/role"][:] == 1
    gap = position_m[inner] - file["scene/node/position_m"][:][inner]
    return float(np.sqrt((gap**2).sum(axis=1).mean()))


def ratio(file, tension_N, group):
    """Returns the ratio of maximum to minimum tension in group 0 (inner) or 1 (boundary)."""
    mine = tension_N[file["scene/cable/group"][:] == group]
    return float(mine.max() / mine.min())


def residual_N(file):
    """Returns the largest force out of balance at a free node of /form, loads included."""
    position_m, end = file["form/position_m"][:], file["scene/cable/end"][:]
    pull_N = file["form/q_N_per_m"][:][:, None] * (position_m[end[:, 1]] - position_m[end[:, 0]])
    force_N = file["scene/node/load_N"][:] if "scene/node/load_N" in file else np.zeros_like(position_m)
    np.add.at(force_N, end[:, 0], pull_N)
    np.subtract.at(force_N, end[:, 1], pull_N)
    return float(np.linalg.norm(force_N[file["scene/node/role"][:] != 0], axis=1).max())


def held(q_N_per_m, support_m):
    """Returns the position where cables with these force densities hold a node between supports, and their tensions."""
    q, support = np.array(q_N_per_m), np.array(support_m)
    node = q @ support / q.sum()
    return node, q * np.linalg.norm(node - support, axis=1)


def sha256(content):
    return hashlib.sha256(content).hexdigest()


OF_SURFACE = ("surface", "facet", "fit_", "half_path", "gain_loss")  # columns of samples


def bits(file, case):
    """Returns one line per group of numbers: case, group, and a checksum of names, types, shapes and bytes. In a merged
    study the result files of the points are one group, "runs"."""
    groups = {}
    for name, (kind, shape, data) in sorted(contents(file).items()):
        parts = name.split("/")
        left_out = {"case", "surface", "requirements"} & set(parts[:-1]) or parts[-1].endswith("condition")
        left_out = left_out or parts[0] == "tolerance" and parts[-1].startswith(OF_SURFACE)
        if isinstance(data, bytes) and not left_out:
            group = groups.setdefault(parts[0], hashlib.sha256())
            group.update(f"{name} {kind} {shape} ".encode() + data)
    return [f"{case} {group} {checksum.hexdigest()[:16]}" for group, checksum in sorted(groups.items())]


def bits_are(file, table, case):
    wanted = [line for line in table.decode().splitlines() if line.startswith(case + " ")]
    found = bits(file, case)
    if found != wanted:
        print("tests/verify/data/bits.txt has other lines than:", *found, sep="\n")
    return found == wanted


def write_bits(file, folder, case):
    with open(f"{folder}/{case}", "w", encoding="utf-8") as out:
        return out.write("".join(line + "\n" for line in bits(file, case))) > 0


def near(value, wanted, tolerance):
    return abs(value - wanted) <= tolerance


def short(value):
    text = repr(value)
    return text if len(text) < 500 else text[:500] + " ..."


def explain(expression, names):
    print("does not hold:", expression)
    tree = ast.parse(expression, mode="eval").body
    if isinstance(tree, ast.Compare):
        sides = [tree.left, *tree.comparators]
    else:
        sides = tree.args if isinstance(tree, ast.Call) else []
    for side in sides:
        print("   ", ast.unparse(side), "=", short(eval(compile(ast.Expression(side), "", "eval"), names)))


def main(words):
    cut = words.index("--")
    names = dict(globals(), **{chr(ord("a") + i): load(path) for i, path in enumerate(words[:cut])})
    failed = False
    for expression in words[cut + 1:]:
        if not eval(expression, names):
            explain(expression, names)
            failed = True
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
