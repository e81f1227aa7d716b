"""Read PLY (Stanford polygon format), ascii and binary: vertices, or points sampled on a mesh.

No library is used: Open3D's reader crashes on damaged ascii files (docs/method.md), and plyfile is
under the GPL. Format: http://paulbourke.net/dataformats/ply
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import excerpt
from baker.scans.formats import Columns, FormatError, require_count, require_room
from baker.scans.formats.mesh import points_on_surface
from baker.scans.formats.text import as_type, read_numbers

CORNERS = ("vertex_indices", "vertex_index")  # names of the list of a face's corners
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
NAMES = {"i1": "char int8", "u1": "uchar uint8 bool", "i2": "short int16", "u2": "ushort uint16"}
NAMES |= {"i4": "int int32", "u4": "uint uint32", "f4": "float float32", "f8": "double float64"}
TYPES = {name: kind for kind, names in NAMES.items() for name in names.split()}

Types = dict[str, tuple[str, str | None]]
"""Property -> dtype of its values and, for a list, dtype of its length, else None."""

Values = dict[str, NDArray | list[NDArray]]
"""Property -> (N,) numbers; for a list (N, k) if all are equally long, else N arrays."""


def read(path: Path) -> Columns:
    """Read the vertices' properties, except for lists; of a mesh, sampled on its faces.

    Raises FormatError: not PLY, no vertices, or a body that does not match the header.
    """
    content = path.read_bytes()
    newline = re.match(rb"ply[ \t]*(\r\n|\r|\n)", content)
    if not newline:
        raise FormatError("is not a PLY file: its first line isn't 'ply'.")
    end = re.search(rb"%b(end_header[ \t]*(?:%b|\Z))" % (newline[1], newline[1]), content)
    if not end:
        raise FormatError("has a PLY header without an end ('end_header').")
    header, body = content[: end.end()].decode("latin-1"), memoryview(content)[end.end() :]
    order, elements = _parse_header(header)
    if "vertex" not in elements:
        found = excerpt(", ".join(elements)) or "none"
        raise FormatError(f"has no element 'vertex' (it has {found}).")
    if not order:  # converted to a binary body of float64
        body = read_numbers(bytes(body), len(header.splitlines()) + 1).data.cast("B")
    values, offset = dict[str, Values](), 0
    for name, (count, types) in elements.items():
        if not order:
            types = {key: ("f8", length and "f8") for key, (_, length) in types.items()}
        values[name], offset = _read_element(body, offset, count, types)
    if not order:
        require_count(offset // 8, len(body) // 8, "values")
    columns = {
        name: as_type(np.asarray(values["vertex"][name]), kind)
        for name, (kind, length) in elements["vertex"][1].items()
        if length is None
    }
    faces = values.get("face", {})
    return points_on_surface(columns, next((faces[name] for name in CORNERS if name in faces), ()))


def _parse_header(header: str) -> tuple[str, dict[str, tuple[int, Types]]]:
    """Parse the byte order ("" for ascii), and the number and the properties of each element."""
    order, elements, types = "", dict[str, tuple[int, Types]](), Types()
    for line in re.split("\r\n|\r|\n", header)[1:]:
        match line.split():
            case ["format", form, _] if form in ORDERS and not elements:
                order = ORDERS[form]
            case ["element", name, count] if count.isdecimal() and name not in elements:
                types = {}
                elements[name] = int(count), types
            case ["property", kind, name] if elements and kind in TYPES and name not in types:
                types[name] = order + TYPES[kind], None
            case ["property", "list", length, kind, name] if (
                elements and {length, kind} <= {*TYPES} and name not in types
            ):
                types[name] = order + TYPES[kind], order + TYPES[length]
            case [] | ["comment" | "obj_info" | "end_header", *_]:
                pass
            case _:
                found = excerpt(line.strip())
                raise FormatError(f"has a PLY header whose line '{found}' is unknown or repeated.")
    return order, elements


def _read_element(body: memoryview, offset: int, count: int, types: Types) -> tuple[Values, int]:
    """Read the values of an element that starts at `offset`; also returns the offset of its end."""
    if not count or not types:
        return {name: np.empty(0) for name in types}, offset
    first, _ = _read_rows(body, offset, 1, types)
    fields: list[tuple] = []
    for name, (kind, length) in types.items():
        fields += [(f"length of {name}", length)] if length else []
        fields.append((name, kind, first[name][0].shape if length else ()))
    record = np.dtype(fields)
    lengths = [name for name in record.names or () if name not in types]
    if not lengths:
        require_room(count, record.itemsize, len(body) - offset)
    # If all lists are as long as those of the first row, the rows are records.
    if count * record.itemsize <= len(body) - offset:
        rows = np.frombuffer(body, record, count, offset)
        if all((rows[name] == rows[name][0]).all() for name in lengths):
            return {name: rows[name] for name in types}, offset + rows.nbytes
    values, end = _read_rows(body, offset, count, types)
    scalars = {name: np.concatenate(values[name]) for name in types if not types[name][1]}
    return {**values, **scalars}, end


def _read_rows(
    body: memoryview, offset: int, count: int, types: Types
) -> tuple[dict[str, list[NDArray]], int]:
    """Read `count` rows one by one, with lists of any length; also returns the end's offset."""

    def take(kind: str, number: int) -> NDArray:
        nonlocal offset
        if number < 0:
            raise FormatError(f"holds a list of {number} values, which can't be.")
        values = np.frombuffer(body, kind, number, offset)
        offset += values.nbytes
        return values

    values: dict[str, list[NDArray]] = {name: [] for name in types}
    for _ in range(count):
        for name, (kind, length) in types.items():
            values[name].append(take(kind, int(take(length, 1)[0]) if length else 1))
    return values, offset
