"""Read text tables (XYZ, TXT, CSV, ASC, PTS); docs/scans.md says how columns are named."""

import re
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.errors import excerpt
from baker.scans.formats import Columns, FormatError, require_count
from baker.scans.labels import label_rank

LONGEST_LINE = 1 << 17  # characters
COMMENT = ("#", "//")
DELIMITERS = (";", "\t", ",", None)  # the last one is any white space
SKIPPED = ("-", "_")  # names of columns that are not used
MIN_COUNTED = 9  # number of rows up to which a column may count the rows by chance
USUAL_WIDTHS = range(3, 13)  # numbers of columns that can be read without a header
HINT = "say what the columns are, as in --columns label,x,y,z,- (- is not used)"


def read(path: Path, requested: Sequence[str] = ()) -> Columns:
    """Read all columns of numbers, and columns of words that may be labels.

    requested: the names of the columns, instead of those in a header ("-" or "_" skips one); a file
    may have fewer columns. Raises FormatError with the number of the line that does not fit.
    """
    lines = _read_lines(path)
    start, delimiter = _find_rows(lines)
    rows, first_line = lines[start:], start + 1
    values = _split(rows[0], delimiter)
    width = len(values)
    header, count = _read_head(lines[:start], delimiter, width)
    header = [*requested[:width]] or header  # some scans of a series may have no column of labels
    names = _column_names(header, width, first_line)
    used = [i for i, name in enumerate(names) if name not in SKIPPED]
    numbers = [i for i in used if _is_number(values[i])]
    words = [i for i in used if _is_word(values[i]) and label_rank(names[i]) is not None]
    unread = [names[i] for i in used if i not in numbers + words]
    if unread and not (header and {*"xyzXYZ"}.isdisjoint(unread)):
        raise _not_a_number(values, first_line, f"; {HINT}")

    load: Any = partial(np.loadtxt, rows, delimiter=delimiter, quotechar='"', ndmin=2)
    # A delimiter at the end of a row makes an empty column, which `usecols` leaves out.
    is_all = len(numbers) == len(rows[0].split(delimiter))
    try:
        table = load(usecols=None if is_all else numbers)
    except ValueError:
        _raise_fault(rows, first_line, delimiter, names, numbers)
        raise
    if count is not None:
        require_count(count, len(table), "rows")
    notes: tuple[str, ...] = ()
    if not header:
        if width > 3 and len(table) > MIN_COUNTED and (np.diff(table[:, 0]) == 1).all():
            raise FormatError(f"its first column counts the rows; {HINT}.")
        for i, name in zip(numbers, usual_names(table, is_leica=count is not None), strict=False):
            names[i] = name
        notes = (f"no header line: columns taken as {' '.join(names)}.",)
    elif unread:
        notes = (f"columns passed over, as they hold no numbers: {excerpt(', '.join(unread))}.",)
    columns = {names[i]: column for i, column in zip(numbers, table.T, strict=True)}
    if words:
        texts = np.char.strip(load(dtype=str, usecols=words)).T
        columns |= {names[i]: column for i, column in zip(words, texts, strict=True)}
    return Columns(columns, notes)


def usual_names(rows: NDArray, is_leica: bool = False) -> list[str]:
    """Name the first columns of a table without a header, by the rules of docs/scans.md."""
    names, width = ["x", "y", "z"], rows.shape[1]
    if is_leica and width in (4, 7):
        names.append("intensity")
    while width - len(names) >= 3:
        is_normal = (rows[:, len(names) : len(names) + 3] < 0).any()
        triple = ["nx", "ny", "nz"] if is_normal else ["red", "green", "blue"]
        if triple[0] in names:
            break
        names += triple
    return names


def _read_lines(path: Path) -> list[str]:
    """Read the lines of a text file in UTF-8 or, with a byte order mark, UTF-16.

    Between semicolons, commas become decimal points. Raises FormatError for a binary file, or a
    line that is too long for a row of numbers.
    """
    content = path.read_bytes()
    is_utf_16 = content.startswith((b"\xff\xfe", b"\xfe\xff"))
    if b"\0" in content and not is_utf_16:
        raise FormatError("is not a text file, though its suffix says so.")
    lines = content.decode("utf-16" if is_utf_16 else "utf-8-sig", "replace").splitlines()
    if longest := next((k for k, line in enumerate(lines, 1) if len(line) >= LONGEST_LINE), None):
        raise FormatError(f"{LONGEST_LINE} characters or more are no row of numbers.", longest)
    return [line.replace(",", ".") if ";" in line else line for line in lines]


def _find_rows(lines: Sequence[str]) -> tuple[int, str | None]:
    """Find the first row, which has three numbers or more, and its delimiter."""
    for index, line in enumerate(lines):
        for delimiter in () if line.lstrip().startswith(COMMENT) else DELIMITERS:
            values = _split(line, delimiter)
            # Several tabs in a row only align the columns.
            if sum(map(_is_number, values)) >= 3 and (delimiter != "\t" or all(values)):
                return index, delimiter
    raise FormatError("holds no row of numbers: at least x, y and z, with points in decimals.")


def _read_head(
    lines: Sequence[str], delimiter: str | None, width: int
) -> tuple[list[str] | None, int | None]:
    """Read the lines before the rows: the names of the columns, and the number of rows, or None."""
    header, count = None, None
    for line in map(str.strip, lines):
        if line.isdecimal():
            count = int(line[:18])
        elif line.startswith(COMMENT):
            splits = (_split(line.lstrip("#/ \t"), split_at) for split_at in (delimiter, None, ","))
            with_xyz = (s for s in splits if {"x", "y", "z"} <= {_axis(name).lower() for name in s})
            header = next((names for names in with_xyz if len(names) == width), header)
        elif line:
            header = _split(line, delimiter)
    return header, count


def _column_names(header: Sequence[str] | None, width: int, line: int) -> list[str]:
    """The names of the columns of a table, whose first row, in this line, has `width` values."""
    if not header and width in USUAL_WIDTHS:
        return [*"xyz", *(f"column {i + 1}" for i in range(3, width))]
    if not header:
        reason = f"{width} columns without a header line, of which 3 to 12 are understood"
        raise FormatError(f"{reason}; {HINT}.", line)
    if len(header) != width:
        reason = f"{width} columns, but {len(header)} names of columns"
        raise FormatError(f"{reason} ({excerpt(' '.join(header))}).", line)
    name, times = Counter(header).most_common(1)[0]
    if times > 1 and name not in SKIPPED:
        raise FormatError(f"has a header that names two columns '{excerpt(name)}'.")
    return [*map(_axis, header)]


def _raise_fault(
    rows: Sequence[str], line: int, delimiter: str | None, names: Sequence[str], numbers: list[int]
) -> None:
    """Raise FormatError for the first row that lacks a value, or has a word instead of a number."""
    for number, text in enumerate(rows, line):
        values = _split(text.partition("#")[0], delimiter)
        if values and len(values) != len(names):
            expected = f"{len(names)} expected ({excerpt(' '.join(names))})"
            raise FormatError(f"{len(values)} values found, but {expected}.", number) from None
        if values and not all(_is_number(values[i]) for i in numbers):
            hint = ", but the first row has one there"
            raise _not_a_number([values[i] for i in numbers], number, hint) from None


def _not_a_number(values: Sequence[str], line: int, hint: str = "") -> FormatError:
    """The FormatError for the first of these values that is not a number."""
    text = next((value for value in values if not _is_number(value)), values[0])
    hint = hint * _is_word(text)
    if re.fullmatch(r"[-+]?\d+,\d+", text):
        hint = "; write decimals with a point"
    return FormatError(f"'{excerpt(text)}' is not a number{hint}.", line)


def _axis(name: str) -> str:
    """Shorten "X (mm)", "x_coord" and "coordX" to the axis; other names are returned unchanged."""
    words = r"(?:coord(?:inate)?s?|pos(?:ition)?)?[ _.]?"
    axis = re.fullmatch(rf"{words}([xyz])[ _]?{words}[\[(]?(?:mm|cm|m)?[\])]?", name, re.IGNORECASE)
    return axis[1] if axis else name


def _split(line: str, delimiter: str | None) -> list[str]:
    """Split a line into values without quotes; empty values at its end are dropped."""
    values = [value.strip().strip("\"'") for value in line.strip().split(delimiter)]
    while values and not values[-1]:
        values.pop()
    return values


def _is_word(text: str) -> bool:
    return not _is_number(text) and bool(re.search(r"[^\W\d_]", text))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text  # which float() accepts between digits
