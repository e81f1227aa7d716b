"""Text tables: XYZ, TXT, CSV, ASC, PTS; three or more columns, a header line or none.

Values are separated by spaces, commas, semicolons or tabs. ``#`` begins a comment, as does ``//``
before the first row. The header names the columns in any order; it may be a comment. Without a
header the number of columns decides:

    3  x y z
    4  x y z, labels
    5  x y z, labels, or these in the fifth
    6  x y z red green blue         (normals instead of colours where one is negative)
    7  x y z red green blue, labels (likewise)

Labels may be words. A single whole number before the rows (as in PTS) is the number of points;
after it, without a header, the fourth of 4 or 7 columns is the intensity of Leica's format.
"""

from __future__ import annotations

import re
import warnings
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
from baker.scans.formats.faults import FormatError, require_count
from baker.scans.labels import label_rank

LONGEST_LINE = 1 << 17
SKIPPED = ("-", "_")  # for columns that are not used
USUAL_WIDTHS = range(3, 8)  # of rows whose columns need no names


class Lines:
    """The lines of an open text; `number` is that of the last one, from 1."""

    def __init__(self, file: TextIO, number: int = 0) -> None:
        self._file, self.number = file, number

    def __iter__(self) -> Iterator[str]:
        while line := self._file.readline(LONGEST_LINE):
            self.number += 1
            if len(line) == LONGEST_LINE:
                reason = f"{LONGEST_LINE} characters or more are no row of numbers."
                raise FormatError(reason, self.number)
            yield line


def read(path: Path, asked: Sequence[str] = ()) -> Columns:
    """All columns of numbers, and of words where they may be labels.

    `asked` names the columns, whatever a header says, those to skip "-" or "_". Raises FormatError,
    with the line that doesn't fit.
    """
    with path.open(encoding=_encoding(path), errors="replace") as file:
        lines = Lines(file)
        header, delimiter, first, count = _read_head(lines, bool(asked))
        values = _split(first, delimiter)
        width = len(values)
        if len(asked or values) != width:
            reason = f"{width} columns, but --columns names {len(asked)}"
            raise FormatError(f"{reason} ({excerpt(','.join(asked))}).", lines.number)
        named = [*asked] or header
        if named is None and width not in USUAL_WIDTHS:
            example = ",".join(["x", "y", "z", *["-"] * (width - 4), "label"])
            raise FormatError(
                f"{width} column{'s' * (width != 1)} without a header line; 3 to 7 are understood, "
                f"for others say what they are, as in --columns {example} (- is not used).",
                lines.number,
            )
        names = named or [*"xyz", *(f"column {i + 1}" for i in range(3, width))]
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
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # numpy warns where there are no rows
        try:
            rows = np.loadtxt(
                chain([first], lines),
                delimiter=delimiter,
                quotechar='"',
                usecols=columns,
                ndmin=2,
                converters={i: partial(_number_of, known) for i, known in (words or {}).items()},
            )
        except ValueError as error:  # at the line that numpy has asked for last
            raise _row_fault(str(error), names, lines.number) from error
    width = len(names if columns is None else columns)
    if rows.size and rows.shape[1] != width:
        raise _row_fault(f"{rows.shape[1]} columns", names, lines.number)
    return rows.reshape(-1, width)


def _number_of(known: dict[str, int], word: str) -> int:
    return known.setdefault(word.strip(), len(known))


def usual_names(rows: NDArray, is_leica: bool = False) -> list[str]:
    """Names for 3 to 7 columns without a header; see the module's text."""
    width = rows.shape[1]
    start = 4 if is_leica and width == 7 else 3
    are_normals = width >= 6 and (rows[:, start : start + 3] < 0).any()
    triple = ["nx", "ny", "nz"] if are_normals else ["red", "green", "blue"]
    others = {4: ["column 4"], 5: ["column 4", "column 5"], 6: triple, 7: [*triple, "column 7"]}
    if is_leica:
        others |= {4: ["intensity"], 7: ["intensity", *triple]}
    return ["x", "y", "z", *others.get(width, [])]


def _row_fault(numpys: str, names: Sequence[str], line: int) -> FormatError:
    """Numpy's sentence about a row in the words of one who has the file before them."""
    if text := re.search("could not convert string '(.*)' to float64", numpys, re.DOTALL):
        return _not_numbers([text[1]], line)
    if found := re.search(r"from \d+ to (\d+)|with (\d+) columns|^(\d+) columns", numpys):
        count = int(next(filter(None, found.groups())))
        return FormatError(
            f"{count} value{'s' * (count != 1)} found, but {len(names)} expected "
            f"({excerpt(' '.join(names))}).",
            line,
        )
    return FormatError(f"no row of numbers ({excerpt(numpys)}).", line)


def _not_numbers(values: Sequence[str], line: int) -> FormatError:
    """The fault of the first of these values that is no number."""
    text = next((value for value in values if not _is_number(value)), values[0])
    hint = "; write decimals with a point" if re.fullmatch(r"[-+]?\d+,\d+", text) else ""
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
    lines: Lines, are_named: bool
) -> tuple[list[str] | None, str | None, str, int | None]:
    """Names of the columns, delimiter, first row and announced count; None where not told.

    are_named: the columns have names already, whatever a header says.
    """
    comments: list[str] = []
    header: list[str] | None = None
    count: int | None = None
    header_line = 0
    for line in lines:
        text = line.strip()
        if text.startswith(("#", "//")):
            comments.append(text.lstrip("#/ \t"))
        if not text or text.startswith(("#", "//")):
            continue
        delimiter = _delimiter(text)
        values = _split(text, delimiter)
        if len(values) == 1 and values[0].isdecimal() and count is None:
            count = int(values[0][:18])
        elif sum(map(_is_number, values)) >= min(3, len(values)):
            header = header or _names_in(comments, delimiter, len(values))
            if header and len(header) != len(values) and not are_named:
                raise FormatError(
                    f"the header names {len(header)} columns, but the first row has "
                    f"{len(values)} values.",
                    header_line,
                )
            name, times = Counter(header).most_common(1)[0] if header else ("", 1)
            if times > 1:
                raise FormatError(f"has a header that names two columns '{excerpt(name)}'.")
            return header, delimiter, line, count
        elif (
            header is None
            and (are_named or _names_xyz(values))
            and not any(map(_is_number, values))
        ):
            header, header_line = values, lines.number
        else:
            raise _not_numbers(values, lines.number)
    raise FormatError("holds no points.")


def _names_in(comments: Sequence[str], delimiter: str | None, width: int) -> list[str] | None:
    """The names of so many columns, from the last comment that fits."""
    tries = (_split(c, d) for c in reversed(comments) for d in (delimiter, None, ","))
    return next((names for names in tries if len(names) == width and _names_xyz(names)), None)


def _names_xyz(names: Sequence[str]) -> bool:
    return {"x", "y", "z"} <= {name.lower() for name in names}


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
