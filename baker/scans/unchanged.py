"""What a scan was read from: its files' digest, and that they did not change meanwhile."""

import hashlib
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from baker.errors import InputError, asking

Found = TypeVar("Found")


def digest(paths: Sequence[Path]) -> str:
    """SHA-256 over the bytes of all files a scan is read from, one after the other.

    Raises InputError where one can't be read.
    """
    found = hashlib.sha256()
    for path in paths:
        with asking(path), path.open("rb") as file:
            hashlib.file_digest(file, lambda: found)
    return found.hexdigest()


def read_unchanged(paths: Sequence[Path], read: Callable[[], Found]) -> tuple[Found, str]:
    """What `read` makes of these files, and their digest.

    Raises InputError where they can't be read, or are not the same before and after.
    """
    before = _states(paths)
    try:
        with asking(paths[0]):
            return read(), digest(paths)
    finally:  # also after a fault, which may be only that
        if _states(paths) != before:
            changed = f"'{paths[0]}' changed while it was read; bake again when it is complete."
            raise InputError(changed) from None


def _states(paths: Sequence[Path]) -> list[tuple[int, ...]]:
    with asking(paths[0]):
        return [(s.st_dev, s.st_ino, s.st_size, s.st_mtime_ns) for s in map(os.stat, paths)]
