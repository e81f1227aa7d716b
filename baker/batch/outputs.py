"""What a bake writes, and whether it can be written."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from baker.errors import InputError


@dataclass(frozen=True)
class Outputs:
    """What to write, and how."""

    clip: Path  # the file; of many plants the folder of their clips
    report: Path | None = None  # a folder where there are many plants
    traits: Path | None = None
    cluster: str | None = None  # address of a dask scheduler; by default this machine works alone
    # by default long bakes keep their intervals beside the clip until that is written
    cache: Path | None = None
    force: bool = False  # of many plants, bake those again whose clips are up to date, too
    quiet: bool = False
    verbose: bool = False


def check_output(path: Path, what: str, *suffixes: str) -> None:
    """Raise InputError where a file can't be written, before the work and not after it."""
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{path}: {what}'s name ends in {suffixes[0]}.")
    if path.is_dir():
        raise InputError(f"{path} is a folder; a file's name is needed.")
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist.")
