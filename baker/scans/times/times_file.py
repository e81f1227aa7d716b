"""Times of scans as they are given: from a file (`--times FILE`), or as a list in Python."""

import re
from collections.abc import Sequence
from pathlib import Path

from baker.errors import InputError, asking
from baker.scans.times.conventions import Moment, parse_date
from baker.scans.times.names import read_times

MAX_TIME_CHARACTERS = 100
MAX_FILE_BYTES = 1 << 24


def moments_from_file(path: Path, names: Sequence[str]) -> list[Moment]:
    """The time of each of `names`, looked up by the name with or without folder and suffix."""
    rows = _rows(path)
    times = _parse([time for _, _, time in rows])
    listed: dict[str, Moment] = {}
    for (number, name, text), time in zip(rows, times, strict=True):
        if time is None:
            raise InputError(
                f"'{path}', line {number}: expected a scan's name and a time (days, or a date "
                f"such as 2020-03-08), found the time '{text[:60]}'."
            )
        if listed.setdefault(name, time) is not time:
            raise InputError(f"'{path}', line {number}: '{name}' has a time already.")
    moments = []
    for name in names:
        plain = name.rpartition("/")[2]
        keys = (name, name.rpartition(".")[0], plain, plain.rpartition(".")[0])
        moment = next((listed[key] for key in keys if key in listed), None)
        if moment is None:
            raise InputError(f"'{path}' has no line for the scan '{name}'.")
        moments.append(moment)
    return _of_one_kind(moments, f"'{path}'")


def moments_from_list(times: Sequence[object], names: Sequence[str]) -> list[Moment]:
    """The time of each of `names`: numbers of days, dates of `datetime`, or texts as in a file."""
    if len(times) != len(names):
        raise InputError(f"times holds {len(times)} times for {len(names)} scans.")
    found = []
    for time, moment in zip(times, _parse([str(time) for time in times]), strict=True):
        if moment is None:
            raise InputError(f"times holds {time!r}; a number of days or a date is needed.")
        found.append(moment)
    return _of_one_kind(found, "times")


def _of_one_kind(moments: list[Moment], source: str) -> list[Moment]:
    if len({moment.dated for moment in moments}) > 1:
        raise InputError(f"{source} mixes dates and numbers of days; use one of them throughout.")
    return moments


def _rows(path: Path) -> list[tuple[int, str, str]]:
    """Number of the line, name and time, of each line that is no comment and no header."""
    try:
        with asking(path):
            if path.exists() and not path.is_file():
                raise InputError(f"'{path}' is not a regular file.")
            if (size := path.stat().st_size) > MAX_FILE_BYTES:
                most = f"a list of times has {MAX_FILE_BYTES} at most"
                raise InputError(f"'{path}' holds {size} bytes; {most}.")
            lines = map(str.strip, path.read_text(encoding="utf-8-sig").splitlines())
    except UnicodeDecodeError as error:
        raise InputError(f"'{path}' is not a text file.") from error
    rows: list[tuple[int, str, str]] = []
    for number, line in enumerate(lines, 1):
        if not line or line.startswith(("#", "//")):
            continue
        parts = re.split(r"[,;\t]", line, maxsplit=2)
        parts = parts if len(parts) > 1 else [*line.split(None, 1), ""]
        name, time = (part.strip().strip("\"' ") for part in parts[:2])
        if not time or not name:
            raise InputError(
                f"'{path}', line {number}: expected a scan's name and a time, found '{line[:60]}'."
            )
        rows.append((number, name, time))
    return rows[1:] if rows and not re.search(r"\d", rows[0][2]) else rows


def _parse(texts: Sequence[str]) -> list[Moment | None]:
    """Days and ISO dates as they stand; else the times as they are read from names."""
    moments = [_parse_time(text) for text in texts]
    if None in moments and (reading := read_times([text[:MAX_TIME_CHARACTERS] for text in texts])):
        return list(reading.moments)
    return moments


def _parse_time(text: str) -> Moment | None:
    if len(text) > MAX_TIME_CHARACTERS:  # which the patterns would try at length
        return None
    date = parse_date(text)
    if date is None and re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)", text):
        return Moment(float(text), f"day {float(text):.10g}")
    return date
