"""Options of the window.

Imports no numpy, because `play --help` reads the key table, which imports this module.
"""

from dataclasses import dataclass
from enum import StrEnum

# Sizes of exported pictures in pixels; None stands for the window's own size.
PICTURE_SIZES = (None, (1280, 720), (1920, 1080), (3840, 2160), (1080, 1080), (1080, 1920))


class Compare(StrEnum):
    """Whether the plant is compared with a scan or with another clip, and how."""

    OFF = "off"
    WIPE = "wipe"
    BESIDE = "side by side"


class Request(StrEnum):
    """A task that the window carries out once, before it draws the next frame."""

    PICTURE = "save a picture of the current view"
    EXPORT = "begin an export, or stop the running one"
    CAMERA_KEY = "add the camera to the path that is kept in a file"


@dataclass(frozen=True)
class Output:
    """Settings of the next picture or export."""

    example: str = "film.mp4"  #: selects the format (`player.export.formats.Format.example`)
    size: tuple[int, int] | None = None  #: (width, height) in pixels, None for the window's own
    transparent: bool = False  #: PNG pictures without a background
