"""What users choose among. Loads nothing: the table of keys is read by `--help`."""

from dataclasses import dataclass
from enum import StrEnum

SIZES: tuple[tuple[int, int] | None, ...] = (
    None,
    (1280, 720),
    (1920, 1080),
    (3840, 2160),
    (1080, 1080),
    (1080, 1920),
)


class Compare(StrEnum):
    """What is seen besides the plant at the present day."""

    OFF = "off"
    WIPE = "wipe"
    BESIDE = "side by side"


class Wish(StrEnum):
    """What the window is to do once, when the next picture is drawn."""

    PICTURE = "save a picture of what is seen"
    EXPORT = "begin an export, or stop the one under way"
    SAVE_PATH = "save the camera's path"


@dataclass(frozen=True)
class Output:
    """What the next picture or export is to be."""

    example: str = (
        "film.mp4"  #: the example of a format in player/export/formats.py, which names it
    )
    size: tuple[int, int] | None = None  #: (width, height) in pixels, None for the window's own
    transparent: bool = False  #: the plant alone, in PNG pictures
