"""Tables of traits as files: of one plant, or of many, whose unchanged rows are kept."""

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
from gclip.terminal.atomic import atomic_file, writing
from traits.table import COLUMNS, Namer, measure_days, write_table

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
        What the table calls it.
    progress : callable
        Called with "traits", the days measured and the days in all.

    Raises
    ------
    UserError
        Where the file can't be written.
    """
    table = io.StringIO()
    write_table(table, Namer(clip, plant), measure_days(clip), partial(progress, "measuring"))
    _write(path, [table.getvalue().encode()])


class TraitsTable:
    """One table of many plants, in the making.

    Rows of plants whose clips are up to date are taken from the table that was there before.
    UserError where that can't be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._sources: dict[str, tuple[str, str]] = {}
        self._rows: dict[str, bytes] = {}  # compressed, as there may be thousands of plants
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
            pass  # no table that we wrote, from here on

    def known(self, plant: str) -> tuple[str, str] | None:
        """Of which clip the table has this plant's rows; see `traits.table.provenance`."""
        return self._sources.get(plant)

    def add(self, plant: str, rows: str) -> None:
        """Take a plant's rows, CSV without a header; nothing where those known are right."""
        if rows:
            self._rows[plant] = zlib.compress(rows.encode())

    def save(self, plants: Iterable[str]) -> None:
        """Write the rows of these plants in their order; whole or not at all."""
        rows = (zlib.decompress(self._rows[plant]) for plant in plants if plant in self._rows)
        _write(self.path, chain([f"{','.join(COLUMNS)}\n".encode()], rows))


def _write(path: Path, chunks: Iterable[bytes]) -> None:
    with writing(path), atomic_file(path) as part, part.open("wb") as file:
        file.writelines(chunks)


def _plants(file: Iterable[str]) -> Iterator[tuple[str, tuple[str, str], str]]:
    """Each plant of a table that we wrote: its name, what its rows are of, and these."""
    reader = csv.reader(file)
    if tuple(next(reader, ())) != COLUMNS:
        return
    for name, rows in groupby(reader, itemgetter(0)):
        own = list(rows)
        if {(len(row), *row[-2:]) for row in own} != {(len(COLUMNS), *own[0][-2:])}:
            raise csv.Error("rows of several clips")
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(own)
        yield name, (own[0][-2], own[0][-1]), text.getvalue()
