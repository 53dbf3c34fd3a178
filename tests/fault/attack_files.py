"""Reads files of hifdm for attack.py: names, rows, records, and the bytes that no checksum covers."""
import re
import struct
import sys
from pathlib import Path

import h5py

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from expect import attributes  # noqa: E402


def is_temporary(name):
    return re.search(r"(^|/)\.[^/]*\.hifdm-[0-9a-f]{32}\.tmp$", name)


def names_in(folder):
    return {str(p.relative_to(folder)) for p in folder.rglob("*")
            if (p.is_file() or p.is_symlink()) and p.suffix != ".tsv" and p.name != "claims"}


def rows_of(folder, finished=False):
    """Returns the rows of a sweep in all its tables, without times. `finished`: only rows of finished points, because a
    point that was stopped has one row more."""
    rows = set()
    for path in folder.glob("s.d/*.tsv"):
        head, *lines = (line.split("\t") for line in path.read_text(errors="replace").splitlines() or [""])
        rows |= {tuple(cell for name, cell in zip(head, line) if not name.endswith(("wall_s", "cpu_s")))
                 for line in lines if not finished or dict(zip(head, line)).get("//finished") == "1"}
    return rows


def lapack_of(path):
    """The end of the path of the LAPACK that a result was computed with."""
    with h5py.File(path) as file:
        name = file.attrs["lapack"]
    return "/".join(getattr(name, "decode", lambda: name)().split("/")[-2:])


def attributes_of(path):
    """What expect.py compares of the attributes of a result."""
    with h5py.File(path) as file:
        return attributes(file)


def records_of(path):
    """Returns the header of a journal and its records without their order, which depends on threads."""
    data, at, records = path.read_bytes(), 72, []
    while at + 12 <= len(data):
        length = 12 + struct.unpack_from("<I", data, at + 4)[0]
        records.append(data[at:at + length])
        at += length
    return data[:72], sorted(records)


def node_bytes(data, at, chunks):
    """Returns the size of a node in a tree of chunks. Its rank is the one for which its first child is a chunk or a
    node."""
    for rank in range(1, 6):
        key = 8 + 8 * (rank + 1)
        child = struct.unpack_from("<Q", data, at + 24 + key)[0]
        if child in chunks or data[child:child + 4] == b"TREE":
            return 24 + 64 * 8 + 65 * key
    raise ValueError(f"no node at {at}")


def open_ranges(path):
    """Returns [(from, to, data set)] of all bytes of an HDF5 file that no checksum covers: values, trees of chunks,
    long texts."""
    data, ranges, chunks = path.read_bytes(), [], set()

    def take(name, item):
        if not isinstance(item, h5py.Dataset):
            return
        for i in range(item.id.get_num_chunks() if item.chunks else 0):
            chunk = item.id.get_chunk_info(i)
            chunks.add(chunk.byte_offset)
            ranges.append((chunk.byte_offset, chunk.byte_offset + chunk.size, name))
        if item.id.get_offset() is not None:
            ranges.append((item.id.get_offset(), item.id.get_offset() + item.id.get_storage_size(), name))

    with h5py.File(path) as file:
        for group in set(file) - {"VTKHDF"}:  # `hifdm diff` leaves that out, but its links lead to other data sets
            file[group].visititems(lambda name, item: take(f"{group}/{name}", item))
        file.visititems(lambda name, item: take("", item))
    for match in re.finditer(b"TREE|GCOL", data):
        at = match.start()
        if not any(low <= at < high for low, high, _ in ranges):
            is_tree = match.group() == b"TREE"
            size = node_bytes(data, at, chunks) if is_tree else struct.unpack_from("<Q", data, at + 8)[0]
            ranges.append((at, at + size, ""))
    return ranges


def has_changed(folder, words, data_set):
    """Returns true if the two files of `diff` differ in this data set. Two NaN are equal."""
    values = []
    for name in words.split()[1:3]:
        with h5py.File(folder / name) as file:
            values.append(file[data_set][()])
    a, b = values
    return not ((a == b) | ((a != a) & (b != b)) if a.dtype.kind == "f" else a == b).all()
