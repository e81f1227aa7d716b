"""H.264 films that play everywhere and show the colours that were drawn."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from player.errors import PlayerError
from player.export.encoder import encode
from player.export.film import Film
from player.export.output import whole_file

if TYPE_CHECKING:
    from numpy.typing import NDArray

# RGB is converted with the matrix of ITU-R BT.709 and tagged with it, or players would guess.
BT709 = (
    "-vf",
    "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,format=yuv420p,"
    "setparams=colorspace=bt709:color_primaries=bt709:color_trc=bt709:range=tv",
)
# aq-mode 3 spends bits on dark surfaces, where a soft floor would show bands.
X264 = (
    "-c:v",
    "libx264",
    "-preset",
    "medium",
    "-crf",
    "18",
    "-threads",
    "4",
    "-x264-params",
    "aq-mode=3",
)


def check(film: Film) -> None:
    """Raise PlayerError where H.264 can't hold the size."""
    if film.size[0] % 2 or film.size[1] % 2:
        width, height = (side + side % 2 for side in film.size)
        raise PlayerError(
            f"an mp4's sides are even numbers, not {film.size[0]}x{film.size[1]}; "
            f"use --size {width}x{height}."
        )


def write(pictures: Iterable[NDArray], film: Film, path: Path) -> None:
    with whole_file(path) as part:
        encode(pictures, film.size, film.fps, [*X264, *BT709, "-movflags", "+faststart"], part)
