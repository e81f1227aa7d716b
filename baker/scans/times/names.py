"""Read the times of scans from their names or from a list: dates, or days, weeks and hours.

A single name may be ambiguous (``05032023`` is in March or in May), but the names of a series
together seldom are. A convention must match all names, with a different time in each. Among those
that do, the one of lowest rank is used, then the one that matches first in the names, then (for the
order of day, month and year) the one that gives the shortest series.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Self

import numpy as np

from baker.errors import InputError, input_errors
from baker.scans.times.conventions import (
    CONVENTIONS,
    NO_YEAR,
    Convention,
    Moment,
    read_moment,
)
from gclip.config_file import read_text

MAX_GAP_WITHIN_YEAR = 183  # days; after a longer gap, dates without a year are in the year before
MAX_SPAN = 1100  # days from first to last; numbers that span more are not dates
MAX_TIME_CHARACTERS = 100
MAX_FILE_BYTES = 1 << 24


@dataclass(frozen=True)
class Reading:
    """The times of all names of a series, read by one convention.

    spans: start and stop of the time in each name.
    doubt: how else the times may be read, "" where that is clear.
    """

    moments: tuple[Moment, ...]
    spans: tuple[tuple[int, int], ...]
    convention: Convention
    doubt: str = ""

    @property
    def are_distinct(self) -> bool:
        """Whether no two scans have the same time."""
        return len({moment.time for moment in self.moments}) == len(self.moments)

    def contradicts(self, other: Self) -> bool:
        """Whether other times of the same kind, or of another part of the names, are as likely."""
        if self.length > MAX_SPAN:
            return False
        if self.convention.family == other.convention.family:
            return self.moments != other.moments
        (start, stop), (other_start, other_stop) = self.spans[0], other.spans[0]
        orders = [np.argsort([m.time for m in read.moments]).tolist() for read in (self, other)]
        is_separate = stop <= other_start or other_stop <= start
        return self.convention.is_clear and is_separate and orders[0] != orders[1]

    @property
    def length(self) -> float:
        """Days from the first to the last scan."""
        return float(np.ptp([moment.time for moment in self.moments]))


def read_times(texts: Sequence[str]) -> Reading | None:
    """Read the times in the names of scans (without suffix), or of their folders.

    Returns the most likely reading in which all times are different, else a clear one in which two
    scans have the same time, or None.
    """
    readings = [
        reading
        for convention in CONVENTIONS
        for reading in _readings(convention, texts)
        # Weak conventions also match counters, but those seldom look like dates of one season.
        if convention.is_clear or reading.length <= MAX_SPAN
    ]
    distinct = [reading for reading in readings if reading.are_distinct]
    if not distinct:
        clear = [reading for reading in readings if reading.convention.is_clear]
        return next((reading for reading in clear if not _is_shared(reading, texts)), None)
    best = min(distinct, key=lambda read: (read.convention.rank, read.spans[0][0], read.length))
    return replace(best, doubt=_doubt(best, distinct, texts[0]))


def has_time(text: str) -> bool:
    """Whether a text holds a clearly written time: a date with a year, or a labelled number."""
    return (reading := read_times([text])) is not None and reading.convention.is_clear


def _readings(convention: Convention, texts: Sequence[str]) -> Iterator[Reading]:
    """Read the first match in all texts, then the second in all, and so on."""
    for matches in zip(*map(convention.pattern.finditer, texts), strict=False):
        moments = [moment for moment in map(read_moment, matches) if moment is not None]
        if len(moments) == len(texts):
            if convention.family == NO_YEAR:
                moments = _across_new_year(moments)
            yield Reading(tuple(moments), tuple(match.span() for match in matches), convention)


def _is_shared(reading: Reading, texts: Sequence[str]) -> bool:
    """Whether the number is the same in all names (a plot, a pot), which differ elsewhere."""
    rest = {t[:start] + t[stop:] for t, (start, stop) in zip(texts, reading.spans, strict=True)}
    return reading.length == 0 and not reading.moments[0].dated and len(rest) == len(texts)


def _doubt(best: Reading, readings: Sequence[Reading], first: str) -> str:
    """How else the times may be read; `first` is the first name."""
    if others := [reading for reading in readings if reading.contradicts(best)]:
        other = min(others, key=lambda reading: reading.length)
        moments = sorted(other.moments, key=lambda moment: moment.time)
        span = f"from {moments[0].date} to {moments[-1].date}"
        return f"the names can also be read as {other.convention.what}, {span}"
    start, stop = best.spans[0]
    taken = f"'{first[start:stop]}' was taken for {best.moments[0].date}"
    return "" if best.convention.is_clear else taken


def _across_new_year(moments: list[Moment]) -> list[Moment]:
    """Move dates without a year that precede a gap of half a year into the next year."""
    times = sorted(moment.time for moment in moments)
    breaks = [b for a, b in pairwise(times) if b - a > MAX_GAP_WITHIN_YEAR]
    return [
        replace(moment, time=moment.time + 365) if breaks and moment.time < breaks[-1] else moment
        for moment in moments
    ]


def moments_from_file(path: Path, names: Sequence[str]) -> list[Moment]:
    """Look up the time of each scan in a times file, by its name with or without folder and suffix.

    Raises InputError where a line is wrong or a scan is missing.
    """
    with input_errors(path):
        text = read_text(path, MAX_FILE_BYTES)
    rows: dict[str, tuple[str, str]] = {}  # name of the scan -> place in the file, time
    for number, line in enumerate(map(str.strip, text.splitlines()), 1):
        if not line or line.startswith(("#", "//")):
            continue
        parts = re.split(r"[,;\t]", line, maxsplit=2)
        parts = parts if len(parts) > 1 else [*line.split(None, 1), ""]
        name, time = (part.strip().strip("\"' ") for part in parts[:2])
        place = f"'{path}', line {number}"
        if not time or not name:
            raise InputError(f"{place}: expected a scan's name and a time, found '{line[:60]}'.")
        if name in rows:
            raise InputError(f"{place}: '{name}' has a time already.")
        if rows or re.search(r"\d", time):  # the first line may be a header
            rows[name] = place, time
    listed = dict(zip(rows, _parse([*rows.values()], f"'{path}'"), strict=True))
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
    """Convert the time of each scan: a number of days, a `datetime` date, or text as in a file."""
    if len(times) != len(names):
        raise InputError(f"times holds {len(times)} times for {len(names)} scans.")
    return _parse([("times", str(time)) for time in times], "times")


def _parse(rows: Sequence[tuple[str, str]], source: str) -> list[Moment]:
    """Parse days and ISO dates or, where a text is neither, all times as those in names.

    rows: the place of each time, for messages, and its text. Raises InputError for a text that is
    not a time, or where dates and days are mixed.
    """
    found = [_parse_time(text) for _, text in rows]
    if None in found and (reading := read_times([text[:MAX_TIME_CHARACTERS] for _, text in rows])):
        return list(reading.moments)
    for (place, text), moment in zip(rows, found, strict=True):
        if moment is None:
            needed = "a number of days, or a date such as 2020-03-08, is needed"
            raise InputError(f"{place}: '{text[:60]}' is no time; {needed}.")
    moments = [moment for moment in found if moment]
    if len({moment.dated for moment in moments}) > 1:
        raise InputError(f"{source} mixes dates and numbers of days; use one of them throughout.")
    return moments


def _parse_time(text: str) -> Moment | None:
    """A number of days, or an ISO date or date-time; None where a text is something else."""
    if len(text) > MAX_TIME_CHARACTERS:  # on which the patterns would take long
        return None
    date = CONVENTIONS[0].pattern.fullmatch(text)
    if moment := date and read_moment(date):
        return moment
    is_number = re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)", text)
    return Moment(float(text), f"day {float(text):.10g}") if is_number else None
