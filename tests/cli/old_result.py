"""Converts result files of earlier versions to text and back, because the repository keeps no binary files.

old_result.py text RESULT > FILE.json    writes each group, data set, attribute and type of a result on a line
old_result.py file FILE.json RESULT      makes the result again, with the same objects, types and bits, but other bytes

tests/cli/data/result-0.1.0.json is from commit 2c5643c, the last one of version 0.1.0. `hifdm run old.yaml -o old.h5`
made it, and its case is in it. tests/cli/data/result-0.2.0.json is from commit 4cdb071 of version 0.2.0, with the case
that it contains. The name of the machine is "host"."""
import json
import sys

import h5py
import numpy as np


def type_of(item):
    """Returns a type as JSON: the name that numpy gives it, "text", "chars" with the length, or the words of an
    enumeration."""
    words, text = h5py.check_enum_dtype(item.dtype), h5py.check_string_dtype(item.dtype)
    if words:
        return [item.dtype.str, dict(sorted(words.items()))]
    if text:
        assert text.encoding == "utf-8"
        return f"chars{text.length}" if text.length else "text"
    return item.dtype.str


def dtype_of(kind):
    if isinstance(kind, list):
        return h5py.enum_dtype(kind[1], basetype=kind[0])
    if kind.startswith(("chars", "text")):
        return h5py.string_dtype("utf-8", int(kind[5:]) if kind != "text" else None)
    return np.dtype(kind)


def as_json(values):
    """Converts numbers and texts. json writes doubles so that they are read back to the bit, and NaN as NaN."""
    values = np.asarray(values).tolist()

    def words(v):
        return [words(w) for w in v] if isinstance(v, list) else v.decode("utf-8") if isinstance(v, bytes) else v

    return words(values)


def to_text(path):
    lines = []

    def tell(name, item):
        attributes = {}
        for key in sorted(item.attrs):
            of = h5py.h5a.open(item.id, key.encode())
            attributes[key] = [type_of(of), as_json(item.attrs[key])] + ([list(of.shape)] if of.shape else [])
        line = {"name": name, "attributes": attributes}
        if isinstance(item, h5py.Dataset):
            line.update(type=type_of(item), shape=list(item.shape), values=as_json(item[()]))
            if item.chunks:
                line["chunks"], line["most"] = list(item.chunks), list(item.maxshape)
        lines.append(json.dumps(line, separators=(",", ":"), ensure_ascii=False))
        if isinstance(item, h5py.Group):
            for below in sorted(item):
                if below != "VTKHDF":  # for ParaView alone: hifdm never reads it
                    tell(f"{name.rstrip('/')}/{below}", item[below])

    with h5py.File(path, "r") as file:
        tell("/", file)
    return lines


def from_json(values, dtype, shape):
    text = h5py.check_string_dtype(dtype)
    if text and text.length:
        values = np.char.encode(np.array(values, dtype=str), "utf-8").tolist()
    return np.array(values, dtype=dtype).reshape(shape)


def to_file(lines, path):
    with h5py.File(path, "w", libver=("v108", "v108")) as file:
        for line in map(json.loads, lines):
            name = line["name"]
            if "type" in line:
                dtype = dtype_of(line["type"])
                growing = {"chunks": tuple(line["chunks"]), "maxshape": tuple(line["most"])} if "chunks" in line else {}
                values = from_json(line["values"], dtype, line["shape"])
                item = file.create_dataset(name, data=values, dtype=dtype, shape=tuple(line["shape"]), **growing)
            else:
                item = file.require_group(name)
            for key, (kind, values, *shape) in line["attributes"].items():
                dtype, shape = dtype_of(kind), tuple(*shape)
                item.attrs.create(key, from_json(values, dtype, shape), shape=shape, dtype=dtype)


def main(what, source, target=None):
    if what == "text":
        print("\n".join(to_text(source)))
        return
    with open(source, encoding="utf-8") as file:
        lines = file.read().splitlines()
    to_file(lines, target)
    assert to_text(target) == lines, "the file does not hold what the text says"


main(*sys.argv[1:])
