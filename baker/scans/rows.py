"""Rows of numbers in a text file, with faults told by their line."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, excerpt

LONGEST_LINE = 1 << 17


@dataclass(frozen=True)
class Layout:
    """How the rows stand in the file.

    first_line:  number of the line (from 1) where the rows begin.
    names:       one for each value of a row.
    delimiter:   what stands between values; None is any white space.
    columns:     which values to read, where not all are numbers.
    comment:     the character that begins a comment, if any.
    """

    first_line: int
    names: Sequence[str]
    delimiter: str | None = None
    columns: tuple[int, ...] | None = None
    comment: str | None = "#"


def numbered_lines(path: Path, encoding: str) -> Iterator[tuple[int, str]]:
    """The lines of a text, from 1; InputError at one too long to be a row of numbers."""
    with path.open(encoding=encoding, errors="replace") as file:
        number = 1
        while line := file.readline(LONGEST_LINE):
            if len(line) == LONGEST_LINE:
                raise InputError(
                    f"'{path}', line {number}: {LONGEST_LINE} characters or more are no row of "
                    "numbers."
                )
            yield number, line
            number += 1


def text_encoding(path: Path) -> str:
    """UTF-8 or, by its byte order mark, UTF-16. InputError if `path` is no text."""
    with path.open("rb") as file:
        head = file.read(65536)
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    if b"\0" in head:
        raise InputError(f"'{path}' is not a text file, though its suffix says so.")
    return "utf-8-sig"


def split(line: str, delimiter: str | None) -> list[str]:
    """The values of a line, without quotes; empty ones at its end don't count."""
    values = [value.strip().strip("\"'") for value in line.strip().split(delimiter)]
    while values and not values[-1]:
        values.pop()
    return values


def is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text  # which only Python itself takes as a part of numbers


def read_rows(
    path: Path, layout: Layout, count: int | None = None, encoding: str = "utf-8-sig"
) -> NDArray[np.float64]:
    """The numbers of the rows, (N, C) float64, C the number of `layout.columns` (else of names).

    count: read that many rows only. InputError names the first line that doesn't fit.
    """
    with path.open(encoding=encoding, errors="replace") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # numpy warns where there are no rows
        for _ in islice(file, layout.first_line - 1):
            pass
        try:
            rows = np.loadtxt(
                file,
                delimiter=layout.delimiter,
                comments=layout.comment,
                quotechar='"',
                usecols=layout.columns,
                max_rows=count,
                ndmin=2,
            )
        except ValueError as error:
            raise _first_fault(path, layout, encoding, error) from error
    width = len(layout.columns or layout.names)
    if rows.size and rows.shape[1] != width:
        raise _first_fault(path, layout, encoding, None)
    return rows.reshape(-1, width)


def _first_fault(path: Path, layout: Layout, encoding: str, error: ValueError | None) -> InputError:
    wanted = layout.columns or tuple(range(len(layout.names)))
    for number, line in numbered_lines(path, encoding):
        text = line.split(layout.comment)[0] if layout.comment else line
        if number < layout.first_line or not text.strip():
            continue
        values = split(text, layout.delimiter)
        where = f"'{path}', line {number}"
        if len(values) <= max(wanted) or (
            layout.columns is None and len(values) != len(layout.names)
        ):
            return InputError(
                f"{where}: {len(values)} value{'s' * (len(values) != 1)} found, but "
                f"{len(layout.names)} expected ({excerpt(' '.join(layout.names))})."
            )
        for column in wanted:
            if not is_number(values[column]):
                return InputError(f"{where}: {not_a_number(values[column])}")
    return InputError(f"'{path}' can't be read as rows of numbers ({error}).")


def not_a_number(text: str) -> str:
    hint = "; write decimals with a point" if re.fullmatch(r"[-+]?\d+,\d+", text) else ""
    return f"'{excerpt(text)}' is not a number{hint}."


def as_type(kind: np.dtype, values: NDArray[np.float64]) -> NDArray:
    """`values` in the type a header gives them, where they fit it."""
    with np.errstate(invalid="ignore", over="ignore"):
        typed = values.astype(kind)
    return typed if kind.kind == "f" or (typed == values).all() else values


def require_room(path: Path, count: int, size: float, room: int, is_all: bool = False) -> None:
    """InputError unless `room` bytes can hold `count` points of at least `size` bytes each.

    is_all: `size` is exact and nothing else may follow, so that there must be no room for more.
    To be called before memory is made for as many points as a header says.
    """
    if is_all and room >= (count + 1) * size:
        raise InputError(
            f"'{path}' holds more than its header announces: {count} points of {size:g} bytes, "
            f"but {room} bytes follow."
        )
    if count * size > room:
        raise InputError(
            f"'{path}' is cut short, or its header is wrong: it announces {count} points "
            f"(at least {math.ceil(count * size)} bytes), but {max(room, 0)} bytes follow."
        )
