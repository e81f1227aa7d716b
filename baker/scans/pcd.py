"""PCD (Point Cloud Library), ascii, binary and binary_compressed.

Packed colours (`rgb`, `rgba`: four bytes in one number) come out as red, green and blue.
Format: https://pointclouds.org/documentation/tutorials/pcd_file_format.html

Read here rather than by a library for the reasons given in `baker.scans.ply`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, excerpt
from baker.scans.cloud import Columns
from baker.scans.rows import Layout, as_type, read_rows, require_room

KINDS = {"F": {"4", "8"}, "I": {"1", "2", "4", "8"}, "U": {"1", "2", "4", "8"}}
ENCODINGS = ("ascii", "binary", "binary_compressed")
LONGEST_HEADER = 100
MOST_VALUES = 10_000  # of a point; the largest descriptors have some thousand
LZF_RATIO = 88
"""LZF turns at most 264 bytes into 3."""


@dataclass(frozen=True)
class _Header:
    """record: one point as it stands in the file; size in bytes and in lines, DATA included."""

    record: np.dtype
    count: int
    encoding: str
    size: int
    lines: int


def read(path: Path) -> Columns:
    """All fields; of a field with several values a point each value as a field of its own.

    Raises InputError: not PCD, a header out of order, or a body that doesn't hold what it says.
    """
    header = _read_header(path)
    if header.count == 0:
        raise InputError(f"'{path}' holds no points.")
    read_body = {
        "ascii": _read_ascii,
        "binary": _read_binary,
        "binary_compressed": _read_compressed,
    }[header.encoding]
    return Columns(_unpack_colors(read_body(path, header)))


def _read_ascii(path: Path, header: _Header) -> dict[str, NDArray]:
    names = header.record.names or ()
    room = path.stat().st_size - header.size
    require_room(path, header.count, 2 * len(names) - 1, room)
    layout = Layout(header.lines + 1, names)
    rows = read_rows(path, layout, encoding="latin-1")
    if len(rows) != header.count:
        raise InputError(
            f"'{path}' is cut short, or its header is wrong: it announces {header.count} points, "
            f"but {len(rows)} rows follow."
        )
    return {name: as_type(header.record[name], rows[:, i]) for i, name in enumerate(names)}


def _read_binary(path: Path, header: _Header) -> dict[str, NDArray]:
    room = path.stat().st_size - header.size
    require_room(path, header.count, header.record.itemsize, room, is_all=True)
    points = np.fromfile(path, header.record, header.count, offset=header.size)
    return {name: points[name] for name in header.record.names or ()}


def _read_compressed(path: Path, header: _Header) -> dict[str, NDArray]:
    """Two sizes (packed and not), then LZF: all values of the first field, of the second, …"""
    import lzf  # type: ignore[import-not-found, unused-ignore]

    room = path.stat().st_size - header.size - 8
    size = header.count * header.record.itemsize
    require_room(path, header.count, header.record.itemsize / LZF_RATIO, room)
    with path.open("rb") as file:
        file.seek(header.size)
        packed_size, announced_size = (int(n) for n in np.frombuffer(file.read(8), "<u4"))
        packed = file.read(min(packed_size, room))
    try:
        body = lzf.decompress(packed, size) if len(packed) == packed_size else None
    except ValueError:
        body = None
    if body is None or len(body) != size or announced_size != size:
        raise InputError(
            f"'{path}' is cut short or damaged: its compressed data don't unpack to the "
            f"{header.count} points ({size} bytes) that the header announces."
        )
    columns, start = {}, 0
    for name in header.record.names or ():
        columns[name] = np.frombuffer(body, header.record[name], header.count, start)
        start += columns[name].nbytes
    return columns


def _unpack_colors(columns: dict[str, NDArray]) -> dict[str, NDArray]:
    """Red, green and blue from a packed field, blue in the lowest byte."""
    for name, values in columns.items():
        if name.lower() in ("rgb", "rgba") and values.dtype.itemsize == 4:
            packed = np.ascontiguousarray(values).view("<u4")
            channels = {"red": 16, "green": 8, "blue": 0}
            rest = {other: column for other, column in columns.items() if other != name}
            return rest | {c: (packed >> shift).astype(np.uint8) for c, shift in channels.items()}
    return columns


def _read_header(path: Path) -> _Header:
    words: dict[str, list[str]] = {}
    with path.open("rb") as file:
        for number in range(1, LONGEST_HEADER):
            line = file.readline(4096)
            if not line or b"\0" in line:
                break
            key, *values = line.decode("latin-1").split() or ["#"]
            if not key.startswith("#"):
                words[key] = values
            if key == "DATA":
                return _parse_header(path, words, file.tell(), number)
    raise InputError(f"'{path}' is not a PCD file: its header has no line 'DATA'.")


def _parse_header(path: Path, words: dict[str, list[str]], size: int, lines: int) -> _Header:
    def fault(what: str) -> InputError:
        return InputError(f"'{path}': its PCD header {what}.")

    for key in ("FIELDS", "SIZE", "TYPE", "POINTS", "DATA"):
        if not words.get(key):
            raise fault(f"has no line '{key}'")
    fields = words["FIELDS"]
    counts = words.get("COUNT", ["1"] * len(fields))
    for key, values in (("SIZE", words["SIZE"]), ("TYPE", words["TYPE"]), ("COUNT", counts)):
        if len(values) != len(fields):
            raise fault(f"has {len(fields)} FIELDS, but {len(values)} values of {key}")

    record: list[tuple[str, str]] = []
    for name, kind, width, count in zip(fields, words["TYPE"], words["SIZE"], counts, strict=True):
        if width not in KINDS.get(kind, ()):
            unknown = f"{excerpt(kind)} of size {excerpt(width)}"
            raise fault(f"gives the field '{excerpt(name)}' the unknown type {unknown}")
        if not re.fullmatch("0*[1-9][0-9]{0,3}", count) or int(count) > 4095:
            raise fault(
                f"gives the field '{excerpt(name)}' the COUNT {excerpt(count)}; 1 to 4095 are "
                "possible"
            )
        for i in range(int(count)):
            # Padding is named "_", as often as it occurs; other values of a field are numbered.
            unique = f"_{len(record)}" if name == "_" else f"{name}[{i}]" if i else name
            record.append((unique, f"<{kind.lower()}{width}"))
        if len(record) > MOST_VALUES:
            raise fault(f"gives a point more than {MOST_VALUES} values")
    names = [name for name, _ in record]
    if len(set(names)) < len(names):
        raise fault("names a field twice")

    points, (encoding, *_) = words["POINTS"][0], words["DATA"]
    if not re.fullmatch("[0-9]{1,18}", points):
        raise fault(f"announces '{excerpt(points)}' POINTS, which is no number of points")
    if encoding not in ENCODINGS:
        raise fault(
            f"names the unknown DATA '{excerpt(encoding)}'; known are {', '.join(ENCODINGS)}"
        )
    return _Header(np.dtype(record), int(points), encoding, size, lines)
