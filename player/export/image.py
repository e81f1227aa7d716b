"""Export of PNG and JPEG pictures: a single one, or a numbered sequence."""

import json
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.export.film import Film, Progress
from player.output_names import is_numbered, numbered_path

JPEG_SUFFIXES = (".jpg", ".jpeg")
JPEG = {"extension": ".jpg", "quality": 92, "subsampling": 0}  # subsampling fades thin leaves


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Write a picture of the film's day, by default of the last scan; or frames numbered from 0.

    PNG files contain the metadata "view", by which others can draw on top of the picture: the
    (4, 4) matrix from local to OpenGL's clip coordinates as JSON, rows first.
    """
    if not is_numbered(path):
        film = replace(film, at=film.at or (clip.times[-1],), every=None)
    views = [camera.matrix(film.aspect) for camera in film.cameras(clip)]
    with closing(film.pictures(clip, progress)) as pictures:
        for index, (picture, view) in enumerate(zip(pictures, views, strict=True)):
            _save(picture, numbered_path(path, index), view)


def _save(picture: NDArray[np.uint8], path: Path, view: NDArray[np.floating]) -> None:
    import imageio.v3 as iio
    from PIL.PngImagePlugin import PngInfo

    is_jpeg, metadata = path.suffix.lower() in JPEG_SUFFIXES, PngInfo()
    metadata.add_text("view", json.dumps(view.tolist()))
    options: dict[str, Any] = JPEG if is_jpeg else {"extension": ".png", "pnginfo": metadata}
    if is_jpeg or (picture[..., 3] == 255).all():
        picture = picture[..., :3]
    # If imageio wrote the file itself, an error of a full disk would be raised twice.
    path.write_bytes(iio.imwrite("<bytes>", picture, plugin="pillow", **options))
