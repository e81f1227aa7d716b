"""The output files of a bake, and checks whether they can be written."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from baker.errors import InputError
from baker.options import option
from gclip.terminal import atomic


def parse_folder(text: str) -> Path:
    """The argument of --cache as a path."""
    if not text:  # an empty shell variable, which would mean the working directory
        raise InputError("--cache has no name of a folder.")
    return Path(text)


@dataclass(frozen=True)
class Outputs:
    """What to write, and how; the fields other than `clip` are options of `bake`."""

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


def check_output(path: Path | None, force: bool, kind: str, *suffixes: str) -> None:
    """Raise UserError if a file, "a clip" for example, has a wrong suffix or can't be written."""
    if path is None:
        return
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{path}: the name of {kind} ends in {suffixes[0]}.")
    atomic.check_output(path, force)


def check_not_input(table: Path, inputs: Iterable[Path]) -> None:
    """Raise InputError if a table would replace an input, or be in a folder of scans."""
    for path in inputs:
        same = table.parent if path.is_dir() else table
        if same.exists() and path.exists() and same.samefile(path):
            raise InputError(f"{table} is among the inputs; write it elsewhere.")
