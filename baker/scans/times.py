"""When each scan was taken: from a file with the times, from the names, or just their order.

A rule counts only if it fits every scan; the first that does, in this order, is used:

1. `--times FILE`: a line ``name time`` for each scan, the time a number of days or an ISO date or
   date-time (``2020-03-08``, ``2020-03-08T14:30``).
2. Dates in the names: ``2020-03-08.ply``, ``maize_20200308_1430.txt``, ``2020-03-08T14-30.las``.
3. Day numbers in the names: ``day05.txt``, ``plant_D12.txt``, ``DAS 12.5.ply``.
4. The order: 0, 1, 2, …, natural (9 before 10) in a folder, as given for a list of files.
"""

from __future__ import annotations

import re
import stat
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path

from baker.errors import InputError

LONGEST = 100  # letters of a time
LARGEST_FILE = 1 << 24  # bytes of a list of times
FARTHEST = 1e12  # a time beyond is no day of a plant's
SHORTEST = 1e-9  # between two scans
_DATE = re.compile(
    r"""(?<!\d) (?P<year>(?:19|20|21)\d\d) (?P<dash>[-_.]?) (?P<month>\d\d) (?P=dash) (?P<day>\d\d)
        (?: [T_\ -]? (?P<hour>[01]\d|2[0-3]) [-:_.h]? (?P<minute>[0-5]\d)
            (?: [-:_.m]? (?P<second>[0-5]\d) )? Z? )?
        (?!\d)""",
    re.VERBOSE | re.IGNORECASE,
)
# d, day, or days after sowing, germination, planting, emergence, transplanting.
_DAY = re.compile(
    r"(?<![a-z0-9])(?:days?|d|da[sgpet])[ _-]?(?P<number>\d+(?:\.\d+)?)", re.IGNORECASE
)
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


@dataclass(frozen=True)
class FoundScans:
    """Two or more scan files: of a folder (in natural order), or a list (in the order given)."""

    paths: tuple[Path, ...]
    from_folder: bool


@dataclass(frozen=True)
class Moment:
    """time: days (since 1970 where `dated`); date: the same as people write it."""

    time: float
    date: str
    dated: bool = False


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
        moments = _moments_from_file(times_file, names)
        return _in_time(found, names, moments, f"times from '{times_file.name}'")

    dates = _all_or_none([_find_date(_stem(name)) for name in names])
    days = _all_or_none([_find_day(_stem(name)) for name in names])
    # A date that all names share (that of sowing, say) is no time where day numbers tell more.
    if dates and not (days and len({moment.time for moment in dates}) == 1):
        return _in_time(found, names, dates, "times from the dates in the names")
    if days:
        return _in_time(found, names, days, "times from the day numbers in the names")
    return _in_order(found, names)


def natural_key(name: str) -> list[tuple[int, int, str]]:
    """A sort key in which the numbers of a name count as numbers: scan9 comes before scan10."""
    parts = re.findall(r"\d+|\D+", name)
    return [(0, int(p), p) if p.isdecimal() else (1, 0, p.lower()) for p in parts]


def without_time(stem: str) -> str:
    """`stem` with its date or day number replaced by a star."""
    return _DAY.sub("*", _DATE.sub("*", stem, count=1), count=1)


def _all_or_none(moments: Sequence[Moment | None]) -> list[Moment] | None:
    known = [moment for moment in moments if moment is not None]
    return known if len(known) == len(moments) else None


def _in_time(
    found: FoundScans, names: Sequence[str], moments: Sequence[Moment], rule: str
) -> Schedule:
    entries = [
        Entry(path, name, moment)
        for path, name, moment in zip(found.paths, names, moments, strict=True)
    ]
    for entry in entries:
        if not abs(entry.moment.time) <= FARTHEST:
            raise InputError(
                f"'{entry.name}' has the time {entry.moment.date} ({rule}); days from "
                f"{-FARTHEST:g} to {FARTHEST:g} are possible."
            )
    in_time = sorted(entries, key=lambda entry: entry.moment.time)
    for before, after in pairwise(in_time):
        if before.moment.time == after.moment.time:
            raise InputError(
                f"'{before.name}' and '{after.name}' have the same time, {after.moment.date} "
                f"({rule}); one moment can have one scan only."
            )
        if after.moment.time - before.moment.time < SHORTEST:
            raise InputError(
                f"'{before.name}' and '{after.name}' have nearly the same time ({rule}); "
                f"{SHORTEST:g} days have to lie between two scans."
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
    rule = f"no times in the names: scans numbered 0 to {len(names) - 1} in {how}"
    dated = [name for name in names if _find_date(_stem(name)) or _find_day(_stem(name))]
    if dated:
        undated = next(name for name in names if name not in dated)
        rule = rule.replace("no times in the names", f"no time in the name '{undated}'")
    return Schedule(entries, rule + ".", "scans")


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


def _find_date(text: str) -> Moment | None:
    match = _DATE.search(text)
    return _date_of(match) if match else None


def _date_of(match: re.Match[str]) -> Moment | None:
    numbers = [int(n) for n in match.group("year", "month", "day", "hour", "minute", "second") if n]
    try:
        moment = datetime(*numbers, tzinfo=UTC)  # type: ignore[arg-type, misc]
    except ValueError:
        return None  # 2020-13-40
    written = moment.strftime("%Y-%m-%d %H:%M:%S")
    written = written[: {3: 10, 5: 16}.get(len(numbers), 19)]
    return Moment((moment - _EPOCH).total_seconds() / 86400, written, dated=True)


def _find_day(text: str) -> Moment | None:
    match = _DAY.search(text)
    return _day(float(match["number"])) if match else None


def _day(number: float) -> Moment:
    return Moment(number, f"day {number:.10g}")


def _moments_from_file(path: Path, names: Sequence[str]) -> list[Moment]:
    """The time of each of `names`, looked up by the name with or without folder and suffix."""
    listed = _read_times(path)
    moments = []
    for name in names:
        plain = name.rpartition("/")[2]
        keys = (name, _stem(name), plain, _stem(plain))
        moment = next((listed[key] for key in keys if key in listed), None)
        if moment is None:
            raise InputError(f"'{path}' has no line for the scan '{name}'.")
        moments.append(moment)
    if len({moment.date.startswith("day ") for moment in moments}) > 1:
        raise InputError(f"'{path}' mixes dates and numbers of days; use one of them throughout.")
    return moments


def _read_times(path: Path) -> dict[str, Moment]:
    try:
        state = path.stat()
        if stat.S_ISFIFO(state.st_mode) or stat.S_ISCHR(state.st_mode):
            raise InputError(f"'{path}' (times) is not a regular file.")
        if state.st_size > LARGEST_FILE:
            raise InputError(
                f"'{path}' (times) holds {state.st_size} bytes; a list of times has "
                f"{LARGEST_FILE} at most."
            )
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise InputError(f"'{path}' (times) can't be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"'{path}' (times) is not a text file.") from error

    listed: dict[str, Moment] = {}
    is_first = True
    for number, line in enumerate(lines, 1):
        line = line.strip()
        if not line or line.startswith(("#", "//")):
            continue
        parts = (
            re.split(r"[,;\t]", line, maxsplit=2)
            if re.search(r"[,;\t]", line)
            else line.split(None, 1)
        )
        name, time = (part.strip().strip("\"' ") for part in (*parts, "")[:2])
        moment = _parse_time(time)
        may_be_header, is_first = is_first, False
        if moment is None and may_be_header and not re.search(r"\d", time) and time:
            continue
        if moment is None or not name:
            raise InputError(
                f"'{path}', line {number}: expected a scan's name and a time (days, or a date "
                f"such as 2020-03-08), found '{line[:60]}'."
            )
        if name in listed:
            raise InputError(f"'{path}', line {number}: '{name}' has a time already.")
        listed[name] = moment
    return listed


def _parse_time(text: str) -> Moment | None:
    if len(text) > LONGEST:  # which the patterns would try at length
        return None
    if match := _DATE.fullmatch(text):
        return _date_of(match)
    if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)", text):
        return _day(float(text))
    return None
