"""Camera paths: cameras at key times, interpolated in between, and their JSON files."""

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
from player.view.camera import Camera, as_tuple

MAX_FILE_SIZE = 1 << 20  # bytes; refuses files that are no camera path before they are parsed

Number = Annotated[float, Meta(gt=-1e300, lt=1e300)]


class Key(Struct, frozen=True):
    """A key of a camera path file: coordinates of the input files, angles in degrees."""

    day: Number
    target: tuple[Number, Number, Number]
    distance: Annotated[float, Meta(gt=0.0, lt=1e300)]
    yaw: Number
    pitch: Number
    field_of_view: Annotated[float, Meta(ge=0.1, le=150.0)]


class Document(Struct):
    """Schema of a camera path file (docs/player.md)."""

    camera_path: Literal[1]
    up: str
    keys: Annotated[list[Key], Meta(min_length=1)]


@dataclass(frozen=True)
class CameraPath:
    """An immutable sequence of (day, camera) keys in ascending order of their days."""

    keys: tuple[tuple[float, Camera], ...] = ()

    def __bool__(self) -> bool:
        return bool(self.keys)

    def with_key(self, day: float, camera: Camera) -> Self:
        """Add a key; a key of the same day is replaced."""
        keys = dict(self.keys) | {day: camera}
        return type(self)(tuple(sorted(keys.items(), key=lambda key: key[0])))

    def at(self, day: float) -> Camera:
        """Interpolate the camera on a day; outside the keys it is that of the nearest key.

        Modified Akima splines pass through every key with a continuous velocity, and hardly
        overshoot (Akima 1970).
        """
        (first, camera), (last, _) = self.keys[0], self.keys[-1]
        if len(self.keys) == 1:
            return camera
        values = self._spline(min(max(day, first), last)).tolist()
        *target, log_distance, yaw, pitch, log_slope = values
        return replace(
            camera,
            target=as_tuple(target),
            distance=math.exp(log_distance),
            yaw=math.remainder(yaw, 2.0 * math.pi),
            pitch=pitch,
            field_of_view=2.0 * math.atan(math.exp(log_slope)),
        )

    @cached_property
    def _spline(self) -> Callable[[float], NDArray[np.float64]]:
        from scipy.interpolate import Akima1DInterpolator

        days, cameras = zip(*self.keys, strict=True)
        yaws = np.unwrap([camera.yaw for camera in cameras])  # turn by at most half a circle
        values = [
            (*c.target, math.log(c.distance), yaw, c.pitch, math.log(math.tan(c.field_of_view / 2)))
            for c, yaw in zip(cameras, yaws, strict=True)
        ]
        return Akima1DInterpolator(days, values, method="makima")


def save_path(path: CameraPath, clip: Clip, file: Path) -> None:
    """Write a JSON file (docs/player.md) atomically; raises UserError if that is impossible."""
    keys = []
    for day, camera in path.keys:
        angles = map(math.degrees, (camera.yaw, camera.pitch, camera.field_of_view))
        target = as_tuple(np.add(camera.target, clip.origin))
        keys.append(Key(day, target, camera.distance, *angles))
    text = msgspec.json.encode(Document(1, clip.up, keys))
    with atomic_file(file) as part:
        part.write_bytes(msgspec.json.format(text, indent=1) + b"\n")


def load_path(file: Path, clip: Clip) -> CameraPath:
    """Read a JSON file; raises UserError, which names the invalid field, if it does not fit."""
    document = read_config(file, Document, MAX_FILE_SIZE)
    if document.up != clip.up:
        raise PlayerError(f"{file}: up is {document.up[:20]!r}; the clip's is {clip.up!r}.")
    if len({key.day for key in document.keys}) < len(document.keys):
        raise PlayerError(f"{file}: two keys have the same day.")
    home, keys = Camera.home(clip), []
    for key in sorted(document.keys, key=lambda key: key.day):
        target = as_tuple(np.subtract(key.target, clip.origin))
        angle = math.radians(key.field_of_view)
        camera = replace(home, target=target, distance=key.distance, field_of_view=angle)
        keys.append((key.day, camera.looking_from(math.radians(key.yaw), math.radians(key.pitch))))
    return CameraPath(tuple(keys))
