"""Write a folder of scans atomically: completely, or not at all."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from baker.errors import InputError
from gclip.terminal.atomic import folder_beside, writing

TRUTH = "truth"
LARGEST_NOISE = 1e6  # mm


@contextmanager
def whole_series(folder: Path, ours: Callable[[Path], bool], force: bool) -> Iterator[Path]:
    """A temporary folder whose content is moved to `folder` at the end.

    ours:  whether `grow` writes files with such a path.
    force: replace such files, and the folder of truths, if they exist.
    Raises UserError if they exist and `force` is not given, or if `folder` can't be written.
    """
    existing = _existing_output(folder, ours)
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


def _existing_output(folder: Path, ours: Callable[[Path], bool]) -> list[Path]:
    if not folder.exists():
        return []
    if not folder.is_dir():
        raise InputError(f"'{folder}' is a file; `grow` writes a folder.")
    files = [path for path in sorted(folder.iterdir()) if path.is_file() and ours(path)]
    truth = folder / TRUTH
    return [*files, truth] if truth.is_dir() else files
