"""Outputs that appear whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from player.errors import PlayerError


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A temporary file beside `path`, renamed to it when the work is done, else removed."""
    with whole_folder(path) as folder:
        part = folder / path.name
        yield part
        os.replace(part, path)


@contextmanager
def made_folder(folder: Path) -> Iterator[None]:
    """`folder`, made where only itself is missing, and removed again if the work in it fails."""
    missing = not folder.exists()
    if missing and folder.parent.is_dir():
        try:
            folder.mkdir()
        except OSError as error:
            raise PlayerError(f"{folder} can't be made: {error.strerror or error}.") from None
    try:
        yield
    except BaseException:
        if missing and folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()
        raise


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """A temporary folder beside `path`, removed in the end with what is left in it.

    Raises PlayerError where that folder can't be written to.
    """
    check_folder(path)
    try:
        folder = Path(tempfile.mkdtemp(prefix=f".{path.name}.", dir=path.parent))
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    except OSError as error:
        raise PlayerError(f"{path} can't be written: {error.strerror or error}.") from None


@contextmanager
def whole_sequence(path: Path) -> Iterator[Callable[[int], Path]]:
    """Where to write the numbered files of `path`, like %04d.png: all appear once all are done.

    The folder they go to is made if only itself is missing.
    """
    with made_folder(path.parent), whole_folder(path) as folder:
        names: list[str] = []

        def file(number: int) -> Path:
            names.append(path.name % number)
            return folder / names[-1]

        yield file
        for name in names:
            os.replace(folder / name, path.parent / name)


def check_folder(path: Path) -> None:
    """Raise PlayerError where the folder of `path` is missing."""
    if not path.parent.is_dir():
        raise PlayerError(f"{path}: the folder {path.parent} does not exist.")
