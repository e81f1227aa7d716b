"""PNG pictures: one, or a numbered sequence."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from player.errors import PlayerError
from player.export.film import Film
from player.export.output import whole_file, whole_folder

if TYPE_CHECKING:
    from numpy.typing import NDArray

NUMBER = re.compile(r"%0?\d*d")


def is_sequence(path: Path) -> bool:
    """Whether the name has a place for a number, like %04d. Raises PlayerError for any other %."""
    rest = NUMBER.sub("", path.name, count=1)
    if "%" in rest:
        raise PlayerError(f'{path.name}: one number, like "%04d", is the only "%" that is allowed.')
    return rest != path.name


def write_one(picture: NDArray, film: Film, path: Path) -> None:
    with whole_file(path) as part:
        _save(picture, part)


def write_sequence(pictures: Iterable[NDArray], film: Film, path: Path) -> None:
    """Frames are numbered from 0; all appear together once the last one is drawn."""
    with whole_folder(path) as folder:
        names = []
        for index, picture in enumerate(pictures):
            names.append(path.name % index)
            _save(picture, folder / names[-1])
        for name in names:
            os.replace(folder / name, path.parent / name)


def _save(picture: NDArray, path: Path) -> None:
    from PIL import Image

    Image.fromarray(picture[..., :3]).save(path)
