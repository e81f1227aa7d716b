"""Outputs that appear whole or not at all: written in a folder beside the place, then renamed.

Errors and stops remove that folder, `.NAME.xxxxxxxx.part`; that of a killed process stays.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from gclip.errors import UserError


def check_output(path: Path, force: bool) -> None:
    """Raise UserError where a file can't be written, or is there already and `force` is not given:
    before the work and not after it.
    """
    if path.is_dir():
        raise UserError(f"{path} is a folder; a file's name is needed.")
    if path.parent.exists() and not path.parent.is_dir():
        raise UserError(f"{path}: {path.parent} is a file, not a folder.")
    if not path.parent.exists():
        raise UserError(f"{path}: the folder {path.parent} does not exist.")
    check_writable(path.parent)
    if path.exists() and not force:
        raise UserError(f"{path} exists; --force overwrites it.")


def check_writable(folder: Path) -> None:
    """Raise UserError where nothing can be written into a folder."""
    if not os.access(folder, os.W_OK):
        raise UserError(f"{folder}: permission denied to write into this folder.")


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Write `path`: what the file system refuses is a UserError that names it."""
    try:
        yield
    except OSError as error:
        raise UserError(f"{path} can't be written: {error.strerror or error}.") from None


@contextmanager
def folder_beside(path: Path) -> Iterator[Path]:
    """A temporary folder on the file system of `path`, removed in the end. Raises OSError."""
    name = f".{path.name[:40]}."  # that folder's has 255 bytes at most, too
    with TemporaryDirectory(".part", name, path.parent, ignore_cleanup_errors=True) as folder:
        yield Path(folder)


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """A file to write, named alike, which takes the place of `path` when all went well.

    Raises OSError if it can't be written; `path` is then as it was.
    """
    with folder_beside(path) as folder:
        part = folder / path.name
        yield part
        sync(part)
        umask = os.umask(0)
        os.umask(umask)
        part.chmod(0o666 & ~umask)  # whatever the library that wrote it thinks
        os.replace(part, path)


def sync(part: Path) -> None:
    """Have a file's bytes on the disk, so that a power cut can't come between them and its name."""
    with part.open("r+b") as written:
        os.fsync(written.fileno())
