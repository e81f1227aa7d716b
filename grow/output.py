"""A folder of what `grow` makes: it appears whole, or the one before stays as it was."""

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
    """A draft folder beside `folder`; what is in it when the work is done is moved there.

    ours:  whether a file is one that `grow` writes, by its path.
    force: replace such files, and the folder of truths, that are there already.
    Raises UserError where they are and `force` is not given, or where nothing can be written.
    """
    earlier = _earlier(folder, ours)
    if earlier and not force:
        raise InputError(f"{earlier[0]} exists; --force overwrites it.")
    with writing(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        with folder_beside(folder) as draft:
            yield draft
            for path in earlier:
                shutil.rmtree(path) if path.is_dir() else path.unlink()
            folder.mkdir(exist_ok=True)
            for path in sorted(draft.iterdir()):
                path.replace(folder / path.name)


def _earlier(folder: Path, ours: Callable[[Path], bool]) -> list[Path]:
    if not folder.exists():
        return []
    if not folder.is_dir():
        raise InputError(f"'{folder}' is a file; `grow` writes a folder.")
    files = [path for path in sorted(folder.iterdir()) if path.is_file() and ours(path)]
    truth = folder / TRUTH
    return [*files, truth] if truth.is_dir() else files
