"""Read text tables (XYZ, TXT, CSV, ASC, PTS); docs/scans.md says how columns are named."""

import re
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from baker.errors import excerpt
from baker.scans.formats import Columns, FormatError, require_count
from baker.scans.labels import label_rank

LONGEST_LINE = 1 << 17
SKIPPED = ("-", "_")  # names of columns that are not used
MIN_COUNTED = 9  # in so few rows, a column may count the rows by chance
USUAL_WIDTHS = range(3, 13)  # numbers of columns that are understood without a header


def read(path: Path, asked: Sequence[str] = ()) -> Columns:
    """Read all columns of numbers, and columns of words that may be labels.

    `asked` names the columns instead of a header ("-" or "_" skips one); a file may have fewer
    columns. Raises FormatError with the number of the line that does not fit.
    """
    lines = _read_lines(path)
    header, delimiter, start, count = _read_head(lines, asked)
    rows, first_line = lines[start:], start + 1
    values = _split(rows[0], delimiter)
    width = len(values)
    names = _column_names(header, width, first_line)
    used = [i for i, name in enumerate(names) if name not in SKIPPED]
    numbers = [i for i in used if _is_number(values[i])]
    words = [i for i in used if _is_word(values[i]) and label_rank(names[i]) is not None]
    unread = [names[i] for i in used if i not in numbers + words]
    if unread and (header is None or not {*"xyzXYZ"}.isdisjoint(unread)):
        hint = f"; say what the columns are, as in {_example('label,x,y,z', width)}" * (width > 3)
        raise _not_numbers(values, first_line, hint)

    load: Any = partial(np.loadtxt, rows, delimiter=delimiter, quotechar='"', ndmin=2)
    # A delimiter at the end of a row makes an empty column, which `usecols` leaves out.
    is_part = len(numbers) < width or rows[0].rstrip().endswith(delimiter or "\n")
    try:
        table = load(usecols=numbers if is_part else None)
    except ValueError:
        _raise_fault(rows, first_line, delimiter, names, numbers)
        raise
    if count is not None:
        require_count(count, len(table), "rows")
    notes: tuple[str, ...] = ()
    if header is None:
        if width > 3 and len(table) > MIN_COUNTED and (np.diff(table[:, 0]) == 1).all():
            example = _example("-,x,y,z", width)
            raise FormatError(f"its first column counts the rows; name the columns: {example}.")
        for i, name in zip(numbers, usual_names(table, is_leica=count is not None), strict=False):
            names[i] = name
        notes = (f"no header line: columns taken as {' '.join(names)}.",)
    elif unread:
        listed = excerpt(", ".join(unread))
        notes = (f"columns passed over, as they hold no numbers: {listed}.",)
    columns = {names[i]: column for i, column in zip(numbers, table.T, strict=True)}
    if words:
        texts = np.char.strip(load(dtype=str, usecols=words)).T
        columns |= {names[i]: column for i, column in zip(words, texts, strict=True)}
    return Columns(columns, notes)


def _read_lines(path: Path) -> list[str]:
    """Read the lines of a text file in UTF-8 or, with a byte order mark, UTF-16.

    Between semicolons, commas become decimal points. Raises FormatError for a binary file, or a
    line that is too long for a row of numbers.
    """
    with path.open("rb") as file:
        head = file.read(65536)
    is_utf_16 = head.startswith((b"\xff\xfe", b"\xfe\xff"))
    if b"\0" in head and not is_utf_16:
        raise FormatError("is not a text file, though its suffix says so.")
    with path.open(encoding="utf-16" if is_utf_16 else "utf-8-sig", errors="replace") as file:
        lines = file.readlines()
    if longest := next((k for k, line in enumerate(lines, 1) if len(line) >= LONGEST_LINE), None):
        raise FormatError(f"{LONGEST_LINE} characters or more are no row of numbers.", longest)
    return [line.replace(",", ".") if ";" in line else line for line in lines]


def _column_names(header: Sequence[str] | None, width: int, line: int) -> list[str]:
    """The names of the columns of a table, whose first row, in this line, has `width` values."""
    if header is None:
        if width in USUAL_WIDTHS:
            return [*"xyz", *(f"column {i + 1}" for i in range(3, width))]
        raise FormatError(
            f"{width} column{'s' * (width != 1)} without a header line; 3 to 12 are understood, "
            f"for others say what they are, as in {_example('x,y,z', width)} (- is not used).",
            line,
        )
    if len(header) != width:
        reason = f"{width} columns, but {len(header)} names of columns"
        raise FormatError(f"{reason} ({excerpt(' '.join(header))}).", line)
    return [*map(_axis, header)]


def _example(first: str, width: int) -> str:
    """The option --columns with the names of the first of `width` columns."""
    return "--columns " + excerpt(first + ",-" * (width - first.count(",") - 1))


def read_numbers(text: bytes, number: int) -> NDArray[np.float64]:
    """Parse numbers separated by white space; `number` is that of the text's first line."""
    try:
        return np.array(text.split(), float)
    except ValueError:
        for line, row in enumerate(text.decode("latin-1").split("\n"), number):
            if not all(map(_is_number, row.split())):
                raise _not_numbers(row.split(), line) from None
        raise


def as_type(numbers: NDArray, kind: DTypeLike) -> NDArray:
    """Convert to the type that a file announces. Raises FormatError where a value doesn't fit."""
    with np.errstate(invalid="ignore"):
        converted = numbers.astype(kind, copy=False)
    if converted.dtype.kind in "iu" and (wrong := numbers[converted != numbers]).size:
        raise FormatError(f"holds {wrong[0]:g} where it announces {converted.dtype.name}.")
    return converted


def _raise_fault(
    rows: Sequence[str], line: int, delimiter: str | None, names: Sequence[str], numbers: list[int]
) -> None:
    """Raise FormatError for the first row that has not one value for each name, or no number."""
    for number, text in enumerate(rows, line):
        values = _split(text.partition("#")[0], delimiter)
        if values and len(values) != len(names):
            found = f"{len(values)} value{'s' * (len(values) != 1)} found"
            expected = f"{len(names)} expected ({excerpt(' '.join(names))})"
            raise FormatError(f"{found}, but {expected}.", number) from None
        if not all(_is_number(values[i]) for i in numbers if values):
            hint = ", but the first row has one there"
            raise _not_numbers([values[i] for i in numbers], number, hint) from None


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


def _not_numbers(values: Sequence[str], line: int, hint: str = "") -> FormatError:
    """The FormatError for the first of these values that is not a number."""
    text = next((value for value in values if not _is_number(value)), values[0])
    hint = hint * _is_word(text)
    if re.fullmatch(r"[-+]?\d+,\d+", text):
        hint = "; write decimals with a point"
    return FormatError(f"'{excerpt(text)}' is not a number{hint}.", line)


def _read_head(
    lines: Sequence[str], asked: Sequence[str]
) -> tuple[list[str] | None, str | None, int, int | None]:
    """Names of the columns, delimiter, index of the first row, and number of rows, or None each."""
    comments: list[str] = []
    header: list[str] | None = None
    count: int | None = None
    for index, text in enumerate(map(str.strip, lines)):
        if not text or text.startswith(("#", "//")):
            comments.append(text.lstrip("#/ \t"))
            continue
        delimiter = _delimiter(text)
        values = _split(text, delimiter)
        is_number = [*map(_is_number, values)]
        if len(values) == 1 and values[0].isdecimal() and count is None:
            count = int(values[0][:18])
        elif sum(is_number) >= min(3, len(values)):
            width = len(values)  # some scans of a series may have no column of labels
            header = [*asked[:width]] or header or _names_in(comments, delimiter, width)
            name, times = Counter(header).most_common(1)[0] if header else ("", 1)
            if times > 1 and not asked:
                raise FormatError(f"has a header that names two columns '{excerpt(name)}'.")
            return header, delimiter, index, count
        elif header is None and not any(is_number) and (asked or _has_xyz(values)):
            header = values
        else:
            is_header = len(values) > 2 and not any(is_number)
            hint = ", and a header has to name x, y and z (or --columns does)" * is_header
            raise _not_numbers(values, index + 1, hint)
    raise FormatError("holds no points.")


def _names_in(comments: Sequence[str], delimiter: str | None, width: int) -> list[str] | None:
    """The names of `width` columns in the last comment that has them."""
    rows = (_split(c, d) for c in reversed(comments) for d in (delimiter, None, ","))
    return next((names for names in rows if len(names) == width and _has_xyz(names)), None)


def _has_xyz(names: Sequence[str]) -> bool:
    return {"x", "y", "z"} <= {_axis(name).lower() for name in names}


def _axis(name: str) -> str:
    """Shorten "X (mm)", "x_coord" and "coordX" to the axis; other names are returned unchanged."""
    words = r"(?:coord(?:inate)?s?|pos(?:ition)?)?[ _.]?"
    axis = re.fullmatch(rf"{words}([xyz])[ _]?{words}[\[(]?(?:mm|cm|m)?[\])]?", name, re.IGNORECASE)
    return axis[1] if axis else name


def _delimiter(line: str) -> str | None:
    """The delimiter of a table with this line; None for any white space."""
    if ";" in line:
        return ";"
    cells = [cell.split() for cell in line.split("\t")]
    if len(cells) > 1 and all(cells):
        # Where spaces stand between numbers, too, tabs only align the columns.
        are_mixed = any(len(words) > 1 and _is_number(words[0]) for words in cells)
        return None if are_mixed or "," in line else "\t"
    return "," if "," in line else None


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
