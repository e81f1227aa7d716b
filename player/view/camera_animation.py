"""Camera paths: the camera on some days, and smoothly in between; kept in JSON files."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, Self

import msgspec
import numpy as np
from msgspec import Meta, Struct
from numpy.typing import NDArray

from gclip import Clip
from gclip.config_file import read_config
from gclip.terminal.atomic import atomic_file
from player.errors import PlayerError
from player.view.camera import Camera, triple

MAX_KEYS = 10_000  # more are no path that someone made
MAX_FILE_SIZE = 1 << 22  # bytes

Number = Annotated[float, Meta(gt=-1e300, lt=1e300)]


class Key(Struct, frozen=True):
    """A camera on a day, as the file tells it: in the input's own frame, angles in degrees."""

    day: Number
    target: tuple[Number, Number, Number]
    distance: Annotated[float, Meta(gt=0.0, lt=1e300)]
    yaw: Number
    pitch: Number
    field_of_view: Annotated[float, Meta(ge=0.1, le=150.0)]

    def camera(self, home: Camera, clip: Clip) -> Camera:
        """The clip's own camera; home: any of its cameras."""
        target = triple(np.subtract(self.target, clip.origin))
        view = math.radians(self.field_of_view)
        camera = replace(home, target=target, distance=self.distance, field_of_view=view)
        return camera.looking(math.radians(self.yaw), math.radians(self.pitch))


class Document(Struct):
    """The file."""

    camera_path: Literal[1]
    up: str
    keys: Annotated[list[Key], Meta(min_length=1, max_length=MAX_KEYS)]


@dataclass(frozen=True)
class CameraPath:
    """Cameras at moments of the series, by ascending day; every change gives a new path."""

    keys: tuple[tuple[float, Camera], ...] = ()

    def __bool__(self) -> bool:
        return bool(self.keys)

    def with_key(self, day: float, camera: Camera) -> Self:
        """Add a key, in the place of one of the same day."""
        others = [key for key in self.keys if key[0] != day]
        return type(self)(tuple(sorted([*others, (day, camera)], key=lambda key: key[0])))

    def at(self, day: float) -> Camera:
        """The camera on a day: passes through every key, without a jerk (Akima 1970, in scipy's
        modified form, which does not overshoot); before the first key and after the last it rests.
        """
        first, last = self.keys[0], self.keys[-1]
        if len(self.keys) == 1:
            return first[1]
        values = self._curve(min(max(day, first[0]), last[0]))
        target, (away, yaw, pitch, view) = values[:3], values[3:]
        return replace(
            first[1],
            target=triple(target),
            distance=math.exp(away),
            yaw=math.remainder(yaw, 2.0 * math.pi),
            pitch=float(pitch),
            field_of_view=2.0 * math.atan(math.exp(view)),
        )

    @cached_property
    def _curve(self) -> Callable[[float], NDArray[np.float64]]:
        from scipy.interpolate import Akima1DInterpolator

        days = np.array([day for day, _ in self.keys])
        cameras = [camera for _, camera in self.keys]
        yaws = np.unwrap([camera.yaw for camera in cameras])  # the short way round
        values = [
            (*c.target, math.log(c.distance), yaw, c.pitch, math.log(math.tan(c.field_of_view / 2)))
            for c, yaw in zip(cameras, yaws, strict=True)
        ]
        return Akima1DInterpolator(days, np.array(values), method="makima")


def save_path(path: CameraPath, clip: Clip, file: Path) -> None:
    """Write a path (docs/player.md): targets in the input's own frame, angles in degrees.

    Whole or not at all; raises PlayerError where `file` can't be written.
    """
    keys = []
    for day, camera in path.keys:
        angles = map(math.degrees, (camera.yaw, camera.pitch, camera.field_of_view))
        keys.append(Key(day, triple(np.add(camera.target, clip.origin)), camera.distance, *angles))
    text = msgspec.json.encode(Document(1, clip.up, keys))
    with atomic_file(file) as part:
        part.write_bytes(msgspec.json.format(text, indent=1) + b"\n")


def load_path(file: Path, clip: Clip) -> CameraPath:
    """Read a path for a clip. Raises UserError naming the file and the field that is wrong."""
    document = read_config(file, Document, MAX_FILE_SIZE)
    if document.up != clip.up:
        raise PlayerError(f"{file}: up is {document.up[:20]!r}; the clip's is {clip.up!r}.")
    home, keys = Camera.home(clip), sorted(document.keys, key=lambda key: key.day)
    if len({key.day for key in keys}) < len(keys):
        raise PlayerError(f"{file}: two keys have the same day.")
    return CameraPath(tuple((key.day, key.camera(home, clip)) for key in keys))
