"""Read PLY (Stanford polygon format), ascii and binary: vertices, or points sampled on a mesh.

No library is used: Open3D's reader crashes on damaged ascii files (docs/method.md), and plyfile is
under the GPL. Format: http://paulbourke.net/dataformats/ply
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import excerpt
from baker.scans.formats import Columns, FormatError, require_count
from baker.scans.formats.mesh import points_on_surface

HEADER = rb"ply[ \t]*(\r\n|\r|\n)(.*?)\1end_header[ \t]*(?:\1|\Z)"
CORNERS = ("vertex_indices", "vertex_index")  # names of the list of a face's corners
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
NAMES = {"i1": "char int8", "u1": "uchar uint8 bool", "i2": "short int16", "u2": "ushort uint16"}
NAMES |= {"i4": "int int32", "u4": "uint uint32", "f4": "float float32", "f8": "double float64"}
TYPES = {name: kind for kind, names in NAMES.items() for name in names.split()}

Types = dict[str, tuple[str, str | None]]
"""Property -> dtype of its values and, for a list, dtype of its length, else None."""


def read(path: Path) -> Columns:
    """Read the properties of the vertices, except for lists; of a mesh, of points on its faces."""
    content = path.read_bytes()
    header = re.match(HEADER, content, re.DOTALL)
    if not header:
        raise FormatError("is not a PLY file: it has no header from 'ply' to 'end_header'.")
    body: bytes | memoryview = memoryview(content)[header.end() :]
    order, elements = _parse_header(header[2].decode("latin-1"))
    if not all(elements.get("vertex", ())):
        listed = excerpt(", ".join(elements)) or "none"
        raise FormatError(f"holds no points: of its elements ({listed}) none is a filled 'vertex'.")
    if not order:  # converted to a binary body of float64
        body = np.array(bytes(body).split(), float).tobytes()
    values, offset = dict[str, dict[str, list[NDArray]]](), 0
    for name, (count, types) in elements.items():
        if not order:
            types = {key: ("f8", length and "f8") for key, (_, length) in types.items()}
        values[name], offset = _read_element(body, offset, count, types)
    if not order:
        require_count(offset // 8, len(body) // 8, "values")
    columns = {
        name: np.concatenate(values["vertex"][name])
        for name, (_, length) in elements["vertex"][1].items()
        if length is None
    }
    faces = values.get("face", {})
    return points_on_surface(columns, next((faces[name] for name in CORNERS if name in faces), []))


def _parse_header(header: str) -> tuple[str, dict[str, tuple[int, Types]]]:
    """Parse the byte order ("" for ascii), and the number and the properties of each element."""
    order, elements, types = "", dict[str, tuple[int, Types]](), Types()
    for line in re.split("\r\n|\r|\n", header):
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
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                wrong = excerpt(line.strip())
                raise FormatError(f"has a PLY header whose line '{wrong}' is unknown or repeated.")
    return order, elements


def _read_element(
    body: bytes | memoryview, offset: int, count: int, types: Types
) -> tuple[dict[str, list[NDArray]], int]:
    """Read the values of an element that starts at `offset`; also return the offset of its end.

    The values of each property are a list of arrays to be concatenated, (n,) of numbers or (n, k)
    of lists: one array for each run of rows whose lists have the same lengths.
    """
    runs: list[NDArray] = []
    limit = 1
    while count and types:
        record = _record(body, offset, types)
        room = (len(body) - offset) // record.itemsize
        rows = np.frombuffer(body, record, max(1, min(count, room, limit)), offset)
        lengths = [rows[name] for name in record.names or () if name not in types]
        differ = np.any([length != length[0] for length in lengths], axis=0)
        runs.append(rows[: differ.argmax() or len(rows)])
        count -= len(runs[-1])
        offset += runs[-1].nbytes
        limit = 2 * len(runs[-1])  # so that many short runs take linear time, too
    return {name: [rows[name] for rows in runs] for name in types}, offset


def _record(body: bytes | memoryview, offset: int, types: Types) -> np.dtype:
    """The dtype of the row at `offset`; the length of each list precedes its values in the file."""
    fields: list[tuple] = []
    for name, (kind, length) in types.items():
        if length:
            position = offset + np.dtype(fields).itemsize
            fields.append((f"length of {name}", length))
            fields.append((name, kind, (int(np.frombuffer(body, length, 1, position)[0]),)))
        else:
            fields.append((name, kind))
    return np.dtype(fields)
