"""PNG pictures: one, or a numbered sequence."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from player.errors import PlayerError
from player.export.output import whole_file, whole_sequence

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

NUMBER = re.compile(r"%0?\d*d")


def is_sequence(path: Path) -> bool:
    """Whether the name has a place for a number, like %04d. Raises PlayerError for any other %."""
    rest = NUMBER.sub("", path.name, count=1)
    if "%" in rest:
        raise PlayerError(f'{path.name}: one number, like "%04d", is the only "%" that is allowed.')
    return rest != path.name


def write_one(picture: NDArray[np.uint8], path: Path, view: NDArray[np.floating]) -> None:
    """A still picture, with the text "view" in its metadata: what it takes to draw on top of it.

    view: (4, 4) from the clip's local coordinates to OpenGL's clip coordinates, M @ column; stored
          as JSON, row by row.
    """
    with whole_file(path) as part:
        _save(picture, part, view)


def write_sequence(
    pictures: Iterable[NDArray[np.uint8]], path: Path, views: Iterable[NDArray[np.floating]]
) -> None:
    """Frames are numbered from 0; all appear together once the last one is drawn.

    The folder they go to is made if only itself is missing.
    views: of each picture, as in `write_one`.
    """
    with whole_sequence(path) as file:
        for index, (picture, view) in enumerate(zip(pictures, views, strict=True)):
            _save(picture, file(index), view)


def _save(picture: NDArray[np.uint8], path: Path, view: NDArray[np.floating]) -> None:
    import imageio.v3 as iio
    from PIL.PngImagePlugin import PngInfo

    metadata = PngInfo()
    metadata.add_text("view", json.dumps(view.tolist()))
    opaque = bool((picture[..., 3] == 255).all())
    shown = picture[..., :3] if opaque else picture
    # Through memory: imageio's own file would report a full disk once more as it is collected.
    encoded = iio.imwrite("<bytes>", shown, extension=".png", plugin="pillow", pnginfo=metadata)
    path.write_bytes(encoded)
