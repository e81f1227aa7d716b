"""PLY (Stanford polygon format), ascii and binary: the vertices, or points on a mesh's surface.

Read here: Open3D's reader ends the process at damaged ascii files (docs/method.md), and plyfile is
under the GPL. Format: http://paulbourke.net/dataformats/ply
"""

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import excerpt
from baker.scans.cloud import Columns
from baker.scans.formats import FormatError, require_count, require_room
from baker.scans.formats.mesh import Faces, points_on_surface
from baker.scans.formats.text import read_lines, read_rows

MAX_HEADER_BYTES = 1 << 20
CORNERS = ("vertex_indices", "vertex_index")  # of a face; both names are in use
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
NAMES = {"i1": "char int8", "u1": "uchar uint8 bool", "i2": "short int16", "u2": "ushort uint16"}
NAMES |= {"i4": "int int32", "u4": "uint uint32", "f4": "float float32", "f8": "double float64"}
TYPES = {name: kind for kind, names in NAMES.items() for name in names.split()}

Values = dict[str, NDArray | list[NDArray]]
"""By property (N,) numbers; of lists (N, k) where all are as long as the first, else N arrays."""


@dataclass(frozen=True)
class Property:
    name: str
    type: np.dtype
    length: np.dtype | None = None  # of a list the type of its length


@dataclass(frozen=True)
class Element:
    name: str
    count: int
    properties: tuple[Property, ...] = ()


def read(path: Path) -> Columns:
    """The properties of the vertices that are no lists; of a mesh, of points sampled on its faces.

    Raises FormatError: not PLY, no vertices, or a body that doesn't hold what the header announces.
    """
    header = _header(path)
    order, elements = _announced(header, path.stat().st_size)
    names = [element.name for element in elements]
    if "vertex" not in names:
        found = excerpt(", ".join(names)) or "none"
        raise FormatError(f"has no element 'vertex' (it has {found}).")
    values: dict[str, Values] = {}
    if order:
        body, place = np.fromfile(path, np.uint8, offset=len(header)), 0
        for element in elements:
            values[element.name], place = _binary(body, place, element)
    else:
        lines, number = read_lines(path, "latin-1"), len(_lines(header)) - 1
        for element in elements:
            stop = number + element.count
            values[element.name] = _ascii(lines[number:stop], element, number + 1)
            number = stop
    vertex, faces = elements[names.index("vertex")], values.get("face", {})
    columns = {
        one.name: np.asarray(values["vertex"][one.name])
        for one in vertex.properties
        if one.length is None
    }
    corners: Faces = next((faces[name] for name in CORNERS if name in faces), ())
    return points_on_surface(columns, corners)


def _header(path: Path) -> bytes:
    with path.open("rb") as file:
        start = file.read(MAX_HEADER_BYTES)
    first = re.match(rb"ply[ \t]*(\r\n|\r|\n)", start)
    if not first:
        raise FormatError("is not a PLY file: its first line isn't 'ply'.")
    end = re.search(first[1] + rb"end_header[ \t]*(" + first[1] + rb"|\Z)", start)
    if not end:
        raise FormatError("has a PLY header without an end ('end_header').")
    return start[: end.end()]


def _lines(header: bytes) -> list[str]:
    return re.split("\r\n|\r|\n", header.decode("latin-1"))


def _announced(header: bytes, size: int) -> tuple[str, list[Element]]:
    """Order of the bytes ("" of a text) and elements, of which the file has room for all."""
    order, elements = "", list[Element]()
    for line in _lines(header)[1:]:
        match line.split():
            case ["format", form, _] if form in ORDERS and not elements:
                order = ORDERS[form]
            case ["element", name, count] if count.isascii() and count.isdigit():
                elements.append(Element(name, int(count[:18])))
                require_room(
                    max(elements[-1].count, 1), bool(elements[-1].count), size - len(header)
                )
            case ["property", kind, name] if elements and kind in TYPES:
                _add(elements, Property(name, np.dtype(order + TYPES[kind])))
            case ["property", "list", length, kind, name] if elements and {length, kind} <= {
                *TYPES
            }:
                types = np.dtype(order + TYPES[kind]), np.dtype(order + TYPES[length])
                _add(elements, Property(name, *types))
            case [] | ["comment" | "obj_info" | "end_header", *_]:
                pass
            case _:
                raise FormatError(f"has a PLY header that says '{excerpt(line.strip())}'.")
    return order, elements


def _add(elements: list[Element], new: Property) -> None:
    last = elements[-1]
    if new.name in (one.name for one in last.properties):
        raise FormatError(f"has a PLY header that names '{excerpt(new.name)}' twice.")
    elements[-1] = replace(last, properties=(*last.properties, new))


def _binary(body: NDArray[np.uint8], place: int, element: Element) -> tuple[Values, int]:
    """Values of an element that begins at a byte, and the byte where the next one begins."""
    if not element.properties:
        return {}, place
    fields, end = list[tuple](), place
    for number, one in enumerate(element.properties):  # lists are mostly as long as the first
        if one.length and element.count:
            (length,) = _numbers(body, end, one.length, 1)
            fields.append((f"length {number}", one.length))
            fields.append((f"values {number}", one.type, (_require_length(length, body),)))
            end += one.length.itemsize + int(length) * one.type.itemsize
        else:
            fields.append((f"values {number}", one.type))
    record = np.dtype(fields)
    if place + element.count * record.itemsize <= len(body):
        rows = _numbers(body, place, record, element.count)
        lengths = [rows[name] for name in record.names or () if name.startswith("length")]
        if all((own == own[0]).all() for own in lengths):
            names = (one.name for one in element.properties)
            found: Values = {name: rows[f"values {number}"] for number, name in enumerate(names)}
            return found, place + rows.nbytes
    elif not any(one.length for one in element.properties):
        require_room(element.count, record.itemsize, len(body) - place)
    values: dict[str, list[NDArray]] = {one.name: [] for one in element.properties}
    for _ in range(element.count):
        for one in element.properties:
            length = 1
            if one.length:
                length = _require_length(_numbers(body, place, one.length, 1)[0], body)
                place += one.length.itemsize
            values[one.name].append(_numbers(body, place, one.type, length))
            place += length * one.type.itemsize
    return _joined(values, element), place


def _numbers(body: NDArray[np.uint8], place: int, kind: np.dtype, count: int) -> NDArray:
    require_room(max(count, 1), kind.itemsize * bool(count), len(body) - place)
    return body[place : place + count * kind.itemsize].view(kind)


def _require_length(length: float, body: NDArray) -> int:
    if not 0 <= length <= len(body):
        raise FormatError(f"holds a list of {length:g} values, which can't be.")
    return int(length)


def _ascii(lines: Sequence[str], element: Element, number: int) -> Values:
    """Values of an element of whose lines the first one has this number in the file."""
    require_count(element.count, len(lines), f"lines of '{excerpt(element.name)}'")
    names = [one.name for one in element.properties]
    if not any(one.length for one in element.properties):
        record = np.dtype([(one.name, one.type) for one in element.properties])
        if not (lines and names):
            return {name: np.empty(0) for name in names}
        rows = read_rows(lines, names, number, kind=record)
        require_count(element.count, len(rows), "rows")
        return {name: rows[name][:, 0] for name in names}
    if len(names) == 1 and lines:
        with suppress(ValueError):  # lists that are all as long
            table = np.loadtxt(lines, element.properties[0].type, ndmin=2)
            if len(table) == element.count and (table[:, 0] == table.shape[1] - 1).all():
                return {names[0]: table[:, 1:]}
    values: dict[str, list[NDArray]] = {name: [] for name in names}
    for line, text in enumerate(lines, number):
        words = text.split()
        for one in element.properties:
            length = int(words.pop(0)) if one.length and words else 1
            if not 0 <= length <= len(words):
                raise FormatError(f"fewer values than '{excerpt(one.name)}' needs.", line)
            values[one.name].append(np.array(words[:length], float).astype(one.type))
            del words[:length]
    return _joined(values, element)


def _joined(values: dict[str, list[NDArray]], element: Element) -> Values:
    numbers = (one.name for one in element.properties if not one.length and element.count)
    return {**values, **{name: np.concatenate(values[name]) for name in numbers}}
