"""Text tables: XYZ, TXT, CSV, ASC, PTS; three or more columns, a header line or none.

Values are separated by spaces, commas, semicolons or tabs. ``#`` begins a comment, as does ``//``
before the first row. The header names the columns in any order; it may be a comment. Without a
header the number of columns decides:

    3  x y z
    4  x y z label
    5  x y z label, the fifth is not used
    6  x y z red green blue       (normals instead of colours where one is negative)
    7  x y z red green blue label (likewise)

A single whole number before the rows (as in PTS) is the number of points; after it, without a
header, the fourth of 4 or 7 columns is the intensity that Leica's format has there.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, excerpt
from baker.scans.cloud import Columns
from baker.scans.rows import (
    Layout,
    is_number,
    not_a_number,
    numbered_lines,
    read_rows,
    split,
    text_encoding,
)


@dataclass(frozen=True)
class _Head:
    """What stands before the rows, and how they look.

    header:         the columns' names, if they are named.
    row:            the values of the first row.
    is_open_ended:  whether it ends with a delimiter.
    count:          the announced number of points, if any.
    """

    first_line: int
    delimiter: str | None
    row: Sequence[str]
    is_open_ended: bool
    header: Sequence[str] | None
    count: int | None


def read(path: Path) -> Columns:
    """All columns of numbers. InputError names the line that doesn't fit."""
    encoding = text_encoding(path)
    head = _read_head(path, encoding)
    width = len(head.row)
    if head.header is None and not 3 <= width <= 7:
        raise InputError(
            f"'{path}', line {head.first_line}: {width} column{'s' * (width != 1)} without a "
            "header line; 3 to 7 are understood, for others name the columns in a header line."
        )
    numeric = tuple(i for i, value in enumerate(head.row) if is_number(value))
    names = head.header or [f"column {i + 1}" for i in range(width)]
    columns = None if len(numeric) == width and not head.is_open_ended else numeric
    rows = read_rows(
        path, Layout(head.first_line, names, head.delimiter, columns), encoding=encoding
    )
    if head.count is not None and head.count != len(rows):
        raise InputError(
            f"'{path}' announces {head.count} points, but {len(rows)} rows follow: "
            "it is cut short, or the number is wrong."
        )

    notes: tuple[str, ...] = ()
    if head.header is None:
        if len(numeric) < width:
            position = next(i for i in range(width) if i not in numeric)
            fault = not_a_number(head.row[position])
            raise InputError(f"'{path}', line {head.first_line}: {fault}")
        names = _usual_names(rows, is_leica=head.count is not None)
        notes = (f"no header line: columns taken as {' '.join(names)}.",)
    elif words := [names[i] for i in range(width) if i not in numeric]:
        notes = (f"columns passed over, as they hold no numbers: {excerpt(', '.join(words))}.",)
    return Columns({names[i]: rows[:, k] for k, i in enumerate(numeric)}, notes)


def _read_head(path: Path, encoding: str) -> _Head:
    comments: list[str] = []
    header_line, header, count = 0, "", None
    for number, line in numbered_lines(path, encoding):
        text = line.strip()
        if not text:
            continue
        if text.startswith(("#", "//")):
            comments.append(text.lstrip("#/ \t"))
            continue
        delimiter = _delimiter(text)
        values = split(text, delimiter)
        if len(values) == 1 and values[0].isdecimal() and count is None:
            count = int(values[0][:18])
            continue
        if sum(map(is_number, values)) >= min(3, len(values)):
            names = _header(path, header_line, header, comments, delimiter, len(values))
            is_open_ended = delimiter is not None and text.endswith(delimiter)
            return _Head(number, delimiter, values, is_open_ended, names, count)
        numbers = [value for value in values if is_number(value)]
        if header or numbers or not _names_xyz(values):
            fault = next(value for value in values if not is_number(value))
            raise InputError(f"'{path}', line {number}: {not_a_number(fault)}")
        header_line, header = number, text
    raise InputError(f"'{path}' holds no points.")


def _header(
    path: Path,
    line: int,
    header: str,
    comments: Sequence[str],
    delimiter: str | None,
    width: int,
) -> list[str] | None:
    """The names of the columns: from the header line, else from the last comment that fits."""
    if header:
        names = split(header, delimiter or _delimiter(header))
        if len(names) != width:
            raise InputError(
                f"'{path}', line {line}: the header names {len(names)} columns, "
                f"but the first row has {width} values."
            )
        return _require_distinct(path, names)
    for comment in reversed(comments):
        for names in (split(comment, delimiter), split(comment, None), split(comment, ",")):
            if len(names) == width and _names_xyz(names):
                return _require_distinct(path, names)
    return None


def _require_distinct(path: Path, names: Sequence[str]) -> list[str]:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise InputError(f"'{path}': its header names two columns '{excerpt(name)}'.")
        seen.add(name)
    return list(names)


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


def _usual_names(rows: NDArray[np.float64], is_leica: bool) -> list[str]:
    """Names for 3 to 7 columns without a header; see the module's text."""
    width = rows.shape[1]
    start = 4 if is_leica and width == 7 else 3
    triple = ["red", "green", "blue"]
    if width >= 6 and (rows[:, start : start + 3] < 0).any():
        triple = ["nx", "ny", "nz"]
    names = {
        3: [],
        4: ["intensity"] if is_leica else ["label"],
        5: ["label", "column 5"],
        6: triple,
        7: ["intensity", *triple] if is_leica else [*triple, "label"],
    }
    return ["x", "y", "z", *names[width]]
