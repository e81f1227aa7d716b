"""Write tables of traits of one plant, or of many with rows kept from an earlier table."""

from __future__ import annotations

import csv
import io
import zlib
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from itertools import chain, groupby
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING

from gclip.errors import UserError
from gclip.terminal.atomic import atomic_file
from traits.table import COLUMNS, NamedPlant, measure_days, write_table

if TYPE_CHECKING:
    from gclip.clip import Clip


def write_traits(
    path: Path, clip: Clip, plant: str, progress: Callable[[str, int, int], None]
) -> None:
    """Measure one plant at the scans and half-way between, and write the table.

    Parameters
    ----------
    path : Path
    clip : gclip.Clip
    plant : str
        Its name in the table.
    progress : callable
        Called with the name of the stage, the number of days measured and their total.

    Raises
    ------
    UserError
        If the file can't be written.
    """
    table = io.StringIO()
    write_table(table, NamedPlant(clip, plant), measure_days(clip), partial(progress, "measuring"))
    _write(path, [table.getvalue().encode()])


class TraitsTable:
    """A table of many plants, which keeps rows of an existing table for clips that are unchanged.

    Raises UserError if the existing table can't be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._sources: dict[str, tuple[str, str]] = {}
        self._rows: dict[str, bytes] = {}  # compressed, since there may be thousands of plants
        if not path.is_file():
            return
        try:
            with path.open(newline="", encoding="utf-8") as file:
                for name, source, rows in _plants(file):
                    self.add(name, rows)
                    self._sources[name] = source
        except OSError as error:
            raise UserError(f"{path} can't be read: {error.strerror or error}.") from None
        except (UnicodeDecodeError, csv.Error):
            pass  # the rest was not written by this program

    def source_of(self, plant: str) -> tuple[str, str] | None:
        """The `traits.table.provenance` of a plant's rows in the existing table, or None."""
        return self._sources.get(plant)

    def add(self, plant: str, rows: str) -> None:
        """Set the rows of a plant, CSV without a header; "" keeps the existing ones."""
        if rows:
            self._rows[plant] = zlib.compress(rows.encode())

    def save(self, plants: Iterable[str]) -> None:
        """Write the rows of these plants, in this order, atomically."""
        rows = (zlib.decompress(self._rows[plant]) for plant in plants if plant in self._rows)
        _write(self.path, chain([f"{','.join(COLUMNS)}\n".encode()], rows))


def _write(path: Path, chunks: Iterable[bytes]) -> None:
    """Write a file atomically."""
    with atomic_file(path) as part, part.open("wb") as file:
        file.writelines(chunks)


def _plants(file: Iterable[str]) -> Iterator[tuple[str, tuple[str, str], str]]:
    """Yield the name, provenance and rows of each plant of a table that this program wrote."""
    reader = csv.reader(file)
    if tuple(next(reader, ())) != COLUMNS:
        return
    for name, group in groupby(reader, itemgetter(0)):
        rows = list(group)
        if {(len(row), *row[-2:]) for row in rows} != {(len(COLUMNS), *rows[0][-2:])}:
            raise csv.Error("rows of several clips")
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(rows)
        yield name, (rows[0][-2], rows[0][-1]), text.getvalue()
