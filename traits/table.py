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

NAMES = {"hull": "hull_volume"}  # of traits that the table calls otherwise
YES, NO = "yes", "no"
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
        One value in each row, with the columns of docs/traits.md; ``sure`` as bool.

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
    write_table(file, NamedPlant(clip, plant), measure_days(clip) if days is None else days)
    file.seek(0)
    return pandas.read_csv(file, true_values=[YES], false_values=[NO])


@dataclass(frozen=True)
class NamedPlant:
    """A clip with the name of its plant for the table, and with the doubts about its organs."""

    clip: Clip
    name: str

    def date_at(self, day: float) -> str:
        """The date of a time, see `traits.dates.date_at`."""
        return date_at(self.clip.scans, day)

    @cached_property
    def _doubts(self) -> tuple[Doubt, ...]:
        return doubts_of(self.clip)

    def is_sure(self, organ: Measurement, trait: str) -> bool:
        """Whether a trait is measured well, and the organ is not in doubt."""
        return trait in organ.sure and not self.is_doubtful(organ)

    def is_doubtful(self, organ: Measurement) -> bool:
        """Whether a doubt of the bake concerns the organ at the time of its measurement."""
        return any(d.track == organ.track and d.concerns(organ.time) for d in self._doubts)


def measure_days(clip: Clip) -> list[float]:
    """The days on which a clip is measured: those of its scans, and the middle of each interval."""
    middles = [(before + after) / 2 for before, after in pairwise(clip.times)]
    return sorted([*clip.times, *middles])


def write_table(
    file: TextIO,
    plant: NamedPlant,
    days: Sequence[float],
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> None:
    """Measure a clip on some days and write the traits as CSV.

    Values have the state `scan` or `between`. Rows with the state `rate` have the growth rate of a
    trait from one scan to the next, with both times; they need the days of the scans.

    Parameters
    ----------
    file : text file
    plant : NamedPlant
    days : sequence of float
        In the clip's unit of time; see `measure_days`.
    progress : callable, optional
        Called with the number of days measured and their total.
    """
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(COLUMNS)
    measurements_of_day: dict[float, list[Measurement]] = {}
    source = provenance(plant.clip)
    with ThreadPoolExecutor(cpu_count()) as threads:
        measured = zip(days, threads.map(partial(measure, plant.clip), days), strict=True)
        for done, (day, measurements) in enumerate(measured):
            progress(done, len(days))
            measurements_of_day[day] = measurements
            writer.writerows(map(_safe, row) for row in _values(plant, measurements, source))
    scans = [time for time in plant.clip.times if time in measurements_of_day]
    for before, after in pairwise(scans):
        rates = _rates(plant, measurements_of_day[before], measurements_of_day[after], source)
        writer.writerows(map(_safe, row) for row in rates)
    progress(len(days), len(days))


def _values(
    plant: NamedPlant, measurements: Iterable[Measurement], source: tuple[str, str]
) -> Iterator[Sequence[object]]:
    """The rows of measurements at one time."""
    clip = plant.clip
    for organ in measurements:
        state = "scan" if organ.time in clip.times else "between"
        when = (state, _number(organ.time), plant.date_at(organ.time), "", "", "", clip.time_unit)
        values = [
            (NAMES.get(trait, trait), getattr(organ, trait), unit, plant.is_sure(organ, trait))
            for trait, unit in _units(clip).items()
        ]
        fields = field_means(clip, organ.time, organ.track).items()
        values += [
            (f"mean_{name}", mean, "", not plant.is_doubtful(organ)) for name, mean in fields
        ]
        for trait, value, unit, sure in values:
            if value is not None:
                columns = (*_identity(plant, organ), trait, _number(value), unit)
                yield (*columns, *when, organ.points, YES if sure else NO, *source)


def _rates(
    plant: NamedPlant,
    before: Iterable[Measurement],
    after: Iterable[Measurement],
    source: tuple[str, str],
) -> Iterator[Sequence[object]]:
    """The rows of growth rates between two scans."""
    clip, by_track = plant.clip, {organ.track: organ for organ in before}
    for late in after:
        early = by_track.get(late.track)
        if early is None:
            continue
        span = late.time - early.time
        times = (_number(early.time), _number(late.time), _number(span))
        when = ("rate", "", "", *times, clip.time_unit)
        for trait, unit in _units(clip).items():
            first, last = getattr(early, trait), getattr(late, trait)
            if first is not None and last is not None and trait != "angle":
                unit, rate = f"{unit}/{clip.time_unit.removesuffix('s')}", (last - first) / span
                columns = (
                    *_identity(plant, late),
                    f"{NAMES.get(trait, trait)}_growth",
                    _number(rate),
                )
                worse = late if trait in early.sure else early
                sure = YES if plant.is_sure(worse, trait) else NO
                yield (*columns, unit, *when, worse.points, sure, *source)


def _identity(plant: NamedPlant, organ: Measurement) -> tuple[object, ...]:
    """The columns from `plant` to `lost`."""
    if organ.track is None:
        return (plant.name, "plant", "", "", "", "", "", "")
    tracks = plant.clip.track_table
    track = tracks[organ.track]
    parent = "" if track.parent is None else tracks[track.parent].name
    lost = "" if track.lost is None else plant.date_at(track.lost)
    born = plant.date_at(track.born)
    return (plant.name, "organ", track.id, track.name, track.kind, parent, born, lost)


def _units(clip: Clip) -> dict[str, str]:
    """The unit of each trait."""
    unit = clip.unit or "unit"
    lengths = {"height": unit, "length": unit, "area": f"{unit}^2", "hull": f"{unit}^3"}
    return {**lengths, "angle": "degrees"}


def _number(value: float) -> str:
    """Format a number with the precision of float32."""
    return f"{value:.{DIGITS}g}"


def provenance(clip: Clip) -> tuple[str, str]:
    """The last two columns: name and version of this program, digest of the clip's provenance."""
    document = json.dumps(clip.provenance, sort_keys=True).encode()
    return f"plant-growth-clips {__version__}", f"sha256:{hashlib.sha256(document).hexdigest()}"


def _safe(cell: object) -> object:
    """Escape a text that a spreadsheet would interpret as a formula (OWASP, CSV injection)."""
    if not isinstance(cell, str):
        return cell
    cell = printable(cell)
    # Spreadsheets ignore blanks and normalise full-width characters, like NFKC.
    if normalize("NFKC", cell).lstrip().startswith(("=", "+", "-", "@")):
        try:
            float(cell)
        except ValueError:
            return f"'{cell}"
    return cell
