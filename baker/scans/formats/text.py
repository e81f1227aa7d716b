"""Text tables: XYZ, TXT, CSV, ASC, PTS; docs/scans.md says how columns are found and named."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from baker.errors import excerpt
from baker.scans.cloud import Columns
from baker.scans.formats import FormatError, require_count
from baker.scans.labels import label_rank

LONGEST_LINE = 1 << 17
SKIPPED = ("-", "_")  # for columns that are not used
MIN_COUNTED = 9  # rows, of which a column may seem to be the count by chance
USUAL_WIDTHS = range(3, 8)  # of rows whose columns need no names


class Lines:
    """The lines of an open text; `text` is the last one and `number` its own, from 1."""

    def __init__(self, file: TextIO, number: int = 0) -> None:
        self._file, self.number, self.text = file, number, ""

    def __iter__(self) -> Iterator[str]:
        while line := self._file.readline(LONGEST_LINE):
            self.number, self.text = self.number + 1, line
            if len(line) == LONGEST_LINE:
                reason = f"{LONGEST_LINE} characters or more are no row of numbers."
                raise FormatError(reason, self.number)
            yield line


def read(path: Path, asked: Sequence[str] = ()) -> Columns:
    """All columns of numbers, and of words where they may be labels.

    `asked` names the columns, whatever a header says, those to skip "-" or "_"; a file may have
    fewer. Raises FormatError, with the line that doesn't fit.
    """
    with path.open(encoding=_encoding(path), errors="replace") as file:
        lines = Lines(file)
        named, delimiter, first, count = _read_head(lines, asked)
        values = _split(first, delimiter)
        width = len(values)
        usual = [*"xyz", *(f"column {i + 1}" for i in range(3, width))]
        names = [*map(_axis, named)] if named else usual
        if asked and width >= 3:
            names = names[:width]  # of scans of a series some may have no labels
        if named is None and width not in USUAL_WIDTHS:
            example = ",".join(["x", "y", "z", *["-"] * (width - 4), "label"])
            raise FormatError(
                f"{width} column{'s' * (width != 1)} without a header line; 3 to 7 are understood, "
                f"for others say what they are, as in --columns {example} (- is not used).",
                lines.number,
            )
        if len(names) != width:
            reason = f"{width} columns, but {len(names)} names of columns"
            raise FormatError(f"{reason} ({excerpt(' '.join(names))}).", lines.number)
        wanted = [i for i in range(width) if names[i] not in SKIPPED]
        words = [i for i in wanted if _is_word(values[i]) and label_rank(names[i]) is not None]
        chosen = [i for i in wanted if i in words or _is_number(values[i])]
        unread = [names[i] for i in wanted if i not in chosen]
        if unread and (named is None or set(unread) & {*"xyzXYZ"}):
            raise _not_numbers(values, lines.number)
        is_open_ended = delimiter is not None and first.rstrip().endswith(delimiter)
        columns = chosen if is_open_ended or len(chosen) < width else None
        known: dict[int, dict[str, int]] = {i: {} for i in words}
        rows = read_rows(lines, names, first, delimiter, columns, known)
    if count is not None:
        require_count(count, len(rows), "rows")
    notes = [f"columns passed over, as they hold no numbers: {excerpt(', '.join(unread))}."]
    if named is None:
        if width > 3 and len(rows) > MIN_COUNTED and (np.diff(rows[:, 0]) == 1).all():
            example = ",".join(["-", *"xyz", *["label"] * (width - 4)][:5])
            reason = f"its first column counts the rows; say it with --columns {example}."
            raise FormatError(reason)
        usual = usual_names(rows, is_leica=count is not None)
        names = [names[i] if i in words else usual[i] for i in range(width)]
        notes = [f"no header line: columns taken as {' '.join(names)}."]
    found = {names[i]: rows[:, k] for k, i in enumerate(chosen)}
    found |= {names[i]: np.array([*known[i]])[found[names[i]].astype(int)] for i in words}
    return Columns(found, tuple(notes if unread or named is None else ()))


def read_rows(
    lines: Lines,
    names: Sequence[str],
    first: str = "",
    delimiter: str | None = None,
    columns: Sequence[int] | None = None,
    words: Mapping[int, dict[str, int]] | None = None,
) -> NDArray[np.float64]:
    """The numbers of all rows that follow `first`, one that was read already.

    `names` has one for each value of a row, `columns` those to read, where not all are wanted. Of
    columns of `words` each word has a number; new ones get the next. Raises FormatError, with its
    line, where a row has other values.
    """
    try:
        rows = np.loadtxt(
            chain([first], lines),
            delimiter=delimiter,
            quotechar='"',
            usecols=columns,
            ndmin=2,
            converters={i: partial(_numbered, known) for i, known in (words or {}).items()},
        )
    except ValueError as error:  # at the line that numpy has asked for last
        values = _split(lines.text.partition("#")[0], delimiter)
        if len(values) == len(names):
            read = [i for i in columns or range(len(names)) if i not in (words or {})]
            hint = ", but the first row has one there"
            raise _not_numbers([values[i] for i in read], lines.number, hint) from error
        raise _count_fault(len(values), names, lines.number) from error
    width = len(names if columns is None else columns)
    if rows.size and rows.shape[1] != width:
        raise _count_fault(rows.shape[1], names, lines.number)
    return rows.reshape(-1, width)


def _numbered(known: dict[str, int], word: str) -> int:
    return known.setdefault(word.strip(), len(known))


def usual_names(rows: NDArray, is_leica: bool = False) -> list[str]:
    """Names for 3 to 7 columns without a header, as docs/scans.md tells."""
    start = 4 if is_leica and rows.shape[1] == 7 else 3
    is_normal = (rows[:, start : start + 3] < 0).any()
    triple = ["nx", "ny", "nz"] if is_normal else ["red", "green", "blue"]
    others = {4: ["column 4"], 5: ["column 4", "column 5"], 6: triple, 7: [*triple, "column 7"]}
    if is_leica:
        others |= {4: ["intensity"], 7: ["intensity", *triple]}
    return ["x", "y", "z", *others.get(rows.shape[1], [])]


def _count_fault(count: int, names: Sequence[str], line: int) -> FormatError:
    found = f"{count} value{'s' * (count != 1)} found, but {len(names)} expected"
    return FormatError(f"{found} ({excerpt(' '.join(names))}).", line)


def _not_numbers(values: Sequence[str], line: int, hint: str = "") -> FormatError:
    """The fault of the first of these values that is no number."""
    text = next((value for value in values if not _is_number(value)), values[0])
    hint = hint * _is_word(text)
    if re.fullmatch(r"[-+]?\d+,\d+", text):
        hint = "; write decimals with a point"
    return FormatError(f"'{excerpt(text)}' is not a number{hint}.", line)


def _encoding(path: Path) -> str:
    """UTF-8 or, by its byte order mark, UTF-16. FormatError if `path` is no text."""
    with path.open("rb") as file:
        head = file.read(65536)
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    if b"\0" in head:
        raise FormatError("is not a text file, though its suffix says so.")
    return "utf-8-sig"


def _read_head(
    lines: Lines, asked: Sequence[str]
) -> tuple[list[str] | None, str | None, str, int | None]:
    """Names of the columns, delimiter, first row and announced count; None where not told."""
    comments: list[str] = []
    names: list[str] | None = None
    count: int | None = None
    for line in lines:
        text = line.strip()
        if text.startswith(("#", "//")):
            comments.append(text.lstrip("#/ \t"))
        if not text or text.startswith(("#", "//")):
            continue
        delimiter = _delimiter(text)
        values = _split(text, delimiter)
        is_number = [*map(_is_number, values)]
        if len(values) == 1 and values[0].isdecimal() and count is None:
            count = int(values[0][:18])
        elif sum(is_number) >= min(3, len(values)):
            names = names or _names_in(comments, delimiter, len(values))
            name, times = Counter(names).most_common(1)[0] if names else ("", 1)
            if times > 1 and not asked:
                raise FormatError(f"has a header that names two columns '{excerpt(name)}'.")
            return [*asked] or names, delimiter, line, count
        elif names is None and (asked or _names_xyz(values)) and not any(is_number):
            names = values
        else:
            is_header = len(values) > 2 and not any(is_number)
            hint = ", and a header has to name x, y and z (or --columns does)" * is_header
            raise _not_numbers(values, lines.number, hint)
    raise FormatError("holds no points.")


def _names_in(comments: Sequence[str], delimiter: str | None, width: int) -> list[str] | None:
    """The names of so many columns, from the last comment that fits."""
    tries = (_split(c, d) for c in reversed(comments) for d in (delimiter, None, ","))
    return next((names for names in tries if len(names) == width and _names_xyz(names)), None)


def _names_xyz(names: Sequence[str]) -> bool:
    return {"x", "y", "z"} <= {_axis(name).lower() for name in names}


def _axis(name: str) -> str:
    """The x of "X (mm)", "x_coord" and "coordX"; other names as they are."""
    words = r"(?:coord(?:inate)?s?|pos(?:ition)?)?[ _.]?"
    axis = re.fullmatch(rf"{words}([xyz])[ _]?{words}[\[(]?(?:mm|cm|m)?[\])]?", name, re.IGNORECASE)
    return axis[1] if axis else name


def _delimiter(line: str) -> str | None:
    if ";" in line:
        return ";"
    if "\t" in line and all(re.search(r"\S", value) for value in line.split("\t")):
        # Tabs among other white space (aligned columns) are white space like any other.
        has_spaces = any(" " in value.strip() for value in line.split("\t"))
        return None if has_spaces or "," in line else "\t"
    return "," if "," in line else None


def _split(line: str, delimiter: str | None) -> list[str]:
    """The values of a line, without quotes; empty ones at its end don't count."""
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
    return "_" not in text  # which only Python itself takes as a part of numbers
