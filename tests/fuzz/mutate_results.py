"""Damages HDF5 files in two ways. mutate(path, random) damages a copy in place and returns a description.

Structure: what h5py can write but hifdm never writes. These are other dimensions and types, missing and additional
objects, links of every kind, huge attributes, and numbers out of range. Bytes: flips, blocks of zeros or of other
bytes, blocks that are copied or cut out, and a file that is cut short. In some cases the checksums of the object
headers are corrected, so that HDF5 reads their content. To reach HDF5's older format, which has no checksums, the file
is first copied into it."""
import os
import random as random_module
import shutil
import struct

import h5py
import numpy as np

HUGE = [2**20, 2**31 - 1, 2**31, 2**40, 2**61, 2**63 - 1]
NUMBERS = [0, -1, 1, 2, 7, 100, 127, 128, 255, 2**15, 2**31 - 1, -(2**31), 2**63 - 1, -(2**63)]
REALS = [0.0, -0.0, -1.0, 1e-308, 1e308, -1e308, float("nan"), float("inf"), -float("inf"), 2.0**31, 2.0**63]


def walk(group, prefix="", depth=0):
    """Yields (name, object) of everything below, to a depth that our files do not reach. Earlier changes may have made
    cycles, in which HDF5's own walk does not end."""
    for name in group if depth < 6 else ():
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            continue
        item = group[name]
        yield prefix + name, item
        if isinstance(item, h5py.Group):
            yield from walk(item, prefix + name + "/", depth + 1)


def data_sets(file):
    return [name for name, item in walk(file) if isinstance(item, h5py.Dataset)][:1000]


def groups(file):
    return ["/", *[name for name, item in walk(file) if isinstance(item, h5py.Group)][:1000]]


def objects(file):
    return groups(file) + data_sets(file)


def some_value(r, dtype):
    """Returns a number that fits the type, often a limit of it."""
    dtype = np.dtype(dtype)
    if dtype.kind == "f":
        return np.array(r.choice(REALS), dtype)
    if dtype.kind in "iu":
        info = np.iinfo(dtype)
        return np.array(min(max(r.choice(NUMBERS), info.min), info.max), dtype)
    return np.frombuffer(r.randbytes(dtype.itemsize), dtype)[0]


def some_type(r):
    return r.choice([
        "f4", ">f8", "f8", "i1", "u1", "i4", ">i4", "i8", "u8", "S1", "S9", "S70000", "V7",
        h5py.string_dtype(), h5py.vlen_dtype("i4"), h5py.vlen_dtype("f8"), h5py.ref_dtype, h5py.regionref_dtype,
        h5py.enum_dtype({"A": 0, "B": 77, "ok": 5}, basetype="i1"), h5py.enum_dtype({"ok": 300}, basetype="i4"),
        np.dtype([("a", "i4"), ("b", "f8")]), np.dtype([("r", "f8"), ("i", "f8")]), np.dtype(("f8", (3, 4))),
        np.dtype([("s", h5py.string_dtype()), ("n", np.dtype(("i2", (2,))))]), np.longdouble, "c16", "?"])


def some_shape(r, shape):
    shape = tuple(shape)
    return r.choice([
        (), (0,), (1,), (2,), shape + (1,), (1,) + shape, shape[::-1], shape[1:], shape[:1],
        tuple(n + 1 for n in shape), tuple(max(n - 1, 0) for n in shape), (0,) * len(shape), (3,) * 32,
        shape[:1] + (0,), (r.choice(HUGE),) + shape[1:], (r.choice(HUGE),), (2**31, 2**31), (2**21, 2**21, 2**21)])


def replace(file, name, shape, dtype, r):
    """Makes a new data set with this name and the attributes of the old one. A large one has no storage."""
    old = dict(file[name].attrs) if name in file else {}
    if name in file:
        del file[name]
    n = int(np.prod([int(s) for s in shape], dtype=object)) if shape else 1
    try:
        if n <= 100000 and r.random() < 0.7:
            new = file.create_dataset(name, shape, dtype)
            if np.dtype(dtype).kind in "fiu" and n:
                new[...] = some_value(r, dtype)
        elif shape and r.random() < 0.5 and min(shape) > 0:
            new = file.create_dataset(name, shape, dtype, chunks=tuple(min(int(s), 4) for s in shape),
                                      maxshape=(None,) * len(shape), fillvalue=None)
        else:
            new = file.create_dataset(name, shape, dtype)
        for key, value in old.items():
            new.attrs[key] = value
    except (ValueError, TypeError, OSError, RuntimeError):
        pass  # h5py refuses it: the data set is missing then


# ---- structure: functions of (file, random) that return what they did ----------------------------------------------


def remove(file, r):
    name = r.choice([n for n in objects(file) if n != "/"])
    del file[name]
    return f"removed {name}"


def other_shape(file, r):
    name = r.choice(data_sets(file))
    shape = some_shape(r, file[name].shape)
    replace(file, name, shape, file[name].dtype, r)
    return f"shape of {name}: {shape}"


def other_type(file, r):
    name = r.choice(data_sets(file))
    dtype = some_type(r)
    replace(file, name, file[name].shape, dtype, r)
    return f"type of {name}: {dtype}"


def other_values(file, r):
    name = r.choice([n for n in data_sets(file) if file[n].size and file[n].dtype.kind in "fiuS"])
    data = file[name]
    values = data[()]
    if data.shape == () or r.random() < 0.3:
        data[...] = some_value(r, data.dtype)
    else:
        flat = values.reshape(-1)
        for _ in range(r.choice([1, 3, flat.size])):
            flat[r.randrange(flat.size)] = some_value(r, data.dtype)
        data[...] = values
    return f"values of {name}"


def resized(file, r):
    """Adds rows that were never written, or removes rows."""
    names = [n for n in data_sets(file) if file[n].chunks]
    if not names:
        return other_shape(file, r)
    name = r.choice(names)
    data = file[name]
    n = r.choice([0, 1, data.shape[0] - 1, data.shape[0] + 1, 2 * data.shape[0], 10**6, 2**31, 2**40])
    data.resize(max(n, 0), axis=0)
    return f"rows of {name}: {n}"


def storage(file, r):
    """Stores the same values in another way: filters, chunks, other files, virtual data sets, or nothing at all."""
    name = r.choice([n for n in data_sets(file) if file[n].dtype.kind in "fiu" and file[n].shape])
    values = file[name][()]
    attributes = dict(file[name].attrs)
    way = r.choice(["gzip", "shuffle", "fletcher32", "external", "zero", "virtual", "fill", "scaleoffset"])
    del file[name]
    try:
        if way in ("external", "zero"):
            other = "/dev/zero" if way == "zero" else "/etc/passwd"
            file.create_dataset(name, values.shape, values.dtype, external=[(other, 0, h5py.h5f.UNLIMITED)])
        elif way == "virtual":
            layout = h5py.VirtualLayout(shape=values.shape, dtype=values.dtype)
            layout[...] = h5py.VirtualSource(r.choice([".", "/etc/passwd", "nowhere.h5"]), name, shape=values.shape)
            file.create_virtual_dataset(name, layout)
        elif way == "fill":
            file.create_dataset(name, values.shape, values.dtype, chunks=True, fillvalue=values.reshape(-1)[0])
        elif way == "gzip":
            file.create_dataset(name, data=values, compression="gzip")
        elif way == "scaleoffset":
            file.create_dataset(name, data=values, scaleoffset=3)
        else:
            file.create_dataset(name, data=values, chunks=True, **{way: True})
        for key, value in attributes.items():
            file[name].attrs[key] = value
    except (ValueError, TypeError, OSError, RuntimeError):
        pass
    return f"storage of {name}: {way}"


def exchanged(file, r):
    """Puts a data set or a type in the place of a group, or a group in the place of a data set."""
    name = r.choice([n for n in objects(file) if n != "/"])
    is_group = isinstance(file[name], h5py.Group)
    del file[name]
    kind = r.choice(["other", "type", "null"])
    if kind == "type":
        file[name] = np.dtype("f8")
    elif kind == "null":
        file[name] = h5py.Empty("f8")
    elif is_group:
        file[name] = 1.0
    else:
        file.create_group(name)
    return f"{name} is now: {kind}"


def linked(file, r):
    name = r.choice([n for n in objects(file) if n != "/"])
    kind = r.choice(["nowhere", "itself", "two", "root", "up", "passwd", "self-file", "no-file", "fifo", "moved",
                     "hard"])
    if kind in ("moved", "hard"):  # the object is there, but behind a link
        file.move(name, "/hidden")
        file[name] = h5py.SoftLink("/hidden") if kind == "moved" else file["/hidden"]
        return f"{name} is a link to where it was moved: {kind}"
    del file[name]
    if kind == "nowhere":
        file[name] = h5py.SoftLink("/no/where")
    elif kind == "itself":
        file[name] = h5py.SoftLink("/" + name)
    elif kind == "two":
        file[name] = h5py.SoftLink("/elsewhere")
        file["/elsewhere"] = h5py.SoftLink("/" + name)
    elif kind == "root":
        file[name] = file["/"]  # a hard link: a cycle
    elif kind == "up":
        file[name] = h5py.SoftLink("/")
    elif kind == "passwd":
        file[name] = h5py.ExternalLink("/etc/passwd", "/")
    elif kind == "self-file":
        file[name] = h5py.ExternalLink(os.path.basename(file.filename), "/" + name)
    elif kind == "fifo":
        file[name] = h5py.ExternalLink(os.path.join(os.path.dirname(file.filename), "fifo"), "/")
    else:
        file[name] = h5py.ExternalLink("nowhere.h5", "/" + name)
    return f"{name} links to: {kind}"


def attribute(file, r):
    place = r.choice([n for n in objects(file) if len(file[n].attrs)] or ["/"])
    attributes = file[place].attrs
    names = list(attributes)
    if not names:
        return remove(file, r)
    key = r.choice(names)
    kind = r.choice(["gone", "type", "shape", "value", "value", "value", "huge", "text", "long", "null", "enum"])
    try:
        old = attributes[key]
        if kind == "gone":
            del attributes[key]
        elif kind == "type":
            dtype = some_type(r)
            attributes.create(key, np.zeros((), dtype) if np.dtype(dtype).kind != "O" else "text", dtype=None)
            kind += f" {dtype}"
        elif kind == "shape":
            attributes.create(key, np.zeros(r.choice([(0,), (1,), (2,), (3, 3), (2000,)])), dtype="f8")
        elif kind == "value":
            dtype = np.asarray(old).dtype
            attributes.modify(key, some_value(r, dtype) if dtype.kind in "fiu" else np.bytes_(r.randbytes(5)))
        elif kind == "huge":
            attributes.create(key, np.full(r.choice([7000, 8100]), some_value(r, "f8")))
        elif kind == "text":
            attributes.create(key, "x" * r.choice([0, 1, 1000, 60000]))
        elif kind == "long":
            del attributes[key]
            attributes.create(key, np.bytes_(b"y" * r.choice([1, 300, 4096, 5000, 60000])))
        elif kind == "null":
            attributes.create(key, h5py.Empty("f8"))
        else:
            attributes.create(key, 99, dtype=h5py.enum_dtype({"FALSE": 0, "TRUE": 1, "odd": 99}, basetype="i1"))
    except (ValueError, TypeError, OSError, RuntimeError, KeyError):
        pass
    return f"attribute {key} of {place}: {kind}"


def more(file, r):
    """Adds many attributes, many groups, deep groups, or names that are not allowed."""
    kind = r.choice(["attributes", "groups", "deep", "name", "dense"])
    place = file[r.choice(groups(file))]
    if kind == "attributes":
        for i in range(200):
            place.attrs[f"a{i}"] = i
    elif kind == "groups":
        for i in range(2000):
            place.create_group(f"g{i}")
    elif kind == "deep":
        for _ in range(r.choice([10, 300, 3000])):
            place = place.create_group("d")
    elif kind == "name":
        place.create_group(r.choice(["x" * 5000, "\x1b[31m", "a\nb", "\u202e", " ", "é" * 700]))
        place[r.choice(["y" * 3000, "\x1b]0;t\x07"])] = np.zeros(3)
    else:
        place.attrs["dense"] = np.zeros(8000)
    return f"more {kind} in {place.name[:40]}"


STRUCTURE = [remove, other_shape, other_type, other_values, other_values, resized, storage, exchanged, linked,
             attribute, attribute, attribute, more]


# ---- bytes ---------------------------------------------------------------------------------------------------------


def rotate(x, k):
    return ((x << k) | (x >> (32 - k))) & 0xFFFFFFFF


def lookup3(data):
    """Returns Jenkins' hash of 2006 with the start value 0, HDF5's checksum of metadata."""
    m = 0xFFFFFFFF
    n = len(data)
    a = b = c = (0xDEADBEEF + n) & m
    data = data + bytes(-n % 12)
    words = struct.unpack(f"<{len(data) // 4}I", data)
    if n == 0:
        return c
    for i in range(0, len(words) - 3, 3):
        a, b, c = (a + words[i]) & m, (b + words[i + 1]) & m, (c + words[i + 2]) & m
        for k, (x, y) in zip((4, 6, 8, 16, 19, 4), ("ca", "ab", "bc") * 2):
            if x == "c":
                a = ((a - c) & m) ^ rotate(c, k)
                c = (c + b) & m
            elif x == "a":
                b = ((b - a) & m) ^ rotate(a, k)
                a = (a + c) & m
            else:
                c = ((c - b) & m) ^ rotate(b, k)
                b = (b + a) & m
    a, b, c = (a + words[-3]) & m, (b + words[-2]) & m, (c + words[-1]) & m
    for k, x in zip((14, 11, 25, 16, 4, 14, 24), "cabcabc"):
        if x == "c":
            c = ((c ^ b) - rotate(b, k)) & m
        elif x == "a":
            a = ((a ^ c) - rotate(c, k)) & m
        else:
            b = ((b ^ a) - rotate(a, k)) & m
    return c


def blocks(data):
    """Returns (from, to) of the bytes before each checksum of 4 bytes: superblock, object headers and other blocks."""
    found = []
    if data[:8] == b"\x89HDF\r\n\x1a\n" and data[8] >= 2:
        found.append((0, 44))
    at = data.find(b"OHDR")
    while at >= 0:
        flags = data[at + 5]
        size = 1 << (flags & 3)
        head = at + 6 + (16 if flags & 0x20 else 0) + (4 if flags & 0x10 else 0)
        end = head + size + int.from_bytes(data[head:head + size], "little")
        if data[at + 4] == 2 and end + 4 <= len(data):
            found.append((at, end))
        at = data.find(b"OHDR", at + 4)
    return found


def flip(data, r, lo, hi):
    for _ in range(r.choice([1, 1, 2, 5, 30])):
        data[r.randrange(lo, hi)] = r.choice([0, 1, 0x7F, 0x80, 0xFF, r.randrange(256)])
    return "bytes"


def word(data, r, lo, hi):
    at = r.randrange(lo, max(hi - 8, lo + 1))
    value = r.choice([0, 1, 2**16, 2**31 - 1, 2**32 - 1, 2**40, 2**63, 2**64 - 1, at, lo, len(data)])
    size = r.choice([2, 4, 8])
    data[at:at + size] = (value & (2 ** (8 * size) - 1)).to_bytes(size, "little")
    return f"word {value}"


def damage_bytes(path, r):
    with open(path, "rb") as file:
        data = bytearray(file.read())
    n = len(data)
    kind = r.choice(["header", "header", "header", "flip", "word", "zero", "copy", "cut", "insert", "short", "tree"])
    heads = blocks(data)
    words = kind
    if kind == "header" and heads:
        lo, hi = r.choice(heads)
        words += " " + r.choice([flip, word])(data, r, lo + 4, hi)
        data[hi:hi + 4] = lookup3(bytes(data[lo:hi])).to_bytes(4, "little")
    elif kind == "tree":
        places = [i for key in (b"TREE", b"SNOD", b"HEAP", b"GCOL", b"BTHD", b"BTLF", b"BTIN", b"FRHP", b"FHDB")
                  for i in range(n - 8) if data[i:i + 4] == key] if n < 400000 else []
        at = r.choice(places) if places else r.randrange(n)
        r.choice([flip, word])(data, r, at, min(at + 200, n))
    elif kind in ("flip", "header"):
        flip(data, r, 0, n)
    elif kind == "word":
        word(data, r, 0, n)
    else:
        size = r.choice([1, 4, 8, 64, 512, 4096, 65536])
        at, to = r.randrange(n), r.randrange(n)
        if kind == "zero":
            data[at:at + size] = bytes(len(data[at:at + size]))
        elif kind == "copy":
            data[to:to + size] = data[at:at + size]
        elif kind == "cut":
            del data[at:at + size]
        elif kind == "insert":
            data[to:to] = data[at:at + size]
        else:
            del data[r.choice([at, n - 1, 8, 100, n // 2]):]
    with open(path, "wb") as file:
        file.write(data)
    return f"bytes: {words}"


def copy_attributes(source, copy):
    for key, value in source.attrs.items():
        copy.attrs.create(key, value, dtype=source.attrs.get_id(key).dtype)


def into_old_format(path):
    """Converts a file to the format of HDF5 1.0 to 1.6, whose headers, trees and heaps have no checksums."""
    old = path + ".old"
    with h5py.File(path, "r") as source, h5py.File(old, "w", libver="earliest") as copy:
        copy_attributes(source, copy)

        def take(name, item):
            if isinstance(item, h5py.Group):
                new = copy.require_group(name)
            else:
                new = copy.create_dataset(name, data=item[()], dtype=item.dtype, chunks=item.chunks,
                                          maxshape=item.maxshape if item.chunks else None)
            copy_attributes(item, new)

        source.visititems(take)
    os.replace(old, path)


def mutate(path, seed):
    r = random_module.Random(seed)
    words = []
    way = r.random()
    if way < 0.6:
        with h5py.File(path, "r+", libver=("earliest" if r.random() < 0.3 else ("earliest", "v108"))) as file:
            for _ in range(r.choice([1, 1, 1, 2, 4])):
                try:
                    words.append(r.choice(STRUCTURE)(file, r))
                except (KeyError, ValueError, IndexError, OSError, RuntimeError, TypeError) as trouble:
                    words.append(f"({trouble.__class__.__name__})")
    else:
        if way > 0.8:
            into_old_format(path)
            words.append("old format")
        words.append(damage_bytes(path, r))
    return "; ".join(words)


if __name__ == "__main__":
    import sys

    shutil.copy(sys.argv[1], sys.argv[2])
    print(mutate(sys.argv[2], int(sys.argv[3])))
