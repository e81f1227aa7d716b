"""PLY (Stanford polygon format), ascii and both binaries; of its elements only the vertices.

Read here rather than by a library: only the header is PLY's own (the body is rows of numbers or
packed records, which numpy reads), a mesh's faces are passed over unread, and no memory is made
for points that a header announces but the file can't hold.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from baker.errors import InputError, excerpt
from baker.scans.cloud import Columns
from baker.scans.rows import Layout, as_type, read_rows, require_room

TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
BYTE_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
LONGEST_HEADER = 1 << 20


@dataclass
class _Element:
    """properties: name -> numpy type, None for a list."""

    name: str
    count: int
    properties: dict[str, str | None] = field(default_factory=dict)

    @property
    def has_lists(self) -> bool:
        return None in self.properties.values()

    def record(self, byte_order: str) -> np.dtype:
        return np.dtype([(name, byte_order + str(kind)) for name, kind in self.properties.items()])


@dataclass(frozen=True)
class _Header:
    """byte_order: "<", ">", or "" for ascii; size in bytes and in lines, "end_header" included."""

    byte_order: str
    elements: Sequence[_Element]
    size: int
    lines: int


def read(path: Path) -> Columns:
    """The properties of the vertices.

    Raises InputError: not PLY, a header out of order, no vertices, lists among their properties,
    or a body that doesn't hold what the header announces.
    """
    header = _read_header(path)
    names = [element.name for element in header.elements]
    if "vertex" not in names:
        found = excerpt(", ".join(names)) or "none"
        raise InputError(f"'{path}' has no element 'vertex' (it has {found}).")
    index = names.index("vertex")
    before, vertex = header.elements[:index], header.elements[index]
    if vertex.has_lists:
        name = next(name for name, kind in vertex.properties.items() if kind is None)
        raise InputError(
            f"'{path}': the vertices' property '{excerpt(name)}' is a list; lists can't be read."
        )
    if not vertex.properties:
        raise InputError(f"'{path}': its vertices have no properties.")
    if vertex.count == 0:
        raise InputError(f"'{path}' holds no points.")
    if header.byte_order:
        is_last = index == len(names) - 1
        return _read_binary(path, header, before, vertex, is_last)
    return _read_ascii(path, header, before, vertex)


def _read_binary(
    path: Path, header: _Header, before: Sequence[_Element], vertex: _Element, is_last: bool
) -> Columns:
    start = header.size
    for element in before:
        if element.has_lists:
            raise InputError(
                f"'{path}': the element '{excerpt(element.name)}' before the vertices holds lists, "
                "which can't be passed over in a binary file; write the vertices first."
            )
        start += element.count * element.record(header.byte_order).itemsize
    record = vertex.record(header.byte_order)
    room = max(path.stat().st_size - start, 0)
    require_room(path, vertex.count, record.itemsize, room, is_all=is_last)
    vertices = np.fromfile(path, record, vertex.count, offset=start)
    return Columns({name: vertices[name] for name in vertex.properties})


def _read_ascii(
    path: Path, header: _Header, before: Sequence[_Element], vertex: _Element
) -> Columns:
    room = path.stat().st_size - header.size
    lines_before = sum(element.count for element in before)
    if lines_before > room:
        raise InputError(f"'{path}' ends before its {vertex.count} vertices.")
    require_room(path, vertex.count, 2 * len(vertex.properties) - 1, room)
    first_line = header.lines + 1 + lines_before
    layout = Layout(first_line, tuple(vertex.properties), comment=None)
    rows = read_rows(path, layout, vertex.count, encoding="latin-1")
    if len(rows) < vertex.count:
        raise InputError(
            f"'{path}' is cut short, or its header is wrong: it announces {vertex.count} points, "
            f"but {len(rows)} rows follow."
        )
    record = vertex.record("=")
    return Columns(
        {name: as_type(record[name], rows[:, i]) for i, name in enumerate(record.names or ())}
    )


def _read_header(path: Path) -> _Header:
    with path.open("rb") as file:
        if file.readline(16).rstrip() != b"ply":
            raise InputError(f"'{path}' is not a PLY file: its first line isn't 'ply'.")
        byte_order: str | None = None
        elements: list[_Element] = []
        for number in range(2, LONGEST_HEADER):
            line = file.readline(LONGEST_HEADER)
            if not line.endswith(b"\n") or file.tell() > LONGEST_HEADER:
                raise InputError(f"'{path}': its PLY header has no end ('end_header').")
            words = line.decode("latin-1").split()
            match words:
                case ["end_header"]:
                    if byte_order is None:
                        raise InputError(f"'{path}': its PLY header has no line 'format'.")
                    return _Header(byte_order, elements, file.tell(), number)
                case ["format", name, "1.0"] if name in BYTE_ORDERS:
                    byte_order = BYTE_ORDERS[name]
                case ["element", name, count] if re.fullmatch("[0-9]{1,18}", count):
                    elements.append(_Element(name, int(count)))
                case ["property", "list", length, item, name] if elements and {length, item} <= {
                    *TYPES
                }:
                    elements[-1].properties[name] = None
                case ["property", kind, name] if (
                    elements and kind in TYPES and name not in elements[-1].properties
                ):
                    elements[-1].properties[name] = TYPES[kind]
                case [] | ["comment" | "obj_info", *_]:
                    pass
                case _:
                    text = excerpt(" ".join(words))
                    raise InputError(
                        f"'{path}', line {number}: '{text}' is no valid PLY header line."
                    )
    raise InputError(f"'{path}': its PLY header has no end ('end_header').")
