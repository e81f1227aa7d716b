"""Read PCD (Point Cloud Library), ascii, binary and binary_compressed.

Packed colours (`rgb`, `rgba`: four bytes in one number) are split into red, green and blue.
Format: https://pointclouds.org/documentation/tutorials/pcd_file_format.html

No library is used: Open3D's reader crashes on damaged files, and pypcd4 reads a truncated file as a
smaller one (docs/method.md).
"""

import re
from pathlib import Path

import numpy as np

from baker.errors import excerpt
from baker.scans.formats import Columns, FormatError, require_count, require_room

LZF_RATIO = 88  # LZF turns at most 264 bytes into 3


def read(path: Path) -> Columns:
    """Read all fields but those that have several values for each point."""
    content = path.read_bytes()
    end = re.search(rb"^[ \t]*DATA\b[^\n]*\n?", content, re.MULTILINE)
    if not end:
        raise FormatError("is not a PCD file: its header has no line 'DATA'.")
    header, body = content[: end.end()].decode("latin-1"), content[end.end() :]
    words = {key: values for key, *values in map(str.split, filter(str.strip, header.split("\n")))}
    record, count, encoding = _record(words), int(words["POINTS"][0]), words["DATA"][0]
    names = record.names or ()
    if encoding == "ascii":
        points = np.loadtxt(body.decode("latin-1").splitlines(), record, comments=None, ndmin=1)
        require_count(count, len(points))
    elif encoding == "binary":
        require_room(count, record.itemsize, len(body))
        points = np.frombuffer(body, record, count)
    elif encoding == "binary_compressed":
        # The sizes of packed and unpacked data are followed by the packed fields, one by one.
        require_room(count, record.itemsize / LZF_RATIO, len(body))
        packed = body[8 : 8 + int.from_bytes(body[:4], "little")]
        unpacked = decompress(packed, count * record.itemsize)
        points, offset = np.empty(count, record), 0
        for name in names:
            points[name] = np.frombuffer(unpacked, record[name], count, offset)
            offset += points[name].nbytes
    else:
        raise FormatError(f"has the unknown DATA '{excerpt(encoding)}'.")
    columns = {name: points[name] for name in names if points[name].ndim == 1}
    for name in [n for n in columns if n.lower() in ("rgb", "rgba") and record[n].itemsize == 4]:
        channels = np.ascontiguousarray(columns.pop(name)).view(np.uint8).reshape(-1, 4)
        columns |= dict(zip(("blue", "green", "red"), channels.T, strict=False))
    return Columns(columns)


def _record(words: dict[str, list[str]]) -> np.dtype:
    """The dtype of one point in the file, from FIELDS, SIZE, TYPE and COUNT."""
    if missing := [key for key in ("FIELDS", "SIZE", "TYPE", "POINTS") if not words.get(key)]:
        raise FormatError(f"has a PCD header without a line '{missing[0]}'.")
    fields, kinds, sizes = words["FIELDS"], words["TYPE"], words["SIZE"]
    counts = map(int, words.get("COUNT", ["1"] * len(fields)))
    record: list[tuple] = []
    for name, kind, size, count in zip(fields, kinds, sizes, counts, strict=True):
        if not re.fullmatch("F[48]|[IU][1248]", kind + size):
            field = excerpt(f"'{name}' the TYPE {kind} and the SIZE {size}")
            raise FormatError(f"has a PCD header that gives the field {field}, which can't be.")
        # Several fields may be called "_" (padding).
        unique = f"_{len(record)}" if name == "_" else name
        record.append((unique, f"<{kind.lower()}{size}", () if count == 1 else (count,)))
    return np.dtype(record)


def decompress(packed: bytes, size: int) -> bytes:
    """Unpack LZF data to `size` bytes. Raises ValueError or IndexError where they are damaged.

    A control byte below 32 is followed by literal bytes; any other one encodes a copy of earlier
    output by length and distance. Format: Marc Lehmann, liblzf.
    """
    result, offset = bytearray(), 0
    while offset < len(packed) and len(result) <= size:
        control, offset = packed[offset], offset + 1
        if control < 32:
            result += packed[offset : offset + control + 1]
            offset += control + 1
            continue
        length = (control >> 5) + 2
        if length == 9:
            length, offset = length + packed[offset], offset + 1
        start, offset = len(result) - ((control & 31) << 8) - packed[offset] - 1, offset + 1
        if start < 0:
            raise ValueError("an LZF reference points before the data")
        run = result[start : start + length]
        result += (run * -(-length // len(run)))[:length]  # a copy may overlap its own output
    if len(result) != size or offset != len(packed):
        raise ValueError("LZF data of another size")
    return bytes(result)
