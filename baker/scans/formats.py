"""The formats that can be read: the one registry, by suffix.

To add a format, write a module with a function ``read(path: Path) -> Columns`` and name it here.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from baker.errors import InputError
from baker.scans.cloud import Columns

READERS = {
    ".ply": "baker.scans.ply",
    ".pcd": "baker.scans.pcd",
    ".xyz": "baker.scans.table",
    ".txt": "baker.scans.table",
    ".csv": "baker.scans.table",
    ".asc": "baker.scans.table",
    ".pts": "baker.scans.table",
    ".las": "baker.scans.las",
    ".laz": "baker.scans.las",
}
SUFFIXES = tuple(READERS)


def require_known(path: Path) -> None:
    """InputError, with the known suffixes, unless the suffix of `path` (any case) is known."""
    if path.suffix.lower() not in READERS:
        what = f"has the unknown suffix '{path.suffix}'" if path.suffix else "has no suffix"
        raise InputError(f"'{path}' {what}; known are {', '.join(SUFFIXES)}.")


def read_columns(path: Path) -> Columns:
    """All numeric fields of the scan at `path`.

    Raises InputError if the suffix is unknown, or if the file can't be opened or is not sound.
    """
    require_known(path)
    try:
        if path.stat().st_size == 0:
            raise InputError(f"'{path}' is an empty file.")
        return import_module(READERS[path.suffix.lower()]).read(path)
    except OSError as error:
        raise InputError(f"'{path}' can't be read: {error.strerror or error}.") from error
