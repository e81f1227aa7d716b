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

Values = dict[str, NDArray | list[NDArray]]
"""Property -> (N,) numbers; for a list (N, k) if all are equally long, else N arrays."""


@dataclass(frozen=True)
class Element:
    """An element of the header (vertex, face): how many there are, and their properties.

    properties: name -> dtype of the values and, for a list, dtype of its length, else None.
    """

    count: int
    properties: dict[str, tuple[str, str | None]] = field(default_factory=dict)


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
        values[name], offset = _read_element(body, offset, element, order)
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
    body: NDArray[np.uint8], offset: int, element: Element, order: str
) -> tuple[Values, int]:
    """Read the values of an element that starts at `offset`; also returns the offset of its end."""

    def take(kind: str, count: int) -> NDArray:
        nonlocal offset
        dtype = np.dtype(kind if order else float)
        require_room(max(count, 1), dtype.itemsize * (count > 0), len(body) - offset)
        start, offset = offset, offset + count * dtype.itemsize
        return body[start:offset].view(dtype)

    def take_property(kind: str, length: str | None) -> NDArray:
        (count,) = take(length, 1) if length else (1,)
        if not 0 <= count <= len(body):
            raise FormatError(f"holds a list of {count:g} values, which can't be.")
        return take(kind, int(count))

    begin, count = offset, element.count
    if not count or not element.properties:
        return {name: np.empty(0) for name in element.properties}, offset
    first = {name: take_property(*types) for name, types in element.properties.items()}
    # If all lists are as long as those of the first row, the element is one structured array.
    fields = list[tuple]()
    for name, (_, length) in element.properties.items():
        if length:
            fields.append((f"length of {name}", length if order else float))
        shape = (len(first[name]),) if length else ()
        fields.append((name, first[name].dtype, shape))
    record = np.dtype(fields)
    end = begin + count * record.itemsize
    if all(name in first for name in record.names or ()):  # no property is a list
        require_room(count, record.itemsize, len(body) - begin)
    if end <= len(body):
        rows = body[begin:end].view(record)
        lengths = [rows[name] for name, *_ in fields if name not in first]
        if all((length == length[0]).all() for length in lengths):
            return {name: rows[name] for name in first}, end
    values = {name: [array] for name, array in first.items()}
    for _ in range(count - 1):
        for name, types in element.properties.items():
            values[name].append(take_property(*types))
    return {
        name: arrays if element.properties[name][1] else np.concatenate(arrays)
        for name, arrays in values.items()
    }, offset
