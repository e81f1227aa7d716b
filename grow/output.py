"""Write a folder of scans atomically: completely, or not at all."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from baker.errors import InputError
from gclip.terminal.atomic import folder_beside, writing

TRUTH = "truth"  # name of the subfolder of true points, organs and poses
MAX_NOISE = 1e6  # mm


@contextmanager
def atomic_series(folder: Path, is_output: Callable[[Path], bool], force: bool) -> Iterator[Path]:
    """Yield a temporary folder whose content is moved to `folder` when the context is left.

    is_output: whether `grow` writes files with such a path. force: replace such files, and the
    subfolder `TRUTH`, if they exist. Raises UserError if they exist and `force` is False, or if the
    folder can't be written.
    """
    existing = _existing_output(folder, is_output)
    if existing and not force:
        raise InputError(f"{existing[0]} exists; --force overwrites it.")
    with writing(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        with folder_beside(folder) as draft:
            yield draft
            for path in existing:
                shutil.rmtree(path) if path.is_dir() else path.unlink()
            folder.mkdir(exist_ok=True)
            for path in sorted(draft.iterdir()):
                path.replace(folder / path.name)


def _existing_output(folder: Path, is_output: Callable[[Path], bool]) -> list[Path]:
    """The files and the subfolder `TRUTH` in a folder that an earlier `grow` may have written."""
    if not folder.exists():
        return []
    if not folder.is_dir():
        raise InputError(f"'{folder}' is a file; `grow` writes a folder.")
    files = [path for path in sorted(folder.iterdir()) if path.is_file() and is_output(path)]
    truth = folder / TRUTH
    return [*files, truth] if truth.is_dir() else files
