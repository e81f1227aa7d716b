"""Traits as a table in long format, one value a row (RFC 4180 CSV)."""

from __future__ import annotations

import csv
import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property, partial
from io import StringIO
from itertools import pairwise
from os import cpu_count
from typing import TYPE_CHECKING, TextIO
from unicodedata import normalize

from gclip.errors import UserError
from gclip.text import printable
from gclip.version import __version__
from traits.dates import date_at
from traits.doubts import Doubt, doubts_of
from traits.fields import field_means
from traits.traits import Measurement, measure

if TYPE_CHECKING:
    import pandas

    from gclip import Clip

TRAITS = {"height": 1, "length": 1, "area": 2, "hull": 3}  # power of the length unit
NAMES = {"hull": "hull_volume"}
COLUMNS = (
    *("plant", "level", "track", "organ", "kind", "parent", "born", "lost"),
    *("trait", "value", "unit", "state", "time", "date", "start", "end", "elapsed", "time_unit"),
    *("points", "sure", "method", "clip_digest"),
)
DIGITS = 7  # that a float32 clip has to tell


def data_frame(
    clip: Clip, days: Sequence[float] | None = None, plant: str = "plant"
) -> pandas.DataFrame:
    """Measure a clip on some days: the table of `write_table`, for pandas.

    Parameters
    ----------
    clip : Clip
    days : sequence of float, optional
        In the clip's time unit; by default those of `measure_days`.
    plant : str
        Its name, in the first column.

    Returns
    -------
    pandas.DataFrame
        One value a row, in the columns that docs/exports.md describes; ``sure`` as bool.

    Raises
    ------
    UserError
        Where pandas is not installed.

    Examples
    --------
    >>> lengths = clip.traits().query("trait == 'length' and sure")  # doctest: +SKIP
    >>> lengths.pivot(index="time", columns="organ", values="value").plot()  # doctest: +SKIP
    """
    try:
        import pandas
    except ImportError:
        raise UserError(
            'Traits as a table need pandas: pip install "plant-growth-clips[pandas]"'
        ) from None
    file = StringIO(newline="")
    write_table(file, Namer(clip, plant), measure_days(clip) if days is None else days)
    file.seek(0)
    return pandas.read_csv(file, true_values=["yes"], false_values=["no"])


@dataclass(frozen=True)
class Namer:
    """A clip and the name of its plant, which all rows of the table repeat."""

    clip: Clip
    plant: str

    def date_at(self, day: float) -> str:
        return date_at(self.clip.scans, day)

    @cached_property
    def _doubts(self) -> tuple[Doubt, ...]:
        return doubts_of(self.clip)

    def is_sure(self, one: Measurement, trait: str, time: float) -> bool:
        """Whether a trait is measured well, of the organ that it is said to be of."""
        return trait in one.sure and not self.is_doubtful(one, time)

    def is_doubtful(self, one: Measurement, time: float) -> bool:
        """Whether the bake doubts what becomes of the organ."""
        return any(d.track == one.track and d.concerns(time) for d in self._doubts)


def measure_days(clip: Clip) -> list[float]:
    """Days of a clip to measure: those of its scans, and the middle of each interval."""
    middles = [(before + after) / 2 for before, after in pairwise(clip.times)]
    return sorted([*clip.times, *middles])


def write_table(
    file: TextIO,
    namer: Namer,
    days: Sequence[float],
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> None:
    """Measure a clip on some days and write the traits as CSV.

    Values are marked `scan` or `between`. Rows marked `rate` hold the growth rate of a trait from
    one scan to the next, with both times and the time elapsed; they need the scans' own days.

    Parameters
    ----------
    file : text file
    namer : Namer
    days : sequence of float
        In the clip's time unit; see `measure_days`.
    progress : callable, optional
        Called with the number of days measured, and of all.
    """
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(COLUMNS)
    found: dict[float, list[Measurement]] = {}
    about = provenance(namer.clip)
    with ThreadPoolExecutor(cpu_count()) as threads:
        measured = zip(days, threads.map(partial(measure, namer.clip), days), strict=True)
        for done, (day, measurements) in enumerate(measured):
            progress(done, len(days))
            found[day] = measurements
            writer.writerows(_safe(row) for row in _values(namer, measurements, about))
    scans = [time for time in namer.clip.times if time in found]
    for before, after in pairwise(scans):
        rates = _rates(namer, found[before], found[after], about)
        writer.writerows(_safe(row) for row in rates)
    progress(len(days), len(days))


def _values(namer: Namer, found: Iterable[Measurement], about: tuple[str, str]) -> Iterator[list]:
    clip = namer.clip
    for one in found:
        state = "scan" if one.time in clip.times else "between"
        when = [state, _number(one.time), namer.date_at(one.time), "", "", ""]
        for trait, power in TRAITS.items():
            value = getattr(one, trait)
            if value is not None:
                what = [NAMES.get(trait, trait), _number(value), _unit(clip, power)]
                how = _how(namer, one, trait, one.time)
                yield [*_who(namer, one), *what, *when, clip.time_unit, *how, *about]
        for name, value in field_means(clip, one.time, one.track).items():
            what = [f"mean_{name}", _number(value), ""]
            how = [one.points, "no" if namer.is_doubtful(one, one.time) else "yes"]
            yield [*_who(namer, one), *what, *when, clip.time_unit, *how, *about]
        if one.angle is not None:
            what = ["angle", _number(one.angle), "degrees"]
            how = _how(namer, one, "angle", one.time)
            yield [*_who(namer, one), *what, *when, clip.time_unit, *how, *about]


def _rates(
    namer: Namer,
    before: Iterable[Measurement],
    after: Iterable[Measurement],
    about: tuple[str, str],
) -> Iterator[list]:
    clip, earlier = namer.clip, {one.track: one for one in before}
    for late in after:
        early = earlier.get(late.track)
        if early is None:
            continue
        passed = late.time - early.time
        when = ["rate", "", "", _number(early.time), _number(late.time), _number(passed)]
        for trait, power in TRAITS.items():
            first, last = getattr(early, trait), getattr(late, trait)
            if first is not None and last is not None:
                unit = f"{_unit(clip, power)}/{clip.time_unit.removesuffix('s')}"
                what = [f"{NAMES.get(trait, trait)}_growth", _number((last - first) / passed), unit]
                how = _how(namer, late if trait in early.sure else early, trait, late.time)
                yield [*_who(namer, late), *what, *when, clip.time_unit, *how, *about]


def _who(namer: Namer, one: Measurement) -> list:
    if one.track is None:
        return [namer.plant, "plant", "", "", "", "", "", ""]
    track = namer.clip.track_table[one.track]
    parent = None if track.parent is None else namer.clip.track_table[track.parent]
    return [
        namer.plant,
        "organ",
        track.id,
        track.name,
        track.kind,
        "" if parent is None else parent.name,
        namer.date_at(track.born),
        "" if track.lost is None else namer.date_at(track.lost),
    ]


def _how(namer: Namer, one: Measurement, trait: str, time: float) -> list:
    return [one.points, "yes" if namer.is_sure(one, trait, time) else "no"]


def _unit(clip: Clip, power: int) -> str:
    unit = clip.unit or "unit"
    return unit if power == 1 else f"{unit}^{power}"


def _number(value: float) -> str:
    return f"{value:.{DIGITS}g}"


def provenance(clip: Clip) -> tuple[str, str]:
    """Name and version of this program, and a digest of the clip's provenance."""
    made = json.dumps(clip.provenance, sort_keys=True).encode()
    return f"plant-growth-clips {__version__}", f"sha256:{hashlib.sha256(made).hexdigest()}"


def _safe(row: list) -> list:
    """Escape cells that a spreadsheet would take for a formula: names come from files (OWASP, CSV
    injection). Numbers may begin with a minus sign.
    """
    return [_text(cell) if isinstance(cell, str) else cell for cell in row]


def _text(cell: str) -> str:
    cell = printable(cell)
    return f"'{cell}" if _is_formula(cell) else cell


def _is_formula(cell: str) -> bool:
    # Spreadsheets skip blanks and fold full-width characters, as NFKC does.
    if not normalize("NFKC", cell).lstrip().startswith(("=", "+", "-", "@")):
        return False
    try:
        float(cell)
    except ValueError:
        return True
    return False
