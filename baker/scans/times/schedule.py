"""The order and the times of scans: from a file with the times, from their names, or as given.

A rule counts only if it fits every scan. The first that does is used:

1. ``--times FILE``: a line ``name time`` for each scan, the time a number of days or an ISO date or
   date-time (``2020-03-08``, ``2020-03-08T14:30``).
2. Dates or numbers of days, weeks or hours in the names; where these have none, in the names of the
   folders that the scans are in (`baker.scans.times.names`).
3. The order: 0, 1, 2, ..., natural (9 before 10) in a folder, as given for a list of files.
"""

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice, pairwise
from pathlib import Path

import numpy as np

from baker.errors import InputError
from baker.scans.scan import Finding, Scan, Series
from baker.scans.times.conventions import Moment
from baker.scans.times.names import (
    Reading,
    find_time,
    moments_from_file,
    moments_from_list,
    read_times,
)
from gclip.text import printable

MAX_ABS_TIME = 1e12  # days
MIN_TIME_STEP = 1e-9  # days between two scans
FOLDER_LEVELS = 4  # folders above a scan whose names may hold its time
MAX_LISTED_NAMES = 12  # of scans whose order is told by name


def schedule_scans(
    paths: Sequence[Path],
    times_file: Path | None = None,
    times: Sequence[object] | None = None,
    from_folder: bool = False,
) -> Series:
    """Order and time the scans by the first rule that fits them all; none is read yet.

    times: one for each scan, as given in Python; none are looked for then. from_folder: nobody gave
    the scans in an order.

    Raises InputError: two scans at one time, a times file that can't be read or misses a scan,
    numbered names whose order can't be told.
    """
    parts = [path.resolve().parts for path in paths]
    names = [path.name for path in paths]
    for level in range(2, max(map(len, parts)) + 1):
        if len(set(names)) < len(names):  # the folders tell them apart: 2020-03-08/scan.ply
            names = ["/".join(own[-level:]) for own in parts]
    moments: Sequence[Moment]
    doubt = ""
    if times is not None:
        moments, rule = moments_from_list(times, names), "as given"
    elif times_file is not None:
        moments, rule = moments_from_file(times_file, names), f"from '{times_file.name}'"
    else:
        reading, level = _times_in_names(paths)
        if reading is None:
            return _in_order(paths, names, from_folder)
        where = "folders' names" if level else "names"
        rule = f"from the {reading.convention.what} in the {where}"
        moments, doubt = reading.moments, reading.doubt
    return schedule_in_time(paths, names, moments, rule, doubt, from_folder)


def natural_key(name: str) -> list[tuple[int, int, str]]:
    """A sort key in which the numbers of a name count as numbers: scan9 comes before scan10."""
    parts = re.findall(r"\d+|\D+", name)
    return [(0, int(p), p) if p.isdecimal() else (1, 0, p.lower()) for p in parts]


def _times_in_names(paths: Sequence[Path]) -> tuple[Reading | None, int]:
    """The times in the names of the files (level 0), or of the folders so many levels above them.

    A clearly written time in a folder's name is preferred to mere numbers in the files' names.
    """
    names = ((path.stem, *(above.name for above in path.resolve().parents)) for path in paths)
    levels = islice(zip(*names, strict=False), FOLDER_LEVELS + 1)
    found = [(read, level) for level, texts in enumerate(levels) if (read := read_times(texts))]
    return min(
        ((read, level) for read, level in found if read.distinct or level == 0),
        key=lambda found: (not found[0].distinct, not found[0].convention.is_clear),
        default=(None, 0),
    )


def names_without_times(stems: Sequence[str]) -> list[str]:
    """The names with a star for the time, which tell whether they belong to one series.

    What follows the time is left out where some names have it and others a part of it or nothing:
    published series mark annotated scans so (``M01_0313_a``, ``M01_0314``).
    """
    reading = read_times(stems)
    spans: Sequence[tuple[int, int]] = reading.spans if reading and reading.distinct else ()
    if not spans:
        found = ((stem, find_time(stem)) for stem in stems)
        spans = [time.span() if time else (len(stem), len(stem)) for stem, time in found]
    parts = [(stem[:a], "*" * (b > a), stem[b:]) for stem, (a, b) in zip(stems, spans, strict=True)]
    rests = {rest for _, _, rest in parts}
    shorter, longer = min(rests, key=len), max(rests, key=len)
    if all(star for _, star, _ in parts) and len(rests) == 2 and longer.startswith(shorter):
        parts = [(before, star, "") for before, star, _ in parts]
    return ["".join(part) for part in parts]


def schedule_in_time(
    paths: Sequence[Path],
    names: Sequence[str],
    moments: Sequence[Moment],
    rule: str,
    doubt: str = "",
    from_folder: bool = True,
) -> Series:
    """The scans at these moments, unread. Raises InputError where two have the same.

    rule: how the moments were found; the first and the last are added.
    """
    scans = list(map(_unread, paths, names, moments))
    for scan in scans:
        if not abs(scan.time) <= MAX_ABS_TIME:
            raise InputError(
                f"'{scan.name}' has the time {scan.date} ({rule}); days from "
                f"{-MAX_ABS_TIME:g} to {MAX_ABS_TIME:g} are possible."
            )
    ordered = sorted(scans, key=lambda scan: scan.time)
    for before, after in pairwise(ordered):
        step, both = after.time - before.time, f"'{before.name}' and '{after.name}'"
        if step == 0:
            raise InputError(
                f"{both} have the same time, {after.date} ({rule}); give one scan for each "
                "moment, or say the times with --times FILE."
            )
        if step < MIN_TIME_STEP:
            least = f"{MIN_TIME_STEP:g} days have to lie between two scans"
            raise InputError(f"{both} have nearly the same time ({rule}); {least}.")
    rule = f"{ordered[0].date} to {ordered[-1].date}, {rule}"
    if not from_folder and [scan.path for scan in ordered] != [*paths]:
        rule += "; in the order of time, not in the order given"
    if all(moment.dated for moment in moments):  # days since the first scan: the plant's age
        ordered = [replace(scan, time=scan.time - ordered[0].time) for scan in ordered]
    return Series(tuple(ordered), findings=(Finding("days", rule, doubt, "--times FILE"),))


def _unread(path: Path, name: str, moment: Moment) -> Scan:
    name, nothing = printable(name), np.empty((0, 3))
    return Scan(nothing, path=path, name=name, time=moment.time, date=moment.date)


def _in_order(paths: Sequence[Path], names: Sequence[str], from_folder: bool) -> Series:
    natural = sorted(range(len(names)), key=lambda i: natural_key(names[i].rpartition(".")[0]))
    order: Sequence[int] = range(len(names))
    how = "the order given"
    # A shell's * lists scan10 before scan9: nobody means that order.
    if from_folder or (list(names) == sorted(names) and natural != list(order)):
        _require_clear_order([names[i] for i in natural])
        order, how = natural, "the natural order of their names"
    scans = [_unread(paths[i], names[i], Moment(float(k), str(k))) for k, i in enumerate(order)]
    untimed = [name for name in names if find_time(name.rpartition(".")[0]) is None]
    is_mixed = 0 < len(untimed) < len(names)
    why = f"no time in the name '{untimed[0]}'" if is_mixed else "no times in the names"
    doubt = f"{why}, so growth rates will be per scan and not per day"
    listed = [scan.name for scan in scans[:MAX_LISTED_NAMES]] + ["..."]
    found = f"{how}: {', '.join(listed[: len(scans)])}"
    return Series(tuple(scans), "scans", findings=(Finding("order", found, doubt, "--times FILE"),))


def _require_clear_order(names: Sequence[str]) -> None:
    """Numbers at the same place of the names must all grow together, else which one is time?"""
    for names_of_two in pairwise(names):
        before, after = (
            [int(number) for number in re.findall(r"\d+", name.rpartition(".")[0])]
            for name in names_of_two
        )
        if any(a > b for a, b in zip(before, after, strict=False)):
            raise InputError(
                "The order of '{}' and '{}' can't be told from their names; say it with --times "
                "FILE, with dates such as 2020-03-08 in the names, or by naming the files in "
                "order.".format(*names_of_two)
            )
