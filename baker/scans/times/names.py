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
from baker.scans.times.conventions import CONVENTIONS, Convention, Moment, read_moment
from gclip.config_file import read_text

DEFAULT_YEARS = ("2001", "2000")  # of dates without a year; the second one has a 29 February
MAX_GAP_WITHIN_YEAR = 183  # days; after a longer gap, dates without a year are in the year before
MAX_SPAN = 1100  # days from first to last; numbers that span more are not dates
MAX_TIME_CHARACTERS = 100  # of a time in a file or list
MAX_FILE_BYTES = 1 << 24  # of a times file


@dataclass(frozen=True)
class Reading:
    """The times of all names of a series, read by one convention."""

    moments: tuple[Moment, ...]
    spans: tuple[tuple[int, int], ...]  # start and stop of the time in each name
    convention: Convention
    doubt: str = ""  # how else the times may be read

    @property
    def times(self) -> list[float]:
        """Days, as in `Moment`."""
        return [moment.time for moment in self.moments]

    @property
    def are_distinct(self) -> bool:
        """Whether no two scans have the same time."""
        return len(set(self.times)) == len(self.times)

    @property
    def length(self) -> float:
        """Days from the first to the last scan."""
        return max(self.times) - min(self.times)

    def contradicts(self, best: Self) -> bool:
        """Whether other times of the same kind, or of another part of the names, are as likely."""
        own, reference = self.convention, best.convention
        if (own.rank, own.kind) == (reference.rank, reference.kind):
            return self.times != best.times
        (start, stop), (best_start, best_stop) = self.spans[0], best.spans[0]
        is_separate = stop <= best_start or best_stop <= start
        orders = [np.argsort(reading.times).tolist() for reading in (self, best)]
        return own.is_clear and is_separate and orders[0] != orders[1]


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
    rivals = [read for read in distinct if read.length <= MAX_SPAN and read.contradicts(best)]
    doubt = ""
    if rivals:
        rival = min(rivals, key=lambda reading: reading.length)
        dates = [moment.date for moment in sorted(rival.moments, key=lambda moment: moment.time)]
        doubt = f"the names can also be read as {rival.convention.kind}, {dates[0]} to {dates[-1]}"
    elif not best.convention.is_clear:
        start, stop = best.spans[0]
        doubt = f"'{texts[0][start:stop]}' was taken for {best.moments[0].date}"
    return replace(best, doubt=doubt)


def has_time(text: str) -> bool:
    """Whether a text holds a clearly written time: a date with a year, or a labelled number."""
    return (reading := read_times([text])) is not None and reading.convention.is_clear


def _readings(convention: Convention, texts: Sequence[str]) -> Iterator[Reading]:
    """Yield the reading of the first match in every text, that of the second match, and so on."""
    for matches in zip(*map(convention.pattern.finditer, texts), strict=False):
        for year in DEFAULT_YEARS:
            moments = tuple(filter(None, (read_moment(match, year) for match in matches)))
            if len(moments) == len(texts):
                if {"m", "Y", "y"} & convention.pattern.groupindex.keys() == {"m"}:  # no year
                    moments = _across_new_year(moments)
                yield Reading(moments, tuple(match.span() for match in matches), convention)
                break


def _is_shared(reading: Reading, texts: Sequence[str]) -> bool:
    """Whether the number is the same in all names (a plot, a pot), which differ elsewhere."""
    rest = {t[:start] + t[stop:] for t, (start, stop) in zip(texts, reading.spans, strict=True)}
    return reading.length == 0 and not reading.moments[0].dated and len(rest) == len(texts)


def _across_new_year(moments: tuple[Moment, ...]) -> tuple[Moment, ...]:
    """Move dates without a year, if they precede a gap of half a year, into the next year."""
    times = sorted(moment.time for moment in moments)
    after_gap = max((b for a, b in pairwise(times) if b - a > MAX_GAP_WITHIN_YEAR), default=-np.inf)
    return tuple(replace(m, time=m.time + 365 * (m.time < after_gap)) for m in moments)


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
    entries = []
    for name in names:
        plain = name.rpartition("/")[2]
        keys = (name, name.rpartition(".")[0], plain, plain.rpartition(".")[0])
        if not (matching := [rows[key] for key in keys if key in rows]):
            raise InputError(f"'{path}' has no line for the scan '{name}'.")
        entries.append(matching[0])
    return _parse(entries, f"'{path}'")


def moments_from_list(times: Sequence[object], names: Sequence[str]) -> list[Moment]:
    """Convert the time of each scan: a number of days, a `datetime` date, or text as in a file."""
    if len(times) != len(names):
        raise InputError(f"times holds {len(times)} times for {len(names)} scans.")
    return _parse([("times", str(time)) for time in times], "times")


def _parse(rows: Sequence[tuple[str, str]], source: str) -> list[Moment]:
    """Parse all texts as numbers of days or, if one is not a number, all as times in names.

    rows: where each time was read, for messages, and its text. Raises InputError for a text that is
    not a time, or where dates and days are mixed.
    """
    # Longer texts are not times, and the patterns would take long on them.
    texts = [text if len(text) <= MAX_TIME_CHARACTERS else "" for _, text in rows]
    are_days = [bool(re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)", text)) for text in texts]
    if all(are_days):
        return [Moment(float(text), f"day {float(text):.10g}") for text in texts]
    if reading := read_times(texts):
        return list(reading.moments)
    for (where, text), searched, is_days in zip(rows, texts, are_days, strict=True):
        if not is_days and not has_time(searched):
            needed = "a number of days, or a date such as 2020-03-08, is needed"
            raise InputError(f"{where}: '{text[:60]}' is no time; {needed}.")
    raise InputError(f"{source} mixes dates and numbers of days; use one of them throughout.")
