"""Times of scans from a file (`--times FILE`): a line ``name time`` for each scan."""

from __future__ import annotations

import re
import stat
from collections.abc import Sequence
from pathlib import Path

from baker.errors import InputError
from baker.scans.times.conventions import Moment, parse_date

MAX_TIME_CHARACTERS = 100
MAX_FILE_BYTES = 1 << 24


def moments_from_file(path: Path, names: Sequence[str]) -> list[Moment]:
    """The time of each of `names`, looked up by the name with or without folder and suffix."""
    listed = _read_times(path)
    moments = []
    for name in names:
        plain = name.rpartition("/")[2]
        keys = (name, name.rpartition(".")[0], plain, plain.rpartition(".")[0])
        moment = next((listed[key] for key in keys if key in listed), None)
        if moment is None:
            raise InputError(f"'{path}' has no line for the scan '{name}'.")
        moments.append(moment)
    if len({moment.dated for moment in moments}) > 1:
        raise InputError(f"'{path}' mixes dates and numbers of days; use one of them throughout.")
    return moments


def _read_times(path: Path) -> dict[str, Moment]:
    listed: dict[str, Moment] = {}
    is_first = True
    for number, line in enumerate(_read_lines(path), 1):
        line = line.strip()
        if not line or line.startswith(("#", "//")):
            continue
        parts = re.split(r"[,;\t]", line, maxsplit=2)
        parts = parts if len(parts) > 1 else [*line.split(None, 1), ""]
        name, time = (part.strip().strip("\"' ") for part in parts[:2])
        moment = _parse_time(time)
        is_header = is_first and time and not re.search(r"\d", time)
        is_first = False
        if is_header:
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


def _read_lines(path: Path) -> list[str]:
    try:
        state = path.stat()
        if stat.S_ISFIFO(state.st_mode) or stat.S_ISCHR(state.st_mode):
            raise InputError(f"'{path}' (times) is not a regular file.")
        if state.st_size > MAX_FILE_BYTES:
            raise InputError(
                f"'{path}' (times) holds {state.st_size} bytes; a list of times has "
                f"{MAX_FILE_BYTES} at most."
            )
        return path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise InputError(f"'{path}' (times) can't be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"'{path}' (times) is not a text file.") from error


def _parse_time(text: str) -> Moment | None:
    if len(text) > MAX_TIME_CHARACTERS:  # which the patterns would try at length
        return None
    if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)", text) and not parse_date(text):
        return Moment(float(text), f"day {float(text):.10g}")
    return parse_date(text)
