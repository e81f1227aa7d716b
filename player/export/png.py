"""PNG pictures: one, or a numbered sequence."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from player.errors import PlayerError
from player.export.output import made_folder, whole_file, whole_folder

if TYPE_CHECKING:
    from numpy.typing import NDArray

NUMBER = re.compile(r"%0?\d*d")


def is_sequence(path: Path) -> bool:
    """Whether the name has a place for a number, like %04d. Raises PlayerError for any other %."""
    rest = NUMBER.sub("", path.name, count=1)
    if "%" in rest:
        raise PlayerError(f'{path.name}: one number, like "%04d", is the only "%" that is allowed.')
    return rest != path.name


def write_one(picture: NDArray, path: Path, view: NDArray) -> None:
    """A still picture, with the text "view" in its metadata: what it takes to draw on top of it.

    view: (4, 4) from the clip's local coordinates to OpenGL's clip coordinates, M @ column; stored
          as JSON, row by row.
    """
    with whole_file(path) as part:
        _save(picture, part, view)


def write_sequence(pictures: Iterable[NDArray], path: Path, views: Iterable[NDArray]) -> None:
    """Frames are numbered from 0; all appear together once the last one is drawn.

    The folder they go to is made if only itself is missing.
    views: of each picture, as in `write_one`.
    """
    with made_folder(path.parent), whole_folder(path) as folder:
        names = []
        for index, (picture, view) in enumerate(zip(pictures, views, strict=True)):
            names.append(path.name % index)
            _save(picture, folder / names[-1], view)
        for name in names:
            os.replace(folder / name, path.parent / name)


def _save(picture: NDArray, path: Path, view: NDArray) -> None:
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    metadata = PngInfo()
    metadata.add_text("view", json.dumps(view.tolist()))
    Image.fromarray(picture[..., :3]).save(path, pnginfo=metadata)
