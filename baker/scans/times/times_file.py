"""Times of scans as they are given: from a file (`--times FILE`), or as a list in Python."""

import re
from collections.abc import Sequence
from pathlib import Path

from baker.errors import InputError
from baker.scans.times.conventions import Moment, parse_date
from baker.scans.times.names import read_times

MAX_TIME_CHARACTERS = 100
MAX_FILE_BYTES = 1 << 24


def moments_from_file(path: Path, names: Sequence[str]) -> list[Moment]:
    """The time of each of `names`, looked up by the name with or without folder and suffix."""
    listed = _moments(path, _read_times(path))
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


def _parse(texts: Sequence[str]) -> list[Moment | None]:
    """Days and ISO dates as they stand; else the times as they are read from names."""
    moments = [_parse_time(text) for text in texts]
    if None in moments and (reading := read_times([text[:MAX_TIME_CHARACTERS] for text in texts])):
        return list(reading.moments)
    return moments


def _moments(path: Path, listed: dict[str, tuple[int, str]]) -> dict[str, Moment]:
    moments = _parse([text for _, text in listed.values()])
    for (number, text), moment in zip(listed.values(), moments, strict=True):
        if moment is None:
            raise InputError(
                f"'{path}', line {number}: expected a scan's name and a time (days, or a date "
                f"such as 2020-03-08), found the time '{text[:60]}'."
            )
    return {name: moment for name, moment in zip(listed, moments, strict=True) if moment}


def _read_times(path: Path) -> dict[str, tuple[int, str]]:
    """The line and the text of each name's time."""
    listed: dict[str, tuple[int, str]] = {}
    lines = [(number, line.strip()) for number, line in enumerate(_read_lines(path), 1)]
    rows = [(n, line) for n, line in lines if line and not line.startswith(("#", "//"))]
    for number, line in rows:
        parts = re.split(r"[,;\t]", line, maxsplit=2)
        parts = parts if len(parts) > 1 else [*line.split(None, 1), ""]
        name, time = (part.strip().strip("\"' ") for part in parts[:2])
        if number == rows[0][0] and time and not re.search(r"\d", time):
            continue  # a header
        if not time or not name:
            raise InputError(
                f"'{path}', line {number}: expected a scan's name and a time, found '{line[:60]}'."
            )
        if name in listed:
            raise InputError(f"'{path}', line {number}: '{name}' has a time already.")
        listed[name] = number, time
    return listed


def _read_lines(path: Path) -> list[str]:
    try:
        if path.is_fifo() or path.is_char_device():
            raise InputError(f"'{path}' (times) is not a regular file.")
        if (size := path.stat().st_size) > MAX_FILE_BYTES:
            raise InputError(
                f"'{path}' (times) holds {size} bytes; a list of times has {MAX_FILE_BYTES} at "
                "most."
            )
        return path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise InputError(f"'{path}' (times) can't be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"'{path}' (times) is not a text file.") from error


def _parse_time(text: str) -> Moment | None:
    if len(text) > MAX_TIME_CHARACTERS:  # which the patterns would try at length
        return None
    date = parse_date(text)
    if date is None and re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)", text):
        return Moment(float(text), f"day {float(text):.10g}")
    return date
