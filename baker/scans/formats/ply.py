"""Read PLY (Stanford polygon format), ascii and binary: vertices, or points sampled on a mesh.

No library is used: Open3D's reader crashes on damaged ascii files (docs/method.md), and plyfile is
under the GPL. Format: http://paulbourke.net/dataformats/ply
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import excerpt
from baker.scans.formats import Columns, FormatError, require_count, require_room
from baker.scans.formats.mesh import points_on_surface
from baker.scans.formats.text import as_type, read_numbers

MAX_HEADER_BYTES = 1 << 20
CORNERS = ("vertex_indices", "vertex_index")  # names of the list of a face's corners
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
NAMES = {"i1": "char int8", "u1": "uchar uint8 bool", "i2": "short int16", "u2": "ushort uint16"}
NAMES |= {"i4": "int int32", "u4": "uint uint32", "f4": "float float32", "f8": "double float64"}
TYPES = {name: kind for kind, names in NAMES.items() for name in names.split()}

Types = dict[str, tuple[str, str | None]]
"""Property -> dtype of its values and, for a list, dtype of its length, else None."""

Values = dict[str, NDArray | list[NDArray]]
"""Property -> (N,) numbers; for a list (N, k) if all are equally long, else N arrays."""


@dataclass(frozen=True)
class Element:
    """An element of the header (vertex, face): how many there are, and their properties."""

    count: int
    properties: Types = field(default_factory=dict)


def read(path: Path) -> Columns:
    """Read the vertices' properties, except for lists; of a mesh, sampled on its faces.

    Raises FormatError: not PLY, no vertices, or a body that does not match the header.
    """
    with path.open("rb") as file:
        start = file.read(MAX_HEADER_BYTES)
    header = _header(start)
    order, elements = _parse_header(header.decode("latin-1"), path.stat().st_size - len(header))
    if "vertex" not in elements:
        found = excerpt(", ".join(elements)) or "none"
        raise FormatError(f"has no element 'vertex' (it has {found}).")
    if order:
        body = np.fromfile(path, np.uint8, offset=len(header))
    else:  # converted to a binary body of float64
        text = path.read_bytes()[len(header) :]
        body = read_numbers(text, len(header.splitlines()) + 1).view(np.uint8)
    values: dict[str, Values] = {}
    offset = 0
    for name, element in elements.items():
        types = element.properties
        if not order:
            types = {key: ("f8", length and "f8") for key, (_, length) in types.items()}
        values[name], offset = _read_element(body, offset, element.count, types)
    if not order:
        require_count(offset // 8, len(body) // 8, "values")
    columns = {
        name: as_type(np.asarray(values["vertex"][name]), kind)
        for name, (kind, length) in elements["vertex"].properties.items()
        if length is None
    }
    faces = values.get("face", {})
    return points_on_surface(columns, next((faces[name] for name in CORNERS if name in faces), ()))


def _header(start: bytes) -> bytes:
    first = re.match(rb"ply[ \t]*(\r\n|\r|\n)", start)
    if not first:
        raise FormatError("is not a PLY file: its first line isn't 'ply'.")
    end = re.search(first[1] + rb"end_header[ \t]*(" + first[1] + rb"|\Z)", start)
    if not end:
        raise FormatError("has a PLY header without an end ('end_header').")
    return start[: end.end()]


def _parse_header(header: str, room: int) -> tuple[str, dict[str, Element]]:
    """Parse the byte order ("" for ascii) and the elements, for which `room` bytes must suffice."""
    order, elements = "", dict[str, Element]()
    for line in re.split("\r\n|\r|\n", header)[1:]:
        match line.split():
            case ["format", form, _] if form in ORDERS and not elements:
                order = ORDERS[form]
            case ["element", name, count] if count.isascii() and count.isdigit():
                _require_new(name, elements)
                elements[name] = Element(int(count[:18]))
                require_room(max(elements[name].count, 1), elements[name].count > 0, room)
            case ["property", kind, name] if elements and kind in TYPES:
                _require_new(name, known := [*elements.values()][-1].properties)
                known[name] = order + TYPES[kind], None
            case ["property", "list", length, kind, name] if elements and {length, kind} <= {
                *TYPES
            }:
                _require_new(name, known := [*elements.values()][-1].properties)
                known[name] = order + TYPES[kind], order + TYPES[length]
            case [] | ["comment" | "obj_info" | "end_header", *_]:
                pass
            case _:
                raise FormatError(f"has a PLY header that says '{excerpt(line.strip())}'.")
    return order, elements


def _require_new(name: str, known: dict) -> None:
    if name in known:
        raise FormatError(f"has a PLY header that names '{excerpt(name)}' twice.")


def _read_element(
    body: NDArray[np.uint8], offset: int, count: int, types: Types
) -> tuple[Values, int]:
    """Read the values of an element that starts at `offset`; also returns the offset of its end."""
    if not count or not types:
        return {name: np.empty(0) for name in types}, offset
    first, _ = _read_rows(body, offset, 1, types)
    fields: list[tuple[str, str, tuple[int, ...]]] = []
    for name, (kind, length) in types.items():
        fields += [(f"length of {name}", length, ())] if length else []
        fields.append((name, kind, (len(first[name][0]),) if length else ()))
    record = np.dtype(fields)
    lengths = [name for name in record.names or () if name not in types]
    if not lengths:
        require_room(count, record.itemsize, len(body) - offset)
    end = offset + count * record.itemsize
    if end <= len(body):
        rows = body[offset:end].view(record)
        # All lists are as long as those of the first row.
        if all((rows[name] == rows[name][0]).all() for name in lengths):
            return {name: rows[name] for name in types}, end
    values, end = _read_rows(body, offset, count, types)
    return {
        name: arrays if types[name][1] else np.concatenate(arrays)
        for name, arrays in values.items()
    }, end


def _read_rows(
    body: NDArray[np.uint8], offset: int, count: int, types: Types
) -> tuple[dict[str, list[NDArray]], int]:
    """Read `count` rows one by one, with lists of any length; also returns the end's offset."""

    def take(kind: str, number: int) -> NDArray:
        nonlocal offset
        dtype = np.dtype(kind)
        require_room(max(number, 1), dtype.itemsize * (number > 0), len(body) - offset)
        start, offset = offset, offset + number * dtype.itemsize
        return body[start:offset].view(dtype)

    values: dict[str, list[NDArray]] = {name: [] for name in types}
    for _ in range(count):
        for name, (kind, length) in types.items():
            (number,) = take(length, 1) if length else (1,)
            if not 0 <= number <= len(body):
                raise FormatError(f"holds a list of {number:g} values, which can't be.")
            values[name].append(take(kind, int(number)))
    return values, offset
