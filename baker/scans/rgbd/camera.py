"""The file beside the images: how the camera sees, what the images are called, how to repair them.

`camera.toml` (or the same as `camera.json`); all but the first four lines may be left out:

    fx = 610.0                 # focal lengths and principal point, in pixels of the depth image;
    fy = 610.0                 # the centre of the upper left pixel is (0, 0)
    cx = 239.5
    cy = 179.5
    width = 480                # only to check the images' size
    height = 360
    depth_unit = "mm"          # of one count: a number of mm, "m", "cm", "mm", "um", "0.125 mm"
    crop = [80, 60]            # where colour and label images are cut out of the depth image:
                               # the depth pixel that their upper left pixel shows
    ground = 500.0             # distance from the camera to the ground, mm
    background = 0             # the label (or "#rrggbb") of what is no plant
    per_day = 6                # images a day, where names end in day and number: rgb_003_05.png

    [images]                   # one * each; it stands for the frame's name
    color = "rgb_*.png"
    depth = "depth_*.png"
    label = "label_*.png"      # optional, all frames or none
    mask = "mask_*.png"        # optional, any frames: what is not 0 is marked unknown

    [repair]                   # see baker.scans.rgbd.depth_repair.RepairOptions
    ring = 1
    band = 6
    jump = 2.0
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from baker.errors import InputError, asking, excerpt
from baker.scans.rgbd.depth_repair import RepairOptions

CAMERA_FILES = ("camera.toml", "camera.json")

LARGEST, SMALLEST = 1e9, 1e-9  # numbers beyond are no camera's
WIDEST = 100  # pixels along a border
LONGEST_FILE = 1 << 16  # bytes; parsers of nested text take many times as much

_MILLIMETRES = {"m": 1000.0, "cm": 10.0, "mm": 1.0, "um": 0.001, "µm": 0.001}


@dataclass(frozen=True)
class Patterns:
    """Paths relative to the folder, with one star for the frame's name in each."""

    color: str = "rgb_*.png"
    depth: str = "depth_*.png"
    label: str = "label_*.png"
    mask: str = "mask_*.png"


@dataclass(frozen=True)
class Camera:
    """A pinhole camera and its images; the module's text says what each field means.

    depth_unit: mm of one count.
    background: a label, as `baker.scans.rgbd.images.read_labels` numbers them.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    width: int | None = None
    height: int | None = None
    depth_unit: float = 1.0
    crop: tuple[int, int] | None = None
    ground: float | None = None
    background: int = 0
    per_day: int = 6
    images: Patterns = field(default_factory=Patterns)
    repair: RepairOptions = field(default_factory=RepairOptions)


def find_camera(folder: Path) -> Path | None:
    """The camera's file in `folder`, or None where it holds no images to read."""
    with asking(folder):
        return next((folder / name for name in CAMERA_FILES if (folder / name).is_file()), None)


def read_camera(path: Path) -> Camera:
    """Raises InputError: not TOML or JSON, a field missing, unknown, or with a senseless value."""
    table = _Table(path, "", _parse(path))
    table.require_known([field.name for field in fields(Camera)])
    return Camera(
        fx=table.number("fx", above=0),
        fy=table.number("fy", above=0),
        cx=table.number("cx"),
        cy=table.number("cy"),
        width=table.optional("width", table.whole, 1),
        height=table.optional("height", table.whole, 1),
        depth_unit=_depth_unit(table),
        crop=table.optional("crop", table.pixel),
        ground=table.optional("ground", table.number, 0),
        background=_background(table),
        per_day=table.whole("per_day", 1, default=6),
        images=_patterns(table.inner("images")),
        repair=_repair(table.inner("repair")),
    )


class _Table:
    """One table of the file, whose values are checked as they are taken."""

    def __init__(self, path: Path, name: str, values: Mapping[str, Any]) -> None:
        self.path = path
        self.name = name
        self.values = values

    def require_known(self, names: list[str]) -> None:
        for name in self.values:
            if name not in names:
                raise InputError(
                    f"'{self.path}' has an unknown field '{self.name}{excerpt(name)}'; known are "
                    f"{', '.join(names)}."
                )

    def number(self, name: str, above: float | None = None, default: float | None = None) -> float:
        value = self._get(name, default)
        sound = isinstance(value, int | float) and not isinstance(value, bool)
        if not sound or value != value or (above is not None and value <= above):
            limit = "" if above is None else f" above {above:g}"
            raise self.wrong(name, f"a number{limit}")
        if abs(value) > LARGEST or (above is not None and value < SMALLEST):
            raise self.wrong(name, f"a number from {SMALLEST:g} to {LARGEST:g}")
        return float(value)

    def whole(
        self, name: str, least: int, default: int | None = None, most: int | None = None
    ) -> int:
        value = self._get(name, default)
        sound = isinstance(value, int) and not isinstance(value, bool)
        if not sound or not least <= value <= (most or LARGEST):
            limit = f"{least} to {most}" if most else f"{least} or more"
            raise self.wrong(name, f"a whole number, {limit}")
        return int(value)

    def pixel(self, name: str) -> tuple[int, int]:
        value = self._get(name)
        is_pair = isinstance(value, list) and len(value) == 2
        if not is_pair or not all(type(v) is int and 0 <= v <= LARGEST for v in value):
            raise self.wrong(name, "two whole numbers, [left, top]")
        return value[0], value[1]

    def optional(self, name: str, take: Any, *args: Any) -> Any:
        return take(name, *args) if name in self.values else None

    def inner(self, name: str) -> _Table:
        value = self.values.get(name, {})
        if not isinstance(value, dict):
            raise self.wrong(name, "a table")
        return _Table(self.path, f"{name}.", value)

    def wrong(self, name: str, allowed: str) -> InputError:
        value = self.values.get(name)
        found = "too large" if type(value) is int and value > LARGEST else repr(value)
        return InputError(
            f"'{self.path}': {self.name}{excerpt(name)} is {excerpt(found)}, but must be {allowed}."
        )

    def _get(self, name: str, default: Any = None) -> Any:
        value = self.values.get(name, default)
        if value is None:
            raise InputError(
                f"'{self.path}' lacks {self.name}{name}; a camera needs fx, fy, cx and cy, in "
                "pixels."
            )
        return value


def _parse(path: Path) -> Mapping[str, Any]:
    try:
        if path.stat().st_size > LONGEST_FILE:
            raise InputError(
                f"'{path}' has {path.stat().st_size} bytes; a camera is told in at most "
                f"{LONGEST_FILE}."
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


def _depth_unit(table: _Table) -> float:
    value = table.values.get("depth_unit", 1.0)
    if not isinstance(value, str):
        return table.number("depth_unit", above=0, default=1.0)
    match = re.fullmatch(r"\s*(\d*\.?\d*(?:e-?\d+)?)\s*([a-zµ]+)\s*", value)
    try:
        count = float(match[1] or 1) if match else 0.0
    except ValueError:
        count = 0.0
    scale = _MILLIMETRES.get(match[2]) if match else None
    if scale is None or not SMALLEST <= count * scale <= LARGEST:
        raise table.wrong("depth_unit", 'a number of mm or, like "m" or "0.125 mm", a length')
    return count * scale


def _background(table: _Table) -> int:
    value = table.values.get("background", 0)
    if isinstance(value, str) and re.fullmatch(r"#[0-9a-fA-F]{6}", value):
        return int(value[1:], 16)
    if type(value) is not int or abs(value) > LARGEST:
        raise table.wrong("background", 'a whole number or a colour such as "#000000"')
    return value


def _patterns(table: _Table) -> Patterns:
    values = asdict(Patterns())
    table.require_known(list(values))
    for name in table.values:
        value = table.values[name]
        if not isinstance(value, str) or value.count("*") != 1 or re.search(r"[?\[\]]", value):
            raise table.wrong(name, 'a file name with one *, like "rgb_*.png"')
        if Path(value).is_absolute() or ".." in Path(value).parts or "*" not in Path(value).name:
            raise table.wrong(name, "a path in the folder, with the * in the file's own name")
        values[name] = value
    return Patterns(**values)


def _repair(table: _Table) -> RepairOptions:
    usual = RepairOptions()
    table.require_known([field.name for field in fields(RepairOptions)])
    return RepairOptions(
        ring=table.whole("ring", 0, default=usual.ring, most=WIDEST),
        band=table.whole("band", 0, default=usual.band, most=WIDEST),
        jump=table.number("jump", above=0, default=usual.jump),
    )
