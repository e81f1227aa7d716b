"""Times as people write them, into names of scans or lists: dates, or days, weeks and hours.

A convention is a pattern and what its numbers mean. No name tells alone which one its author had in
mind (``05032023`` is in March or in May), but the names of a series together mostly do: a
convention has to fit all of them, the number has to differ from scan to scan, and of several
the first in the names counts, and of several possible orders of day, month and year the one that
gives the shortest series.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Self

import numpy as np

from baker.errors import InputError, asking
from baker.scans.times.conventions import (
    CONVENTIONS,
    NO_YEAR,
    Convention,
    Moment,
    parse_date,
    read_moment,
)
from gclip.config_file import read_text

MAX_GAP_WITHIN_YEAR = 183  # days; a longer gap between dates without a year is a turn of the year
MAX_SPAN = 1100  # days that dates without separators may span: else they are other numbers
MAX_TIME_CHARACTERS = 100
MAX_FILE_BYTES = 1 << 24


@dataclass(frozen=True)
class Reading:
    """The times of all names of a series, by one convention.

    spans: where in each text the time stands; doubt: how else the times may be read, or empty.
    """

    moments: tuple[Moment, ...]
    spans: tuple[tuple[int, int], ...]
    convention: Convention
    doubt: str = ""

    @property
    def distinct(self) -> bool:
        """Whether no two scans have the same time."""
        return len({moment.time for moment in self.moments}) == len(self.moments)

    def contradicts(self, other: Self) -> bool:
        """Whether it is clear, of another part of the first name, and gives another order."""
        (start, stop), (other_start, other_stop) = self.spans[0], other.spans[0]
        orders = [np.argsort([m.time for m in read.moments]).tolist() for read in (self, other)]
        is_apart = stop <= other_start or other_stop <= start
        return self.convention.is_clear and is_apart and orders[0] != orders[1]

    @property
    def length(self) -> float:
        """Days from the first to the last."""
        return float(np.ptp([moment.time for moment in self.moments]))


def read_times(texts: Sequence[str]) -> Reading | None:
    """The times that all texts have: of each scan its file's name without suffix, or a folder's.

    That is the most likely reading in which all times differ, else one in which two scans have the
    same time.
    """
    readings = [
        reading
        for convention in CONVENTIONS
        for reading in _readings(convention, texts)
        # Weak conventions fit counters as well, which seldom give dates of one season.
        if convention.is_clear or reading.length <= MAX_SPAN
    ]
    distinct = [reading for reading in readings if reading.distinct]
    if not distinct:
        clear = [reading for reading in readings if reading.convention.is_clear]
        return next((reading for reading in clear if not _is_shared(reading, texts)), None)
    best = min(distinct, key=lambda read: (read.convention.rank, read.spans[0][0], read.length))
    others = [
        reading
        for reading in distinct
        if reading.length <= MAX_SPAN
        if (
            reading.moments != best.moments
            if reading.convention.family == best.convention.family
            else reading.contradicts(best)
        )
    ]
    start, stop = best.spans[0]
    return replace(best, doubt=_doubt(best, others, texts[0][start:stop]))


def find_time(text: str) -> re.Match[str] | None:
    """The first clearly written time in a text: a date with a year, or a labelled number."""
    clear = (convention for convention in CONVENTIONS if convention.is_clear)
    matches = (match for convention in clear for match in convention.pattern.finditer(text))
    return next((match for match in matches if read_moment(match) is not None), None)


def _readings(convention: Convention, texts: Sequence[str]) -> Iterator[Reading]:
    """One reading for each place, counted from the left, at which all texts have a match."""
    for matches in zip(*map(convention.pattern.finditer, texts), strict=False):
        moments = [moment for moment in map(read_moment, matches) if moment is not None]
        if len(moments) == len(texts):
            if convention.family == NO_YEAR:
                moments = _across_new_year(moments)
            yield Reading(tuple(moments), tuple(match.span() for match in matches), convention)


def _is_shared(reading: Reading, texts: Sequence[str]) -> bool:
    """Whether all names have one number in common (a plot, a pot) and differ in another one."""
    rest = {t[:start] + t[stop:] for t, (start, stop) in zip(texts, reading.spans, strict=True)}
    return reading.length == 0 and not reading.moments[0].dated and len(rest) == len(texts)


def _doubt(best: Reading, others: Sequence[Reading], first: str) -> str:
    if others:
        other = min(others, key=lambda reading: reading.length)
        first, *_, last = (m.date for m in sorted(other.moments, key=lambda moment: moment.time))
        return f"the names can also be read as {other.convention.what}, from {first} to {last}"
    return "" if best.convention.is_clear else f"'{first}' was taken for {best.moments[0].date}"


def _across_new_year(moments: list[Moment]) -> list[Moment]:
    """Dates without a year: those before a gap of half a year belong to the next year."""
    times = sorted(moment.time for moment in moments)
    breaks = [b for a, b in pairwise(times) if b - a > MAX_GAP_WITHIN_YEAR]
    return [
        replace(moment, time=moment.time + 365) if breaks and moment.time < breaks[-1] else moment
        for moment in moments
    ]


def moments_from_file(path: Path, names: Sequence[str]) -> list[Moment]:
    """The time of each of `names`, looked up by the name with or without folder and suffix."""
    rows = _rows(path)
    places = [f"'{path}', line {number}" for number, _ in rows.values()]
    times = _parse([text for _, text in rows.values()], places, f"'{path}'")
    listed = dict(zip(rows, times, strict=True))
    moments = []
    for name in names:
        plain = name.rpartition("/")[2]
        keys = (name, name.rpartition(".")[0], plain, plain.rpartition(".")[0])
        found = [listed[key] for key in keys if key in listed]
        if not found:
            raise InputError(f"'{path}' has no line for the scan '{name}'.")
        moments.append(found[0])
    return moments


def moments_from_list(times: Sequence[object], names: Sequence[str]) -> list[Moment]:
    """The time of each of `names`: numbers of days, dates of `datetime`, or texts as in a file."""
    if len(times) != len(names):
        raise InputError(f"times holds {len(times)} times for {len(names)} scans.")
    return _parse([str(time) for time in times], ["times"] * len(times), "times")


def _rows(path: Path) -> dict[str, tuple[int, str]]:
    """By name the number of the line and the time, of lines that are no comments and no header."""
    with asking(path):
        text = read_text(path, MAX_FILE_BYTES)
    rows: dict[str, tuple[int, str]] = {}
    for number, line in enumerate(map(str.strip, text.splitlines()), 1):
        if not line or line.startswith(("#", "//")):
            continue
        parts = re.split(r"[,;\t]", line, maxsplit=2)
        parts = parts if len(parts) > 1 else [*line.split(None, 1), ""]
        name, time = (part.strip().strip("\"' ") for part in parts[:2])
        if not time or not name:
            raise InputError(
                f"'{path}', line {number}: expected a scan's name and a time, found '{line[:60]}'."
            )
        if rows.setdefault(name, (number, time))[0] != number:
            raise InputError(f"'{path}', line {number}: '{name}' has a time already.")
    header = [name for name, (_, time) in [*rows.items()][:1] if not re.search(r"\d", time)]
    return {name: rows[name] for name in rows if name not in header}


def _parse(texts: Sequence[str], places: Sequence[str], source: str) -> list[Moment]:
    """Days and ISO dates as they stand; else the times as they are read from names.

    Raises InputError with the place of a text that is no time, or where not all are of one kind.
    """
    found = [_parse_time(text) for text in texts]
    if None in found and (reading := read_times([text[:MAX_TIME_CHARACTERS] for text in texts])):
        return list(reading.moments)
    moments = []
    for text, place, moment in zip(texts, places, found, strict=True):
        if moment is None:
            needed = "a number of days, or a date such as 2020-03-08, is needed"
            raise InputError(f"{place}: '{text[:60]}' is no time; {needed}.")
        moments.append(moment)
    if len({moment.dated for moment in moments}) > 1:
        raise InputError(f"{source} mixes dates and numbers of days; use one of them throughout.")
    return moments


def _parse_time(text: str) -> Moment | None:
    if len(text) > MAX_TIME_CHARACTERS:  # which the patterns would try at length
        return None
    if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)", text) and not parse_date(text):
        return Moment(float(text), f"day {float(text):.10g}")
    return parse_date(text)
