"""Paths of exported files: numbered sequences, and names that are not in use yet."""

import re
from glob import escape
from itertools import count
from pathlib import Path

from gclip.terminal.atomic import check_output
from player.errors import PlayerError

NUMBER_FIELD = re.compile(r"%0?\d*d")
PROBE_SIZE = 1 << 20  # bytes


def is_numbered(path: Path) -> bool:
    """Whether a file name has a number field like %04d; raises PlayerError for any other "%"."""
    rest = NUMBER_FIELD.sub("", path.name, count=1)
    if "%" in rest:
        raise PlayerError(f'{path.name}: "%" may stand in one number field only, such as %04d.')
    return rest != path.name


def numbered_path(path: Path, number: int) -> Path:
    """Insert a frame's number into a path; a path without a number field is returned as it is."""
    return path.with_name(path.name % number) if is_numbered(path) else path


def check_sequence(path: Path, force: bool) -> None:
    """Apply `gclip.terminal.atomic.check_output` to the files of a numbered sequence."""
    pattern = NUMBER_FIELD.sub("[0-9]*", escape(path.name))
    existing, folder = sorted(path.parent.glob(pattern)), path.parent
    check_output(existing[0] if existing else path if folder.exists() else folder, force)


def write_error(part: Path, program: str) -> PlayerError:
    """The error to raise where a program stopped writing `part` and gave no reason.

    The file is extended first: on a full disk this raises the OSError that names the reason.
    """
    with part.open("ab") as file:
        file.write(bytes(PROBE_SIZE))
    return PlayerError(f"{part.name} can't be written: {program} gave up.")


def unused_path(stem: str, example: str, folder: Path | None = None) -> Path:
    """Choose a path that does not exist yet in a folder: plant.mp4, plant-2.mp4, ...

    The suffix is that of a format's `example`. For numbered sequences, whose example lies in a
    folder ("frames/%04d.png"), a new folder is chosen.
    """
    folder, pattern = folder or Path(), Path(example)
    stem = re.sub(r"[^\w.-]+", "-", stem).strip("-.")[:100] or "plant"
    names = (stem if number == 1 else f"{stem}-{number}" for number in count(1))
    has_folder = pattern.parent != Path()
    ending = f"-{pattern.parent.name}" if has_folder else pattern.suffix
    free = next(path for name in names if not (path := folder / f"{name}{ending}").exists())
    return free / pattern.name if has_folder else free
