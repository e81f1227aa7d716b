"""Write files atomically: in a temporary folder next to their path, then renamed.

The folder, `.NAME.xxxxxxxx.part`, is removed even after an error or Ctrl-C, but not if the process
is killed.
"""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from gclip.errors import UserError


def check_output(path: Path, force: bool) -> None:
    """Raise UserError if a file can't be written, or exists and `force` is not given."""
    folder = path.parent
    if path.is_dir():
        raise UserError(f"{path} is a folder; a file's name is needed.")
    if not folder.is_dir():
        problem = "is a file, not a folder" if folder.exists() else "does not exist"
        raise UserError(f"{path}: {folder} {problem}.")
    if not os.access(folder, os.W_OK):
        raise UserError(f"{folder}: permission denied to write into this folder.")
    if path.exists() and not force:
        raise UserError(f"{path} exists; --force overwrites it.")


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn errors of the file system, while `path` is written, into a UserError that names it."""
    try:
        yield
    except OSError as error:
        if error.errno in (None, errno.ENOMEM):  # a library that can't be loaded, or no memory
            raise
        raise UserError(f"{path} can't be written: {error.strerror or error}.") from None


@contextmanager
def folder_beside(path: Path) -> Iterator[Path]:
    """A temporary folder next to `path`, on the same file system. Raises OSError."""
    name = f".{path.name[:40]}."  # so that the folder's name has at most 255 bytes
    with TemporaryDirectory(".part", name, path.parent, ignore_cleanup_errors=True) as folder:
        yield Path(folder)


@contextmanager
def atomic_file(path: Path, force: bool = True) -> Iterator[Path]:
    """A temporary file to write, of the same name, which replaces `path` if no exception is raised.

    Raises UserError if it can't be written, or if a file has appeared at `path` meanwhile, unless
    `force` is given.
    """
    with writing(path), folder_beside(path) as folder:
        part = folder / path.name
        yield part
        sync(part)
        umask = os.umask(0)
        os.umask(umask)
        part.chmod(0o666 & ~umask)  # the usual mode; libraries may have set another one
        if not force:
            check_output(path, force)
        os.replace(part, path)


def sync(part: Path) -> None:
    """Flush a file to the disk, so that after a power cut no renamed file is incomplete."""
    with part.open("r+b") as written:
        os.fsync(written.fileno())
