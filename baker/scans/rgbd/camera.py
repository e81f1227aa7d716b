"""The file beside the images: how the camera sees, what the images are called, how to repair them.

`camera.toml`, or the same as `camera.json`: docs/images.md says what each field means. The centre
of the upper left pixel is (0, 0).
"""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Annotated, Any, Self, get_args, get_type_hints

from msgspec import Meta, Struct, ValidationError, convert

from baker.errors import InputError, asking, excerpt

CAMERA_FILES = ("camera.toml", "camera.json")

LARGEST, SMALLEST = 1e9, 1e-9  # numbers beyond are no camera's
MAX_FILE_SIZE = 1 << 16  # bytes; parsers of nested text take many times as much

_MILLIMETRES = {"m": 1000.0, "cm": 10.0, "mm": 1.0, "um": 0.001, "µm": 0.001}


class Millimetres(float):
    """A length, which the file may give in another unit."""

    @classmethod
    def parse(cls, value: Any) -> Self:
        match = re.fullmatch(r"\s*(\d*\.?\d*(?:e-?\d+)?)\s*([a-zµ]+)\s*", str(value))
        length = float(match[1] or 1) * _MILLIMETRES.get(match[2], 0.0) if match else value
        if type(length) not in (int, float) or not SMALLEST <= length <= LARGEST:
            raise ValueError
        return cls(length)


class Label(int):
    """A label as `baker.scans.rgbd.images.read_labels` numbers them."""

    @classmethod
    def parse(cls, value: Any) -> Self:
        color = re.fullmatch(r"#([0-9a-fA-F]{6})", str(value))
        label = int(color[1], 16) if color else value
        if type(label) is not int or abs(label) > LARGEST:
            raise ValueError
        return cls(label)


# The descriptions say what is allowed to those who wrote something else.
Number = Annotated[float, Meta(ge=-LARGEST, le=LARGEST, description="a number, up to 1e+09")]
Positive = Annotated[
    float, Meta(ge=SMALLEST, le=LARGEST, description="a number above 0, from 1e-09 to 1e+09")
]
Count = Annotated[int, Meta(ge=1, le=int(LARGEST), description="a whole number, 1 or more")]
Border = Annotated[int, Meta(ge=0, le=100, description="a whole number, 0 to 100")]
Coordinate = Annotated[int, Meta(ge=0, le=int(LARGEST))]
Pixel = Annotated[tuple[Coordinate, Coordinate], Meta(description="two whole numbers, [left, top]")]
DepthUnit = Annotated[
    Millimetres, Meta(description='a number of mm or, like "m" or "0.125 mm", a length')
]
Background = Annotated[Label, Meta(description='a whole number or a colour such as "#000000"')]
Pattern = Annotated[
    str,
    Meta(
        pattern=r"^(?![/\\]|(.*[/\\])?\.\.([/\\]|$))[^*?\[\]:]*\*[^*?\[\]:/\\]*$",
        description='a path in the folder, with one * in the file\'s own name, like "rgb_*.png"',
    ),
]


class Patterns(Struct, frozen=True, forbid_unknown_fields=True):
    """Paths relative to the folder, with one star for the frame's name in each."""

    color: Pattern = "rgb_*.png"
    depth: Pattern = "depth_*.png"
    label: Pattern = "label_*.png"
    mask: Pattern = "mask_*.png"


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
    depth_unit: DepthUnit = Millimetres(1.0)
    crop: Pixel | None = None
    ground: Positive | None = None
    background: Background = Label(0)
    per_day: Count = 6
    images: Annotated[Patterns, Meta(description="a table")] = Patterns()
    repair: Annotated[RepairOptions, Meta(description="a table")] = RepairOptions()


_TABLES: dict[str, type[Struct]] = {"": Camera, "images": Patterns, "repair": RepairOptions}


def find_camera(folder: Path) -> Path | None:
    """The camera's file in `folder`, or None where it holds no images to read."""
    with asking(folder):
        return next((folder / name for name in CAMERA_FILES if (folder / name).is_file()), None)


def read_camera(path: Path) -> Camera:
    """Read the file that describes a camera.

    Raises
    ------
    InputError
        Where it is not TOML or JSON, or a field is missing, unknown or out of its bounds.
    """
    content = _parse(path)
    try:
        return convert(content, Camera, dec_hook=lambda kind, value: kind.parse(value))
    except ValidationError as error:
        raise InputError(f"'{path}'{_explain(str(error), content)}") from None


def _parse(path: Path) -> dict[str, Any]:
    try:
        if path.stat().st_size > MAX_FILE_SIZE:
            raise InputError(
                f"'{path}' has {path.stat().st_size} bytes; a camera takes {MAX_FILE_SIZE} at most."
            )
        text = path.read_text(encoding="utf-8-sig")
        content = json.loads(text) if path.suffix == ".json" else tomllib.loads(text)
    except OSError as error:
        raise InputError(f"'{path}' can't be read: {error.strerror}.") from error
    except (ValueError, RecursionError) as error:
        kind = path.suffix[1:].upper()
        raise InputError(f"'{path}' is no sound {kind} file: {error}.") from error
    if not isinstance(content, dict):
        raise InputError(f"'{path}' must hold fields such as fx, not a {type(content).__name__}.")
    return content


def _explain(error: str, content: dict[str, Any]) -> str:
    """What msgspec says, "reason - at `$.table.field`", as what follows the file's name."""
    said = re.fullmatch(r"(.*?)(?: - at `\$\.([a-z_.]+)(?:\[\d\])?`)?", error, re.DOTALL)
    assert said is not None
    reason, place = said[1], said[2] or ""
    if reason.startswith("Object missing"):
        name = reason.split("`")[1]
        return f" lacks {name}; a camera needs fx, fy, cx and cy, in pixels."
    if reason.startswith("Object contains unknown field"):
        name = f"{place}." * bool(place) + reason.split("`", 1)[1][:-1]
        known = ", ".join(_TABLES[place].__struct_fields__)
        return f" has an unknown field '{excerpt(name)}'; known are {known}."
    table, _, name = place.rpartition(".")
    hint = get_type_hints(_TABLES[table], include_extras=True)[name]
    described = next(part for part in (hint, *get_args(hint)) if hasattr(part, "__metadata__"))
    found = excerpt(repr((content[table] if table else content)[name]))
    return f": {place} is {found}, but must be {described.__metadata__[0].description}."
