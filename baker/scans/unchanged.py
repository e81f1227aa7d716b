"""What a scan was read from: its files' digest, and that they did not change meanwhile."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from baker.errors import InputError

Found = TypeVar("Found")


def digest(paths: Sequence[Path]) -> str:
    """SHA-256 over the bytes of all files a scan is read from, one after the other.

    Raises InputError where one can't be read.
    """
    found = hashlib.sha256()
    for path in paths:
        try:
            with path.open("rb") as file:
                hashlib.file_digest(file, lambda: found)
        except OSError as error:
            raise _unreadable(path, error) from None
    return found.hexdigest()


def read_unchanged(paths: Sequence[Path], read: Callable[[], Found]) -> tuple[Found, str]:
    """What `read` makes of these files, and their digest.

    Raises InputError where they can't be read, or are not the same before and after.
    """
    before = _states(paths)
    try:
        found = read()
        name = digest(paths)
    except (InputError, OSError) as error:
        if _states(paths) != before:  # what was wrong with it may be only that
            raise _changed(paths) from None
        raise _unreadable(paths[0], error) if isinstance(error, OSError) else error from None
    if _states(paths) != before:
        raise _changed(paths)
    return found, name


def _states(paths: Sequence[Path]) -> list[tuple[int, ...]]:
    states: list[tuple[int, ...]] = []
    for path in paths:
        try:
            state = os.stat(path)
        except OSError as error:
            raise _unreadable(path, error) from None
        states.append((state.st_dev, state.st_ino, state.st_size, state.st_mtime_ns))
    return states


def _changed(paths: Sequence[Path]) -> InputError:
    return InputError(f"'{paths[0]}' changed while it was read; bake again when it is complete.")


def _unreadable(path: Path, error: OSError) -> InputError:
    return InputError(f"'{path}' can't be read: {error.strerror or error}.")
