"""Read the camera file of a folder of images: intrinsics and file names.

It is `camera.toml` or `camera.json`; docs/images.md says what each field means. The centre of the
upper left pixel is (0, 0).
"""

import re
from pathlib import Path
from typing import Annotated

from msgspec import Meta, Struct

from baker.errors import input_errors
from gclip.config_file import read_config

CAMERA_FILES = ("camera.toml", "camera.json")

MAX_FILE_SIZE = 1 << 16  # bytes
PATTERN = r"(?![/\\]|(.*[/\\])?\.\.([/\\]|$))[^*?\[\]:]*\*[^*?\[\]:/\\]*"

Number = Annotated[float, Meta(ge=-1e9, le=1e9)]
Positive = Annotated[float, Meta(ge=1e-9, le=1e9)]
Count = Annotated[int, Meta(ge=1, le=10**9)]
Coordinate = Annotated[int, Meta(ge=0, le=10**9)]
Label = Annotated[int, Meta(ge=-(10**9), le=10**9)]


class Patterns(Struct, frozen=True, forbid_unknown_fields=True):
    """File names relative to the folder; the star in each stands for the frame's name."""

    color: str = "rgb_*.png"
    depth: str = "depth_*.png"
    label: str = "label_*.png"
    mask: str = "mask_*.png"

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not re.fullmatch(PATTERN, getattr(self, name)):
                needed = "a path in the folder, with one * in the file's own name"
                raise ValueError(f"Expected as {name} {needed}")


class Camera(Struct, frozen=True, forbid_unknown_fields=True):
    """A pinhole camera and its images, in pixels of the depth images, and mm."""

    fx: Positive  # focal lengths, pixels
    fy: Positive
    cx: Number  # principal point, pixels
    cy: Number
    width: Count | None = None
    height: Count | None = None
    depth_unit: Positive = 1.0  # mm of one count of depth
    crop: tuple[Coordinate, Coordinate] | None = None  # left, top of the colour image
    ground: Positive | None = None  # mm from the camera
    background: Label = 0  # a number of `baker.scans.rgbd.images.read_labels`
    per_day: Count = 6
    images: Patterns = Patterns()


def find_camera(folder: Path) -> Path | None:
    """The path of the camera file in a folder, or None if it has none."""
    with input_errors(folder):
        return next((folder / name for name in CAMERA_FILES if (folder / name).is_file()), None)


def read_camera(path: Path) -> Camera:
    """Read a camera file; raises InputError if a field is wrong or missing."""
    with input_errors(path):
        return read_config(path, Camera, MAX_FILE_SIZE)
