"""Write traits as a table in long format, with one value in each row (RFC 4180 CSV)."""

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

from gclip import __version__
from gclip.errors import UserError
from gclip.text import printable
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
DIGITS = 7  # the precision of float32


def data_frame(
    clip: Clip, days: Sequence[float] | None = None, plant: str = "plant"
) -> pandas.DataFrame:
    """Measure a clip on some days, as a pandas data frame.

    Parameters
    ----------
    clip : Clip
    days : sequence of float, optional
        In the clip's unit of time; by default those of `measure_days`.
    plant : str
        The name in the first column.

    Returns
    -------
    pandas.DataFrame
        One value in each row, with the columns of docs/exports.md; ``sure`` as bool.

    Raises
    ------
    UserError
        If pandas is not installed.

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
    """A clip, the name of its plant for the table, and the doubts about its organs."""

    clip: Clip
    plant: str

    def date_at(self, day: float) -> str:
        return date_at(self.clip.scans, day)

    @cached_property
    def _doubts(self) -> tuple[Doubt, ...]:
        return doubts_of(self.clip)

    def is_sure(self, organ: Measurement, trait: str, time: float) -> bool:
        """Whether a trait is measured well, and the organ is not in doubt."""
        return trait in organ.sure and not self.is_doubtful(organ, time)

    def is_doubtful(self, organ: Measurement, time: float) -> bool:
        """Whether a doubt of the bake concerns the organ at a time."""
        return any(d.track == organ.track and d.concerns(time) for d in self._doubts)


def measure_days(clip: Clip) -> list[float]:
    """The days of a clip that are measured: those of its scans, and the middle of each interval."""
    middles = [(before + after) / 2 for before, after in pairwise(clip.times)]
    return sorted([*clip.times, *middles])


def write_table(
    file: TextIO,
    namer: Namer,
    days: Sequence[float],
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> None:
    """Measure a clip on some days and write the traits as CSV.

    Values have the state `scan` or `between`. Rows with the state `rate` have the growth rate of a
    trait from one scan to the next, with both times; they need the days of the scans.

    Parameters
    ----------
    file : text file
    namer : Namer
    days : sequence of float
        In the clip's unit of time; see `measure_days`.
    progress : callable, optional
        Called with the number of days measured and their total.
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


def _values(namer: Namer, found: Iterable[Measurement], source: tuple[str, str]) -> Iterator[list]:
    """The rows of measurements at one time."""
    clip = namer.clip
    for organ in found:
        state = "scan" if organ.time in clip.times else "between"
        when = [state, _number(organ.time), namer.date_at(organ.time), "", "", "", clip.time_unit]
        values = []
        for trait, power in TRAITS.items():
            if (value := getattr(organ, trait)) is not None:
                columns = [NAMES.get(trait, trait), _number(value), _unit(clip, power)]
                values.append((columns, _quality(namer, organ, trait, organ.time)))
        for name, value in field_means(clip, organ.time, organ.track).items():
            sure = "no" if namer.is_doubtful(organ, organ.time) else "yes"
            values.append(([f"mean_{name}", _number(value), ""], [organ.points, sure]))
        if organ.angle is not None:
            columns = ["angle", _number(organ.angle), "degrees"]
            values.append((columns, _quality(namer, organ, "angle", organ.time)))
        for columns, quality in values:
            yield [*_identity(namer, organ), *columns, *when, *quality, *source]


def _rates(
    namer: Namer,
    before: Iterable[Measurement],
    after: Iterable[Measurement],
    source: tuple[str, str],
) -> Iterator[list]:
    """The rows of growth rates between two scans."""
    clip, by_track = namer.clip, {organ.track: organ for organ in before}
    for late in after:
        early = by_track.get(late.track)
        if early is None:
            continue
        span = late.time - early.time
        times = [_number(early.time), _number(late.time), _number(span)]
        when = ["rate", "", "", *times, clip.time_unit]
        for trait, power in TRAITS.items():
            first, last = getattr(early, trait), getattr(late, trait)
            if first is not None and last is not None:
                unit = f"{_unit(clip, power)}/{clip.time_unit.removesuffix('s')}"
                name, rate = f"{NAMES.get(trait, trait)}_growth", _number((last - first) / span)
                quality = _quality(namer, late if trait in early.sure else early, trait, late.time)
                yield [*_identity(namer, late), name, rate, unit, *when, *quality, *source]


def _identity(namer: Namer, organ: Measurement) -> list:
    """The columns from `plant` to `lost`."""
    if organ.track is None:
        return [namer.plant, "plant", "", "", "", "", "", ""]
    track = namer.clip.track_table[organ.track]
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


def _quality(namer: Namer, organ: Measurement, trait: str, time: float) -> list:
    """The columns `points` and `sure`."""
    return [organ.points, "yes" if namer.is_sure(organ, trait, time) else "no"]


def _unit(clip: Clip, power: int) -> str:
    unit = clip.unit or "unit"
    return unit if power == 1 else f"{unit}^{power}"


def _number(value: float) -> str:
    return f"{value:.{DIGITS}g}"


def provenance(clip: Clip) -> tuple[str, str]:
    """Name and version of this program, and a digest of the clip's provenance."""
    document = json.dumps(clip.provenance, sort_keys=True).encode()
    return f"plant-growth-clips {__version__}", f"sha256:{hashlib.sha256(document).hexdigest()}"


def _safe(row: list) -> list:
    """Escape cells that a spreadsheet would interpret as a formula (OWASP, CSV injection)."""
    return [_escape(cell) if isinstance(cell, str) else cell for cell in row]


def _escape(cell: str) -> str:
    cell = printable(cell)
    return f"'{cell}" if _is_formula(cell) else cell


def _is_formula(cell: str) -> bool:
    """Whether a cell starts like a formula, and is not a number."""
    # Spreadsheets ignore blanks and normalise full-width characters, like NFKC.
    if not normalize("NFKC", cell).lstrip().startswith(("=", "+", "-", "@")):
        return False
    try:
        float(cell)
    except ValueError:
        return True
    return False
