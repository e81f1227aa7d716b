"""VP9 films: free of patents, smaller than H.264, for pages and wikis."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from player.export.encoder import encode
from player.export.film import Film
from player.export.mp4 import BT709
from player.export.output import whole_file

if TYPE_CHECKING:
    from numpy.typing import NDArray

VP9 = (
    *("-c:v", "libvpx-vp9", "-crf", "28", "-b:v", "0", "-deadline", "good", "-cpu-used", "4"),
    *("-threads", "4", "-tile-columns", "2"),
)


def write(pictures: Iterable[NDArray], film: Film, path: Path) -> None:
    with whole_file(path) as part:
        encode(pictures, film.size, film.fps, [*VP9, *BT709], part)
