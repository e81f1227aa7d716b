"""The file beside the images: how the camera sees, what the images are called, how to repair them.

`camera.toml`, or the same as `camera.json`: docs/images.md says what each field means. The centre
of the upper left pixel is (0, 0).
"""

import re
from pathlib import Path
from typing import Annotated

from msgspec import Meta, Struct

from baker.errors import asking
from gclip.config_file import read_config

CAMERA_FILES = ("camera.toml", "camera.json")

LARGEST, SMALLEST = 1e9, 1e-9  # numbers beyond are no camera's
MAX_FILE_SIZE = 1 << 16  # bytes
PATTERN = r"(?![/\\]|(.*[/\\])?\.\.([/\\]|$))[^*?\[\]:]*\*[^*?\[\]:/\\]*"


Number = Annotated[float, Meta(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, Meta(ge=SMALLEST, le=LARGEST)]
Count = Annotated[int, Meta(ge=1, le=int(LARGEST))]
Border = Annotated[int, Meta(ge=0, le=100)]
Coordinate = Annotated[int, Meta(ge=0, le=int(LARGEST))]
Label = Annotated[int, Meta(ge=-int(LARGEST), le=int(LARGEST))]


class Patterns(Struct, frozen=True, forbid_unknown_fields=True):
    """Paths relative to the folder, with one star for the frame's name in each."""

    color: str = "rgb_*.png"
    depth: str = "depth_*.png"
    label: str = "label_*.png"
    mask: str = "mask_*.png"

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not re.fullmatch(PATTERN, getattr(self, name)):
                raise ValueError(
                    f"Expected as {name} a path in the folder, with one * in the file's own name"
                )


class RepairOptions(Struct, frozen=True, forbid_unknown_fields=True):
    """Which depth `baker.scans.rgbd.depth_repair` marks unknown."""

    ring: Border = 1
    """Pixels along a label's border that never count as valid, unless it is too thin for others."""
    band: Border = 6
    """Pixels along a label's border in which depth may jump; 0 looks for no jumps."""
    jump: Positive = 2.0
    """mm off the label's surface from which on depth is implausible, if noise is not as far off."""


class Camera(Struct, frozen=True, forbid_unknown_fields=True):
    """A pinhole camera and its images, in pixels of the depth images, and mm."""

    fx: Positive
    fy: Positive
    cx: Number
    cy: Number
    width: Count | None = None
    height: Count | None = None
    depth_unit: Positive = 1.0  # of one count of depth
    crop: tuple[Coordinate, Coordinate] | None = None  # left, top
    ground: Positive | None = None
    background: Label = 0  # as `baker.scans.rgbd.series.read_labels` numbers it
    per_day: Count = 6
    images: Patterns = Patterns()
    repair: RepairOptions = RepairOptions()


def find_camera(folder: Path) -> Path | None:
    """The camera's file in `folder`, or None where it holds no images to read."""
    with asking(folder):
        return next((folder / name for name in CAMERA_FILES if (folder / name).is_file()), None)


def read_camera(path: Path) -> Camera:
    """Read the file that describes a camera. InputError where it is not as `Camera` has it."""
    with asking(path):
        return read_config(path, Camera, MAX_FILE_SIZE)
