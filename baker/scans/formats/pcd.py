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
    """Read all fields; one with several values for each point becomes several fields.

    Raises FormatError: not PCD, a wrong header, or a body that does not match its header.
    """
    content = path.read_bytes()
    end = re.search(rb"^[ \t]*DATA\b[^\n]*\n?", content, re.MULTILINE)
    if not end:
        raise FormatError("is not a PCD file: its header has no line 'DATA'.")
    header, body = content[: end.end()].decode("latin-1"), content[end.end() :]
    words = {key: values for key, *values in map(str.split, filter(str.strip, header.split("\n")))}
    record = _record(words)
    names = record.names or ()
    widths = [record[name].shape[0] for name in names]
    count, form = int(words["POINTS"][0]), words["DATA"][0]
    sizes = {
        "ascii": 2 * sum(widths) - 1,
        "binary": record.itemsize,
        "binary_compressed": record.itemsize / LZF_RATIO,
    }
    if form not in sizes:
        raise FormatError(f"has the unknown DATA '{excerpt(form)}'; known are {', '.join(sizes)}.")
    require_room(count, sizes[form], len(body))
    if form == "ascii":
        numbers = np.array(body.split(), float)
        require_count(count * sum(widths), len(numbers), "values")
        fields = np.split(numbers.reshape(count, -1), np.cumsum(widths)[:-1], axis=1)
    elif form == "binary":
        points = np.frombuffer(body, record, count)
        fields = [points[name] for name in names]
    else:  # the sizes of packed and of unpacked data; then field after field
        packed = body[8 : 8 + int.from_bytes(body[:4], "little")]
        fields, rest = [], memoryview(decompress(packed, count * record.itemsize))
        for name in names:
            fields.append(np.frombuffer(rest, record[name], count))
            rest = rest[fields[-1].nbytes :]
    columns = {
        f"{name}[{i}]" if i else name: column
        for name, values in zip(names, fields, strict=True)
        for i, column in enumerate(values.T)
    }
    for name in [n for n in names if n.lower() in ("rgb", "rgba") and record[n].itemsize == 4]:
        numbers = np.ascontiguousarray(columns.pop(name), record[name].base)
        channels = numbers.view(np.uint8).reshape(-1, 4).T
        columns |= dict(zip(("blue", "green", "red"), channels, strict=False))
    return Columns(columns)


def _record(words: dict[str, list[str]]) -> np.dtype:
    """The dtype of one point in the file, from FIELDS, SIZE, TYPE and COUNT."""
    if missing := [key for key in ("FIELDS", "SIZE", "TYPE", "POINTS") if not words.get(key)]:
        raise FormatError(f"has a PCD header without a line '{missing[0]}'.")
    fields, kinds, sizes = words["FIELDS"], words["TYPE"], words["SIZE"]
    counts = words.get("COUNT", ["1"] * len(fields))
    record: list[tuple[str, str, tuple[int]]] = []
    for name, kind, size, count in zip(fields, kinds, sizes, counts, strict=True):
        if not re.fullmatch("F[48]|[IU][1248]", kind + size):
            found = excerpt(f"'{name}' the TYPE {kind} and the SIZE {size}")
            raise FormatError(f"has a PCD header that gives the field {found}, which can't be.")
        # Several fields may be called "_" (padding).
        unique = f"_{len(record)}" if name == "_" else name
        record.append((unique, f"<{kind.lower()}{size}", (int(count),)))
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
