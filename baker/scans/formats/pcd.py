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
MAX_HEADER_BYTES = 1 << 19
MAX_VALUES = 10_000  # of a point; the largest descriptors have about a thousand
LZF_RATIO = 88  # LZF turns at most 264 bytes into 3


def read(path: Path) -> Columns:
    """Read all fields; one with several values for each point becomes several fields.

    Raises FormatError: not PCD, a wrong header, or a body that does not match its header.
    """
    words, start, lines = _read_header(path)
    record = _record(words)
    names = record.names or ()
    count, room = int(words["POINTS"][0]), path.stat().st_size - start
    match words["DATA"][0]:
        case "ascii":
            require_room(count, 2 * len(names) - 1, room)
            numbers = read_numbers(path.read_bytes()[start:], lines + 1)
            require_count(count * len(names), len(numbers), "values")
            table = numbers.reshape(count, len(names)).T
            columns = {n: as_type(row, record[n]) for n, row in zip(names, table, strict=True)}
        case "binary":
            require_room(count, record.itemsize, room)
            points = np.fromfile(path, record, count, offset=start)
            columns = {name: points[name] for name in names}
        case "binary_compressed":
            require_room(count, record.itemsize / LZF_RATIO, room - 8)
            content = path.read_bytes()[start:]  # sizes of packed and of unpacked data, LZF data
            packed_size = int.from_bytes(content[:4], "little")
            body = decompress(content[8 : 8 + packed_size], count * record.itemsize)
            columns, offset = {}, 0
            for name in names:  # field after field
                columns[name] = np.frombuffer(body, record[name], count, offset)
                offset += columns[name].nbytes
        case other:
            known = "ascii, binary, binary_compressed"
            raise _header_fault(f"names the unknown DATA '{excerpt(other)}'; known are {known}")
    for name in names:
        if name.lower() in ("rgb", "rgba") and columns[name].dtype.itemsize == 4:
            packed = np.ascontiguousarray(columns.pop(name)).view("<u4")
            shifts = {"red": 16, "green": 8, "blue": 0}
            columns |= {
                color: (packed >> shift).astype(np.uint8) for color, shift in shifts.items()
            }
            break
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


def _read_header(path: Path) -> tuple[dict[str, list[str]], int, int]:
    """The header as a dict, first word of a line -> the others; its size in bytes and in lines."""
    with path.open("rb") as file:
        head = file.read(MAX_HEADER_BYTES)
    end = re.search(rb"^[ \t]*DATA\b[^\n]*\n?", head, re.MULTILINE)
    if not end:
        raise FormatError("is not a PCD file: its header has no line 'DATA'.")
    text = head[: end.end()].decode("latin-1")
    words = {key: values for key, *values in map(str.split, filter(str.strip, text.split("\n")))}
    for needed in ("FIELDS", "SIZE", "TYPE", "POINTS", "DATA"):
        if not words.get(needed):
            raise _header_fault(f"has no line '{needed}'")
    return words, end.end(), text.count("\n")


def _record(words: dict[str, list[str]]) -> np.dtype:
    """The dtype of one point in the file, from FIELDS, SIZE, TYPE and COUNT."""
    fields = words["FIELDS"]
    counts = words.get("COUNT", ["1"] * len(fields))
    if not len(fields) == len(words["TYPE"]) == len(words["SIZE"]) == len(counts):
        raise _header_fault(f"has {len(fields)} FIELDS, but not as many of TYPE, SIZE and COUNT")
    record: list[tuple[str, str]] = []
    for name, kind, size, count in zip(fields, words["TYPE"], words["SIZE"], counts, strict=True):
        if kind + size not in TYPES or not re.fullmatch("0*[1-9][0-9]{0,4}", count):
            found = excerpt(f"'{name}' TYPE {kind}, SIZE {size} and COUNT {count}")
            raise _header_fault(f"gives the field {found}, which can't be")
        if len(record) + int(count) > MAX_VALUES:
            raise _header_fault(f"gives a point more than {MAX_VALUES} values")
        for i in range(int(count)):
            # Several fields may be called "_" (padding); further values of a field are numbered.
            unique = f"_{len(record)}" if name == "_" else f"{name}[{i}]" if i else name
            record.append((unique, f"<{kind.lower()}{size}"))
    return np.dtype(record)


def _header_fault(what: str) -> FormatError:
    return FormatError(f"has a PCD header that {what}.")
