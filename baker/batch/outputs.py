"""What a bake writes, and whether it can be written."""

import os
from dataclasses import dataclass
from pathlib import Path

from baker.errors import InputError
from baker.options import option


def parse_folder(text: str) -> Path:
    """Not the folder one happens to be in, where a variable of the shell was empty."""
    if not text:
        raise InputError("--cache has no name of a folder.")
    return Path(text)


@dataclass(frozen=True)
class Outputs:
    """What to write, and how, in the words of `bake --help`.

    Without a cache long bakes keep their intervals beside the clip until that is written.
    """

    clip: Path  # the file; of many plants the folder of their clips
    report: Path | None = option(
        None, "Write a report with pictures; of many plants, a folder of them.", metavar="OUT.html"
    )
    traits: Path | None = option(
        None, "Write a table of lengths, areas, angles and growth.", metavar="OUT.csv"
    )
    cluster: str | None = option(
        None, "Bake on many machines: the address of a dask scheduler.", metavar="ADDRESS"
    )
    cache: Path | None = option(
        None,
        "Keep finished work there, and take up what is kept.",
        parser=parse_folder,
        metavar="DIR",
    )
    force: bool = option(False, "Of many plants, bake those again whose clips are up to date, too.")
    quiet: bool = option(False, "Say nothing but errors.", short=["-q"])
    verbose: bool = option(False, "Say what was found in each scan.", short=["-v"])


def check_output(path: Path, what: str, *suffixes: str) -> None:
    """Raise InputError where a file can't be written, before the work and not after it."""
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{path}: {what}'s name ends in {suffixes[0]}.")
    if path.is_dir():
        raise InputError(f"{path} is a folder; a file's name is needed.")
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist.")
    check_writable(path.parent)


def check_writable(folder: Path) -> None:
    """Raise InputError where nothing can be written into a folder."""
    if not os.access(folder, os.W_OK):
        raise InputError(f"{folder}: permission denied to write into this folder.")
