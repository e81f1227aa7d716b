"""Animated GIFs with one palette that serves the whole film."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from player.errors import PlayerError
from player.export.encoder import encode
from player.export.film import Film
from player.export.output import whole_file

if TYPE_CHECKING:
    from numpy.typing import NDArray

SAMPLES = 8  # frames, spread over the film, that the palette is made from
FASTEST = 50  # frames a second: shorter delays than 2/100 s are played slowly by browsers


def check(film: Film) -> None:
    """Raise PlayerError where a GIF can't be so fast."""
    if film.fps > FASTEST:
        raise PlayerError(f"a gif shows at most {FASTEST} frames a second, not {film.fps}.")


def write(pictures: Iterable[NDArray], film: Film, path: Path, samples: list[NDArray]) -> None:
    """samples: some of the film's pictures, to find the palette from."""
    with whole_file(path) as part:
        palette = part.with_name("palette.png")
        _write_palette(samples, palette)
        dithered = "[0:v][1:v]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle"
        encode(
            pictures,
            film.size,
            film.fps,
            ["-i", str(palette), "-lavfi", dithered, "-loop", "0"],
            part,
        )


def _write_palette(samples: list[NDArray], path: Path) -> None:
    """255 colours as a 16 × 16 picture; the last square repeats, ffmpeg may make it transparent."""
    from PIL import Image

    together = Image.fromarray(np.concatenate([picture[..., :3] for picture in samples]))
    found = together.quantize(255, method=Image.Quantize.MEDIANCUT, kmeans=1).getpalette()
    colors = np.array(found or [0, 0, 0], np.uint8).reshape(-1, 3)[:255]
    squares = np.concatenate([colors, np.repeat(colors[-1:], 256 - len(colors), axis=0)])
    Image.fromarray(squares.reshape(16, 16, 3)).save(path)
