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
from baker.scans.formats.text import as_type, read_numbers

TYPES = {"F4", "F8", "I1", "I2", "I4", "I8", "U1", "U2", "U4", "U8"}
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
    least = {
        "ascii": 2 * sum(widths) - 1,
        "binary": record.itemsize,
        "binary_compressed": record.itemsize / LZF_RATIO,
    }
    if form not in least:
        raise _header_fault(
            f"names the unknown DATA '{excerpt(form)}'; known are {', '.join(least)}"
        )
    require_room(count, least[form], len(body))
    if form == "ascii":
        numbers = read_numbers(body, header.count("\n") + 1)
        require_count(count * sum(widths), len(numbers), "values")
        parts = np.split(numbers.reshape(count, -1), np.cumsum(widths)[:-1], axis=1)
        fields = [as_type(part, record[name].base) for part, name in zip(parts, names, strict=True)]
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
    for name in [n for n in names if n.lower() in ("rgb", "rgba") and columns[n].itemsize == 4][:1]:
        channels = np.ascontiguousarray(columns.pop(name)).view(np.uint8).reshape(-1, 4)
        columns |= dict(zip(("blue", "green", "red"), channels.T, strict=False))
    return Columns(columns)


def decompress(packed: bytes, size: int) -> bytes:
    """Unpack LZF data to `size` bytes. Raises ValueError or IndexError where they are damaged.

    A control byte below 32 is followed by literal bytes; any other one encodes a copy of earlier
    output by length and distance. Format: Marc Lehmann, liblzf.
    """
    result, offset = bytearray(), 0
    while offset < len(packed) and len(result) <= size:
        control, offset = packed[offset], offset + 1
        if control < 32:
            run: bytes | bytearray = packed[offset : offset + control + 1]
            offset += control + 1
        else:
            length = (control >> 5) + 2
            if length == 9:
                length, offset = length + packed[offset], offset + 1
            start, offset = len(result) - ((control & 31) << 8) - packed[offset] - 1, offset + 1
            if start < 0:
                raise ValueError("an LZF reference points before the data")
            run = result[start : start + length]
            run *= -(-length // len(run))  # a copy may overlap its own output: a repeated pattern
            run = run[:length]
        result += run
    if len(result) != size or offset != len(packed):
        raise ValueError("LZF data of another size")
    return bytes(result)


def _record(words: dict[str, list[str]]) -> np.dtype:
    """The dtype of one point in the file, from FIELDS, SIZE, TYPE and COUNT."""
    for needed in ("FIELDS", "SIZE", "TYPE", "POINTS", "DATA"):
        if not words.get(needed):
            raise _header_fault(f"has no line '{needed}'")
    fields, kinds, sizes = words["FIELDS"], words["TYPE"], words["SIZE"]
    counts = words.get("COUNT", ["1"] * len(fields))
    if not len(fields) == len(kinds) == len(sizes) == len(counts):
        raise _header_fault(f"has {len(fields)} FIELDS, but not as many of TYPE, SIZE and COUNT")
    record: list[tuple[str, str, tuple[int]]] = []
    for name, kind, size, count in zip(fields, kinds, sizes, counts, strict=True):
        if kind + size not in TYPES or not re.fullmatch("0*[1-9][0-9]{0,4}", count):
            found = excerpt(f"'{name}' TYPE {kind}, SIZE {size} and COUNT {count}")
            raise _header_fault(f"gives the field {found}, which can't be")
        # Several fields may be called "_" (padding).
        unique = f"_{len(record)}" if name == "_" else name
        record.append((unique, f"<{kind.lower()}{size}", (int(count),)))
    return np.dtype(record)


def _header_fault(what: str) -> FormatError:
    return FormatError(f"has a PCD header that {what}.")
