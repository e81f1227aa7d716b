"""Write files atomically: in a temporary folder next to their path, then renamed.

The folder, `.NAME.xxxxxxxx.part`, is removed even after an error or Ctrl-C, but not if the process
is killed.
"""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex
from shutil import rmtree

from gclip.errors import UserError
from gclip.terminal.interrupts import drafts


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
    # Its name has at most 255 bytes, and is known to `stop` before the folder exists.
    folder = path.parent / f".{path.name[:40]}.{token_hex(4)}.part"
    drafts.add(folder)
    try:
        folder.mkdir(mode=0o700)
        yield folder
    finally:
        rmtree(folder, ignore_errors=True)
        drafts.discard(folder)


def check_output(path: Path, force: bool) -> None:
    """Raise UserError if a file can't be written, or exists and `force` is not given."""
    if path.is_dir():
        raise UserError(f"{path} is a folder; a file's name is needed.")
    if path.exists() and not force:
        raise UserError(f"{path} exists; --force overwrites it.")
    with writing(path), folder_beside(path):
        pass  # a file can be made there


@contextmanager
def atomic_file(path: Path, force: bool = True, numbered: bool = False) -> Iterator[Path]:
    """A temporary file to write, of the same name, which replaces `path` if no exception is raised.

    If it is the pattern of numbered files, such as %04d.png, they all take their places; of their
    folder, only the last part may be missing. Raises UserError if they can't be written, or if a
    file has appeared in the place of one meanwhile, unless `force` is given.
    """
    home = path.parent
    with writing(path), folder_beside(home if numbered and not home.exists() else path) as folder:
        yield folder / path.name
        umask = os.umask(0)
        os.umask(umask)
        parts = sorted(folder.iterdir()) if numbered else [folder / path.name]
        for part in parts:
            with part.open("r+b") as written:
                os.fsync(written.fileno())  # no renamed file is incomplete after a power cut
            part.chmod(0o666 & ~umask)  # the usual mode; libraries may have set another one
        if numbered:
            home.mkdir(exist_ok=True)
        if not force:
            for part in parts:
                check_output(home / part.name, force)
        for part in parts:
            os.replace(part, home / part.name)
