"""Tables of traits as files: of one plant, or of many, whose unchanged rows are kept."""

from __future__ import annotations

import csv
import io
import sqlite3
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from itertools import chain, groupby
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING

from gclip.errors import UserError
from gclip.terminal.atomic import atomic_file
from traits.table import COLUMNS, Namer, measure_days, write_table

if TYPE_CHECKING:
    from gclip.clip import Clip


def write_traits(
    path: Path, clip: Clip, plant: str, progress: Callable[[str, int, int], None]
) -> None:
    """Measure one plant at the scans and half-way between, and write the table.

    plant: what the table calls it. Raises UserError where the file can't be written.
    """
    table = io.StringIO()
    write_table(table, Namer(clip, plant), measure_days(clip), partial(progress, "measuring"))
    _write(path, [table.getvalue()])


class TraitsTable:
    """One table of many plants, in the making; `close` drops what was not saved.

    Rows of plants whose clips are up to date are taken from the table that was there before. Rows
    wait in a temporary data base on the disk: memory stays small however many plants there are.
    UserError where nothing can be written beside `path`, or it can't be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._rows = sqlite3.connect("")  # a temporary file, gone when it is closed
        self._rows.execute("CREATE TABLE plants (name PRIMARY KEY, program, digest, rows)")
        try:
            if path.is_file():
                with path.open(newline="", encoding="utf-8") as file:
                    self._rows.executemany("INSERT INTO plants VALUES (?, ?, ?, ?)", _plants(file))
        except OSError as error:
            raise UserError(f"{path} can't be read: {error.strerror or error}.") from None
        except (UnicodeDecodeError, csv.Error, sqlite3.IntegrityError):
            self._rows.execute("DELETE FROM plants")  # no table that we wrote

    def close(self) -> None:
        self._rows.close()

    def known(self, plant: str) -> tuple[str, str] | None:
        """Of which clip the table has this plant's rows; see `traits.table.provenance`."""
        return self._rows.execute(
            "SELECT program, digest FROM plants WHERE name = ?", (plant,)
        ).fetchone()

    def add(self, plant: str, rows: str) -> None:
        """Take a plant's rows, CSV without a header; nothing where those known are right."""
        if rows:
            self._rows.execute("INSERT OR REPLACE INTO plants VALUES (?, '', '', ?)", (plant, rows))

    def save(self, plants: Iterable[str]) -> None:
        """Write the rows of these plants in their order; whole or not at all."""
        query = "SELECT rows FROM plants WHERE name = ?"
        found = (row for plant in plants for (row,) in self._rows.execute(query, (plant,)))
        _write(self.path, chain([",".join(COLUMNS) + "\n"], found))


def _write(path: Path, chunks: Iterable[str]) -> None:
    try:
        with atomic_file(path) as part, part.open("wb") as file:
            file.writelines(chunk.encode() for chunk in chunks)
    except OSError as error:
        raise UserError(f"{path} can't be written: {error.strerror or error}.") from None


def _plants(file: Iterable[str]) -> Iterator[tuple[str, str, str, str]]:
    """Each plant of a table that we wrote: its name, program and digest, and its rows."""
    reader = csv.reader(file)
    if tuple(next(reader, ())) != COLUMNS:
        return
    for name, rows in groupby(reader, itemgetter(0)):
        own = list(rows)
        if {(len(row), *row[-2:]) for row in own} != {(len(COLUMNS), *own[0][-2:])}:
            raise csv.Error("rows of several clips")
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(own)
        yield name, own[0][-2], own[0][-1], text.getvalue()
