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

MAX_FILE_SIZE = 1 << 20  # bytes; more are no path that someone made

Number = Annotated[float, Meta(gt=-1e300, lt=1e300)]


class Key(Struct, frozen=True):
    """A camera on a day, as the file tells it: in the input's own frame, angles in degrees."""

    day: Number
    target: tuple[Number, Number, Number]
    distance: Annotated[float, Meta(gt=0.0, lt=1e300)]
    yaw: Number
    pitch: Number
    field_of_view: Annotated[float, Meta(ge=0.1, le=150.0)]


class Document(Struct):
    """The file."""

    camera_path: Literal[1]
    up: str
    keys: Annotated[list[Key], Meta(min_length=1)]


@dataclass(frozen=True)
class CameraPath:
    """Cameras at moments of the series, by ascending day; every change gives a new path."""

    keys: tuple[tuple[float, Camera], ...] = ()

    def __bool__(self) -> bool:
        return bool(self.keys)

    def with_key(self, day: float, camera: Camera) -> Self:
        """Add a key, in the place of one of the same day."""
        keys = dict(self.keys) | {day: camera}
        return type(self)(tuple(sorted(keys.items(), key=lambda key: key[0])))

    def at(self, day: float) -> Camera:
        """The camera on a day: passes through every key, without a jerk (Akima 1970, in scipy's
        modified form, which does not overshoot); before the first key and after the last it rests.
        """
        (first, camera), (last, _) = self.keys[0], self.keys[-1]
        if len(self.keys) == 1:
            return camera
        *target, away, yaw, pitch, view = self._curve(min(max(day, first), last)).tolist()
        return replace(
            camera,
            target=triple(target),
            distance=math.exp(away),
            yaw=math.remainder(yaw, 2.0 * math.pi),
            pitch=pitch,
            field_of_view=2.0 * math.atan(math.exp(view)),
        )

    @cached_property
    def _curve(self) -> Callable[[float], NDArray[np.float64]]:
        from scipy.interpolate import Akima1DInterpolator

        days, cameras = zip(*self.keys, strict=True)
        yaws = np.unwrap([camera.yaw for camera in cameras])  # the short way round
        values = [
            (*c.target, math.log(c.distance), yaw, c.pitch, math.log(math.tan(c.field_of_view / 2)))
            for c, yaw in zip(cameras, yaws, strict=True)
        ]
        return Akima1DInterpolator(days, values, method="makima")


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
    if len({key.day for key in document.keys}) < len(document.keys):
        raise PlayerError(f"{file}: two keys have the same day.")
    home, keys = Camera.home(clip), []
    for key in sorted(document.keys, key=lambda key: key.day):
        target, view = triple(np.subtract(key.target, clip.origin)), math.radians(key.field_of_view)
        camera = replace(home, target=target, distance=key.distance, field_of_view=view)
        keys.append((key.day, camera.looking(math.radians(key.yaw), math.radians(key.pitch))))
    return CameraPath(tuple(keys))
