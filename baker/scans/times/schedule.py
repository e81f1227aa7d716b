"""The order and the times of scans: from a file with the times, from their names, or as given.

A rule counts only if it fits every scan. The first that does is used:

1. ``--times FILE``: a line ``name time`` for each scan, the time a number of days or an ISO date or
   date-time (``2020-03-08``, ``2020-03-08T14:30``).
2. Dates or numbers of days, weeks or hours in the names; where these have none, in the names of the
   folders that the scans are in (`baker.scans.times.names`).
3. The order: 0, 1, 2, ..., natural (9 before 10) in a folder, as given for a list of files.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from baker.errors import InputError
from baker.scans.times.conventions import Moment
from baker.scans.times.names import Reading, find_time, read_times
from baker.scans.times.times_file import moments_from_file

MAX_ABS_TIME = 1e12  # days
MIN_TIME_STEP = 1e-9  # days between two scans
FOLDER_LEVELS = 2  # folders above a scan whose names may hold its time
MAX_LISTED_NAMES = 12  # of scans whose order is told by name


@dataclass(frozen=True)
class FoundScans:
    """Two or more scan files: of a folder (in natural order), or a list (in the order given)."""

    paths: tuple[Path, ...]
    from_folder: bool


@dataclass(frozen=True)
class Entry:
    """A scan with its time; name: the file's name, with its folder where names are all alike."""

    path: Path
    name: str
    moment: Moment


@dataclass(frozen=True)
class Schedule:
    """Scans in the order of time; rule and unit as in `baker.scans.Series`."""

    entries: tuple[Entry, ...]
    rule: str
    unit: str


def schedule_scans(found: FoundScans, times_file: Path | None = None) -> Schedule:
    """Order and time the scans by the first rule that fits them all.

    Raises InputError: two scans at one time, a times file that can't be read or misses a scan,
    numbered names whose order can't be told.
    """
    names = _names(found.paths)
    if times_file is not None:
        moments = moments_from_file(times_file, names)
        return _in_time(found, names, moments, f"times from '{times_file.name}'")

    read = times_in_names(found.paths)
    if read is not None:
        where = "folders' names" if read.folder_level else "names"
        rule = f"times from the {read.reading.convention.what} in the {where}"
        schedule = _in_time(found, names, read.reading.moments, rule)
        doubt = f" Look at this: {read.reading.doubt}." if read.reading.doubt else ""
        return replace(schedule, rule=schedule.rule + doubt)
    return _in_order(found, names)


def natural_key(name: str) -> list[tuple[int, int, str]]:
    """A sort key in which the numbers of a name count as numbers: scan9 comes before scan10."""
    parts = re.findall(r"\d+|\D+", name)
    return [(0, int(p), p) if p.isdecimal() else (1, 0, p.lower()) for p in parts]


@dataclass(frozen=True)
class NameTimes:
    """Times read from names: those of the files (level 0) or of a folder so many levels above."""

    reading: Reading
    folder_level: int


def times_in_names(paths: Sequence[Path]) -> NameTimes | None:
    """The times that the names of all scans tell, or else those of the folders they are in.

    A clearly written time in a folder's name is preferred to mere numbers in the files' names.
    """
    found = []
    for level in range(FOLDER_LEVELS + 1):
        texts = [path.stem if level == 0 else _folder(path, level) for path in paths]
        reading = read_times(texts)
        if reading is not None and (reading.distinct or level == 0):
            found.append(NameTimes(reading, level))
    clear = [read for read in found if read.reading.distinct and read.reading.convention.is_clear]
    distinct = [read for read in found if read.reading.distinct]
    return next(iter(clear or distinct or found), None)


def _folder(path: Path, level: int) -> str:
    above = path.resolve().parents
    return above[level - 1].name if level <= len(above) else ""


def names_without_times(stems: Sequence[str]) -> list[str]:
    """The names with a star for the time, which tell whether they belong to one series.

    What follows the time is left out where some names have it and others nothing: published series
    mark annotated scans so (``M01_0313_a``, ``M01_0314``).
    """
    reading = read_times(stems)
    if reading is not None and reading.distinct:
        spans = list(reading.spans)
    else:
        matches = [find_time(stem) for stem in stems]
        spans = [
            (len(s), len(s)) if m is None else m.span() for s, m in zip(stems, matches, strict=True)
        ]
    before = [stem[:start] for stem, (start, _) in zip(stems, spans, strict=True)]
    stars = ["*" if stop > start else "" for start, stop in spans]
    after = [stem[stop:] for stem, (_, stop) in zip(stems, spans, strict=True)]
    if all(stars) and len(set(after)) == 2 and "" in after:
        after = [""] * len(stems)
    return [a + b + c for a, b, c in zip(before, stars, after, strict=True)]


def _in_time(
    found: FoundScans, names: Sequence[str], moments: Sequence[Moment], rule: str
) -> Schedule:
    entries = [
        Entry(path, name, moment)
        for path, name, moment in zip(found.paths, names, moments, strict=True)
    ]
    for entry in entries:
        if not abs(entry.moment.time) <= MAX_ABS_TIME:
            raise InputError(
                f"'{entry.name}' has the time {entry.moment.date} ({rule}); days from "
                f"{-MAX_ABS_TIME:g} to {MAX_ABS_TIME:g} are possible."
            )
    in_time = sorted(entries, key=lambda entry: entry.moment.time)
    for before, after in pairwise(in_time):
        if before.moment.time == after.moment.time:
            raise InputError(
                f"'{before.name}' and '{after.name}' have the same time, {after.moment.date} "
                f"({rule}); one moment can have one scan only."
            )
        if after.moment.time - before.moment.time < MIN_TIME_STEP:
            raise InputError(
                f"'{before.name}' and '{after.name}' have nearly the same time ({rule}); "
                f"{MIN_TIME_STEP:g} days have to lie between two scans."
            )
    rule = f"{rule}: {in_time[0].moment.date} to {in_time[-1].moment.date}"
    if in_time != entries and not found.from_folder:
        rule += " (in the order of time, not in the order given)"
    return Schedule(tuple(_from_the_first(in_time)), rule + ".", "days")


def _from_the_first(entries: list[Entry]) -> list[Entry]:
    """Dates become days since the first scan: the plant's age, not the calendar's."""
    first = entries[0].moment.time
    if not all(entry.moment.dated for entry in entries):
        return entries
    return [
        replace(entry, moment=replace(entry.moment, time=entry.moment.time - first))
        for entry in entries
    ]


def _in_order(found: FoundScans, names: Sequence[str]) -> Schedule:
    natural = sorted(range(len(names)), key=lambda i: natural_key(names[i]))
    given = list(range(len(names)))
    # A shell's * lists scan10 before scan9: nobody means that order.
    from_shell = list(names) == sorted(names) and natural != given
    if found.from_folder or from_shell:
        _require_clear_order([names[i] for i in natural])
        order, how = natural, "the natural order of their names"
    else:
        order, how = given, "the order given"

    entries = tuple(
        Entry(found.paths[i], names[i], Moment(float(k), str(k))) for k, i in enumerate(order)
    )
    untimed = [name for name in names if find_time(_stem(name)) is None]
    why = (
        f"no time in the name '{untimed[0]}'"
        if 0 < len(untimed) < len(names)
        else "no times in the names"
    )
    listed = [entries[k].name for k in range(min(len(entries), MAX_LISTED_NAMES))]
    more = ", ..." if len(entries) > len(listed) else ""
    rule = (
        f"{why}: scans numbered 0 to {len(names) - 1} in {how}: {', '.join(listed)}{more}. "
        "Growth rates will be per scan; --times FILE tells the days."
    )
    return Schedule(entries, rule, "scans")


def _require_clear_order(names: Sequence[str]) -> None:
    """Numbers at the same place of the names must all grow together, else which one is time?"""
    numbers = [[int(n) for n in re.findall(r"\d+", _stem(name))] for name in names]
    for i, (before, after) in enumerate(pairwise(numbers)):
        if any(a > b for a, b in zip(before, after, strict=False)):
            raise InputError(
                f"The order of '{names[i]}' and '{names[i + 1]}' can't be told from their names; "
                "say it with --times FILE, with dates such as 2020-03-08 in the names, or by "
                "naming the files in order."
            )


def _names(paths: Sequence[Path]) -> list[str]:
    """File names; with their folders where that alone tells them apart (2020-03-08/scan.ply)."""
    names = [path.name for path in paths]
    if len(set(names)) < len(names):
        names = [f"{path.resolve().parent.name}/{path.name}" for path in paths]
    return names


def _stem(name: str) -> str:
    return name.rpartition(".")[0]
