"""What a bake writes, and whether it can be written."""

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from baker.errors import InputError
from baker.options import option
from gclip.terminal import atomic


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
    force: bool = option(False, "Overwrite what exists; of many plants, bake all again.")
    quiet: bool = option(False, "Say nothing but errors.", short=["-q"])
    verbose: bool = option(False, "Say what was found in each scan.", short=["-v"])


def check_output(path: Path | None, force: bool, what: str, *suffixes: str) -> None:
    """Raise UserError where a file, if it is wanted, can't be written or would be overwritten."""
    if path is None:
        return
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{path}: the name of {what} ends in {suffixes[0]}.")
    atomic.check_output(path, force)


def check_apart(table: Path, inputs: Iterable[Path]) -> None:
    """Raise InputError where a table would replace an input, or be a scan of the next bake."""
    for given in inputs:
        place = table.parent if given.is_dir() else table
        if place.exists() and given.exists() and place.samefile(given):
            raise InputError(f"{table} is among the inputs; write it elsewhere.")


def check_cache(outputs: Outputs) -> None:
    """Raise InputError where the cache's folder would stand where a file is to be written."""
    if outputs.cache is None:
        return
    folder = Path(os.path.realpath(outputs.cache))  # resolve() fails where links form a loop
    for path in filter(None, (outputs.clip, outputs.report, outputs.traits)):
        if Path(os.path.realpath(path)) in (folder, *folder.parents):
            raise InputError(f"--cache {outputs.cache}: {path} is to be a file; name a folder.")
