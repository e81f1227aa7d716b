"""Names of outputs: numbered sequences, and new files for exports."""

import re
from glob import escape
from itertools import count
from pathlib import Path

from gclip.terminal.atomic import check_output
from player.errors import PlayerError

NUMBER = re.compile(r"%0?\d*d")  # its place in the names of a sequence
PROBE = 1 << 20  # bytes


def is_numbered(path: Path) -> bool:
    """Whether the name has a place for a number, like %04d. Raises PlayerError for any other %."""
    rest = NUMBER.sub("", path.name, count=1)
    if "%" in rest:
        raise PlayerError(f'{path.name}: one number, like "%04d", is the only "%" that is allowed.')
    return rest != path.name


def numbered(path: Path, number: int) -> Path:
    """The file of a number; `path` itself where it has no place for one."""
    return path.with_name(path.name % number) if is_numbered(path) else path


def check_sequence(path: Path, force: bool) -> None:
    """As `check_output`, for files that are numbered as the name says, like %04d.png."""
    numbered = NUMBER.sub("[0-9]*", escape(path.name))
    earlier, home = sorted(path.parent.glob(numbered)), path.parent
    check_output(earlier[0] if earlier else path if home.exists() else home, force)


def failure(part: Path, program: str) -> PlayerError:
    """Why a program that can't tell gave up writing `part`, a draft.

    On a full disk our own write raises OSError, with the system's reason.
    """
    with part.open("ab") as file:
        file.write(bytes(PROBE))
    return PlayerError(f"{part.name} can't be written: {program} gave up.")


def free_name(stem: str, example: str, folder: Path | None = None) -> Path:
    """A new file for an export, in the working folder: film.mp4 becomes plant.mp4, plant-2.mp4, ...

    Numbered sequences get a folder of their own. No file is ever overwritten.
    """
    folder, pattern = folder or Path(), Path(example)
    stem = re.sub(r"[^\w.-]+", "-", stem).strip("-.")[:100] or "plant"
    names = (stem if number == 1 else f"{stem}-{number}" for number in count(1))
    has_folder = pattern.parent != Path()
    ending = f"-{pattern.parent.name}" if has_folder else pattern.suffix
    free = next(path for name in names if not (path := folder / f"{name}{ending}").exists())
    return free / pattern.name if has_folder else free
