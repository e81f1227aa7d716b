"""Order scans by time: from a file with the times, from their names, or in the order given.

Times in names are those of the files or, where these have none, of the folders that they are in
(`baker.scans.times.names`). Where only some have a time, scans are numbered 0, 1, 2, ... in the
natural order of the names in a folder (9 before 10), or in the order of a list of files.
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
    has_time,
    moments_from_file,
    moments_from_list,
    read_times,
)
from gclip.text import printable

MAX_ABS_TIME = 1e12  # days
MIN_TIME_STEP = 1e-9  # days between two scans
FOLDER_LEVELS = 4  # folders above a scan whose names may contain its time
MAX_LISTED_NAMES = 12  # of scans, in the finding about their order


def schedule_scans(
    paths: Sequence[Path],
    times_file: Path | None = None,
    times: Sequence[object] | None = None,
    from_folder: bool = False,
) -> Series:
    """Order and time scans, which are not read yet, by the first rule that fits all of them.

    The rules are: the `times` given in Python; the times file; the times in names; the natural
    order of the names if the paths are `from_folder`, and otherwise the order of the paths. Raises
    InputError if two scans have the same time, the times file is wrong or misses a scan, or the
    order of numbered names is ambiguous.
    """
    parts = [path.resolve().parts for path in paths]
    names = [path.name for path in paths]
    for level in range(2, max(map(len, parts)) + 1):
        if len(set(names)) < len(names):  # only their folders differ: 2020-03-08/scan.ply
            names = ["/".join(path_parts[-level:]) for path_parts in parts]
    doubt = ""
    if times is not None:
        moments, rule = moments_from_list(times, names), "as given"
    elif times_file is not None:
        moments, rule = moments_from_file(times_file, names), f"from '{times_file.name}'"
    elif reading := _times_in_names(paths):
        moments, rule = list(reading.moments), f"from the {reading.convention.kind} in the names"
        doubt = reading.doubt
    else:
        return _in_order(paths, names, from_folder)
    return schedule_in_time(paths, names, moments, rule, doubt, from_folder)


def natural_key(name: str) -> list[tuple[int, int, str]]:
    """Make a sort key that compares digits in names as numbers: scan9 comes before scan10."""
    parts = re.findall(r"\d+|\D+", name)
    return [(0, int(p), p) if p.isdecimal() else (1, 0, p.lower()) for p in parts]


def _times_in_names(paths: Sequence[Path]) -> Reading | None:
    """Read the times in the names of the files, or of the folders at a level above them.

    A clear time in a folder's name is preferred to numbers in the files' names.
    """
    names = ((path.stem, *(folder.name for folder in path.resolve().parents)) for path in paths)
    levels = islice(zip(*names, strict=False), FOLDER_LEVELS + 1)
    readings = [(read, level) for level, texts in enumerate(levels) if (read := read_times(texts))]
    return min(
        (read for read, level in readings if read.are_distinct or level == 0),
        key=lambda read: (not read.are_distinct, not read.convention.is_clear),
        default=None,
    )


def names_without_times(stems: Sequence[str]) -> list[str]:
    """Replace the time in each name by a star; names of one series are then equal.

    A suffix after the time is left out if only some names have it, as published series mark
    annotated scans (``M01_0313_a``, ``M01_0314``).
    """
    reading = read_times(stems)
    if reading is None:
        return list(stems)
    parts = [(stem[:a], stem[b:]) for stem, (a, b) in zip(stems, reading.spans, strict=True)]
    rests = sorted({rest for _, rest in parts}, key=len)
    if len(rests) == 2 and rests[1].startswith(rests[0]):
        return [f"{before}*" for before, _ in parts]
    return [f"{before}*{rest}" for before, rest in parts]


def schedule_in_time(
    paths: Sequence[Path],
    names: Sequence[str],
    moments: Sequence[Moment],
    rule: str,
    doubt: str = "",
    from_folder: bool = True,
) -> Series:
    """Order scans, which are not read yet, by their moments; InputError if two are equal.

    rule: where the moments come from, for the finding and for messages.
    """
    scans = [
        Scan(np.empty((0, 3)), path=path, name=printable(name), time=moment.time, date=moment.date)
        for path, name, moment in zip(paths, names, moments, strict=True)
    ]
    for scan in scans:
        if not abs(scan.time) <= MAX_ABS_TIME:
            raise InputError(
                f"'{scan.name}' has the time {scan.date} ({rule}); days from "
                f"{-MAX_ABS_TIME:g} to {MAX_ABS_TIME:g} are possible."
            )
    ordered = sorted(scans, key=lambda scan: scan.time)
    for before, after in pairwise(ordered):
        if (step := after.time - before.time) < MIN_TIME_STEP:
            raise InputError(
                f"'{before.name}' and '{after.name}' have {'nearly ' * (step > 0)}the same time, "
                f"{after.date} ({rule}); give one scan for each moment, or say the times with "
                "--times FILE."
            )
    rule = f"{ordered[0].date} to {ordered[-1].date}, {rule}"
    if not from_folder and [scan.path for scan in ordered] != [*paths]:
        rule += "; in the order of time, not in the order given"
    if all(moment.dated for moment in moments):  # days since the first scan: the plant's age
        ordered = [replace(scan, time=scan.time - ordered[0].time) for scan in ordered]
    return Series(tuple(ordered), findings=(Finding("days", rule, doubt, "--times FILE"),))


def _in_order(paths: Sequence[Path], names: Sequence[str], from_folder: bool) -> Series:
    """Number the scans: in the natural order of names if a folder or a shell has listed them."""
    stems = [name.rpartition(".")[0] for name in names]
    natural = sorted(range(len(names)), key=lambda i: natural_key(stems[i]))
    order, rule = [*range(len(names))], "the order given"
    # A shell expands * to scan10 before scan9, an order that nobody chooses.
    if from_folder or (list(names) == sorted(names) and natural != order):
        order, rule = natural, "the natural order of their names"
        numbers = [[int(number) for number in re.findall(r"\d+", stem)] for stem in stems]
        for i, j in pairwise(order):
            if any(a > b for a, b in zip(numbers[i], numbers[j], strict=False)):
                raise InputError(
                    f"The order of '{names[i]}' and '{names[j]}' can't be told from their names; "
                    "give it by --times FILE, with dates such as 2020-03-08 in the names, or by "
                    "naming the files in order."
                )
    moments = [Moment(float(k), str(k)) for k in range(len(names))]
    series = schedule_in_time([paths[i] for i in order], [names[i] for i in order], moments, rule)
    untimed = [name for name, stem in zip(names, stems, strict=True) if not has_time(stem)]
    is_mixed = 0 < len(untimed) < len(names)
    reason = f"no time in the name '{untimed[0]}'" if is_mixed else "no times in the names"
    doubt = f"{reason}, so growth rates will be per scan and not per day"
    listed = [scan.name for scan in series.scans[:MAX_LISTED_NAMES]] + ["..."]
    description = f"{rule}: {', '.join(listed[: len(names)])}"
    finding = Finding("order", description, doubt, "--times FILE")
    return replace(series, unit="scans", findings=(finding,))
