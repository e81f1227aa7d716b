"""Outputs that appear whole or not at all, whenever the process that writes them dies.

All is written in a draft folder beside the output and renamed when it is done. A process that is
killed leaves its draft; the next one that writes the same output removes it. Each locks its own
draft for as long as it lives, so that no living one's is taken for a dead one's.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: drafts are whole or not at all there too, but nobody sweeps
    fcntl = None  # type: ignore[assignment]

SUFFIX = ".part"
UNLOCKED = -1


@contextmanager
def draft_folder(path: Path) -> Iterator[Path]:
    """A folder beside `path` to work in, removed in the end with what is left in it.

    Drafts of `path` that dead processes have left are removed first. Raises OSError.
    """
    sweep(path)
    folder, lock = _locked_folder(path)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if lock != UNLOCKED:
            os.close(lock)


@contextmanager
def draft_file(path: Path) -> Iterator[Path]:
    """A file to write, which takes the place of `path` when the work is done. Raises OSError."""
    with draft_folder(path) as folder:
        part = folder / path.name
        yield part
        sync(part)
        part.chmod(0o666 & ~_umask())  # whatever the library that wrote it thinks
        os.replace(part, path)


def replace_folder(draft: Path, folder: Path) -> bool:
    """Put a draft in the place of a folder, at one instant; both hold plain files only.

    Files of the folder that the draft has not stay. The old folder is then where the draft was.
    False where this system or file system can't: nothing has changed then.
    """
    if not folder.exists():
        draft.chmod(0o777 & ~_umask())
        draft.rename(folder)
        return True
    try:
        for other in folder.iterdir():
            if not (draft / other.name).exists():
                os.link(other, draft / other.name)
        shutil.copymode(folder, draft)
    except OSError:
        return False
    return _exchange(draft, folder)


def _exchange(one: Path, other: Path) -> bool:
    """Swap what two names stand for (Linux: renameat2 with RENAME_EXCHANGE)."""
    import ctypes

    here, swap = -100, 2
    try:
        rename = ctypes.CDLL(None).renameat2
    except AttributeError:
        return False
    return bool(rename(here, os.fsencode(one), here, os.fsencode(other), swap) == 0)


def _umask() -> int:
    umask = os.umask(0)
    os.umask(umask)
    return umask


def sync(part: Path) -> None:
    """Have a file's bytes on the disk, so that a power cut can't come between them and its name."""
    with part.open("r+b") as written:
        os.fsync(written.fileno())


def sweep(path: Path) -> None:
    """Remove the drafts of `path` whose processes are dead. What can't be removed stays."""
    _sweep(path.parent, re.escape(path.name))


def sweep_all(folder: Path, suffix: str) -> None:
    """The same for all outputs in a folder whose names end in `suffix`."""
    _sweep(folder, ".*" + re.escape(suffix))


def _sweep(folder: Path, names: str) -> None:
    ours = re.compile(r"\." + names + r"\.\w{8}" + re.escape(SUFFIX), re.DOTALL)
    with suppress(OSError):
        for entry in os.scandir(folder):
            if ours.fullmatch(entry.name) and entry.is_dir(follow_symlinks=False):
                _remove_if_dead(Path(entry.path))


def _remove_if_dead(folder: Path) -> None:
    if fcntl is None:
        return
    with suppress(OSError):
        lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(folder, ignore_errors=True)
        finally:
            os.close(lock)


def _locked_folder(path: Path) -> tuple[Path, int]:
    """A new draft of `path` and the handle that locks it."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=f".{path.name}.", suffix=SUFFIX, dir=path.parent))
        lock = _lock(folder)
        if lock is not None:
            return folder, lock


def _lock(folder: Path) -> int | None:
    """None where another process was faster, and took a draft just made for a dead one's."""
    if fcntl is None:
        return UNLOCKED
    try:
        lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except FileNotFoundError:
        return None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        taken = not os.path.samestat(os.fstat(lock), os.stat(folder))
    except (BlockingIOError, FileNotFoundError):
        taken = True
    except OSError:
        taken = False  # a file system without locks: then nobody can sweep, either
    if taken:
        os.close(lock)
        return None
    return lock
