"""`--traits FILE.csv` of many plants: one long table, in the plants' order.

Rows of plants whose clips stand are taken from the table that was there before. As they come, new
rows go to a file without a name, so that memory stays small however many plants there are.
"""

from __future__ import annotations

import csv
import os
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from baker.batch.work import About
from baker.errors import InputError
from traits.table import COLUMNS

CHUNK = 1 << 20


@dataclass(frozen=True)
class _Rows:
    """Where a plant's rows stand in a file: bytes from `first` to `last`; whose they are."""

    first: int
    last: int
    about: About


class TraitsTable:
    """The table in the making; a context that drops what was not saved."""

    def __init__(self, path: Path) -> None:
        """Raises InputError where nothing can be written beside `path`, or it can't be read."""
        self.path = path
        try:
            old = path if path.is_file() else Path(os.devnull)
            self._new: IO[bytes] = tempfile.TemporaryFile(dir=path.parent)  # noqa: SIM115
            self._old: IO[bytes] = old.open("rb")
        except OSError as error:
            raise InputError(f"{path} can't be written: {error.strerror or error}.") from None
        self._known = _index(self._old)
        self._added: dict[str, tuple[int, int]] = {}

    def close(self) -> None:
        self._new.close()
        self._old.close()

    def known(self, plant: str) -> About | None:
        """Of which clip the table has this plant's rows already."""
        rows = self._known.get(plant)
        return None if rows is None else rows.about

    def add(self, plant: str, rows: str) -> None:
        """The rows of one plant, in CSV without a header; "" where those known are right."""
        if rows:
            first = self._new.tell()
            self._new.write(rows.encode())
            self._added[plant] = first, self._new.tell()

    def save(self, plants: Iterable[str]) -> None:
        """Write the rows of these plants in their order; whole or not at all."""
        from baker.report.page import write_chunks

        write_chunks(self.path, self._chunks(plants))

    def _chunks(self, plants: Iterable[str]) -> Iterator[bytes]:
        yield _HEADER
        for plant in plants:
            if plant in self._added:
                yield from _between(self._new, *self._added[plant])
            elif plant in self._known:
                rows = self._known[plant]
                yield from _between(self._old, rows.first, rows.last)


_HEADER = (",".join(COLUMNS) + "\n").encode()


def _between(file: IO[bytes], first: int, last: int) -> Iterator[bytes]:
    file.seek(first)
    while first < last:
        chunk = file.read(min(CHUNK, last - first))
        first += len(chunk)
        yield chunk


def _index(file: IO[bytes]) -> dict[str, _Rows]:
    """Where each plant's rows stand in a table that we wrote; nothing of any other file."""
    found: dict[str, _Rows] = {}
    try:
        if file.readline() != _HEADER:
            return {}
        at = file.tell()
        for row, end in _rows_and_ends(file, at):
            if len(row) != len(COLUMNS):
                return {}
            name, about = row[0], (row[-2], row[-1])
            before = found.get(name)
            if before is None:
                found[name] = _Rows(at, end, about)
            elif before.last == at and before.about == about:
                found[name] = _Rows(before.first, end, about)
            else:
                return {}  # rows apart or of several clips: not as we write them
            at = end
    except (UnicodeDecodeError, csv.Error):
        return {}
    return found


def _rows_and_ends(file: IO[bytes], at: int) -> Iterator[tuple[Sequence[str], int]]:
    """Each row with the byte after it: a quoted cell may hold line ends."""

    def lines() -> Iterator[str]:
        nonlocal at
        for line in file:
            at += len(line)
            yield line.decode()

    for row in csv.reader(lines()):
        yield row, at
