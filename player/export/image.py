"""PNG and JPEG pictures: one, or a numbered sequence."""

import json
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.export.film import Film, Progress
from player.output_names import is_numbered, numbered

JPEG_SUFFIXES = (".jpg", ".jpeg")
JPEG = {"extension": ".jpg", "quality": 92, "subsampling": 0}  # thin leaves keep their colour


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """One picture, of the film's --day or the last scan's; or its frames, numbered from 0.

    The text "view" in a PNG's metadata is what it takes to draw on top of it: the (4, 4) matrix
    from the clip's local coordinates to OpenGL's clip coordinates, M @ column, as JSON row by row.
    """
    if not is_numbered(path):
        film = replace(film, at=film.at or (clip.times[-1],), every=None)
    views = [camera.matrix(film.aspect) for camera in film.cameras(clip)]
    with closing(film.pictures(clip, progress)) as pictures:
        for index, (picture, view) in enumerate(zip(pictures, views, strict=True)):
            _save(picture, numbered(path, index), view)


def _save(picture: NDArray[np.uint8], path: Path, view: NDArray[np.floating]) -> None:
    import imageio.v3 as iio
    from PIL.PngImagePlugin import PngInfo

    is_jpeg, metadata = path.suffix.lower() in JPEG_SUFFIXES, PngInfo()
    metadata.add_text("view", json.dumps(view.tolist()))
    options: dict[str, Any] = JPEG if is_jpeg else {"extension": ".png", "pnginfo": metadata}
    if is_jpeg or (picture[..., 3] == 255).all():
        picture = picture[..., :3]
    # A file that imageio wrote itself would tell of a full disk twice.
    path.write_bytes(iio.imwrite("<bytes>", picture, plugin="pillow", **options))
