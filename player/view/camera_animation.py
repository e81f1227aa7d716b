"""Camera paths: the camera on some days, and smoothly in between; kept in JSON files."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from player.atomic_write import whole_file
from player.errors import PlayerError
from player.view.camera import Camera

if TYPE_CHECKING:
    from collections.abc import Callable

    from gclip import Clip

FIELDS = ("day", "target", "distance", "yaw", "pitch", "field_of_view")
MOST = 10_000  # keys; more are no path that someone made
LARGEST_FILE = 1 << 24  # bytes


@dataclass(frozen=True)
class CameraPath:
    """Cameras at moments of the series, by ascending day; every change gives a new path."""

    keys: tuple[tuple[float, Camera], ...] = ()

    def __bool__(self) -> bool:
        return bool(self.keys)

    def with_key(self, day: float, camera: Camera) -> CameraPath:
        """Add a key, in the place of one of the same day."""
        others = [key for key in self.keys if key[0] != day]
        return CameraPath(tuple(sorted([*others, (day, camera)], key=lambda key: key[0])))

    def without_key(self, day: float) -> CameraPath:
        """Leave out the key nearest to a day."""
        nearest = min(self.keys, key=lambda key: abs(key[0] - day), default=None)
        return CameraPath(tuple(key for key in self.keys if key is not nearest))

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
            target=(float(target[0]), float(target[1]), float(target[2])),
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
    keys = [
        {
            "day": day,
            "target": (np.asarray(camera.target) + clip.origin).tolist(),
            "distance": camera.distance,
            "yaw": math.degrees(camera.yaw),
            "pitch": math.degrees(camera.pitch),
            "field_of_view": math.degrees(camera.field_of_view),
        }
        for day, camera in path.keys
    ]
    text = json.dumps({"camera_path": 1, "up": clip.up, "keys": keys}, indent=1) + "\n"
    with whole_file(file) as part:
        part.write_text(text, "utf-8")


def load_path(file: Path, clip: Clip) -> CameraPath:
    """Read a path for a clip. Raises PlayerError naming the file and the field that is wrong."""
    try:
        if not file.is_file() and file.exists():
            raise PlayerError(f"{file} is not a regular file.")
        if file.stat().st_size > LARGEST_FILE:
            raise PlayerError(f"{file} is too large for a camera path.")
        document = json.loads(file.read_text("utf-8"))
    except OSError as error:
        raise PlayerError(f"{file} can't be read: {error.strerror or error}.") from None
    except (ValueError, RecursionError):
        raise PlayerError(f"{file} is not valid JSON, as a camera path is.") from None
    if not isinstance(document, dict) or document.get("camera_path") != 1:
        raise PlayerError(f'{file} is no camera path: "camera_path": 1 is missing.')
    if document.get("up") != clip.up:
        raise PlayerError(
            f"{file}: up is {str(document.get('up'))[:20]!r}; the clip's is {clip.up!r}."
        )
    entries = document.get("keys")
    if not isinstance(entries, list) or not 1 <= len(entries) <= MOST:
        raise PlayerError(f"{file}: keys must be a list of 1 to {MOST} keys.")
    home, path = Camera.home(clip), CameraPath()
    for number, entry in enumerate(entries):
        day, camera = _key(entry, f"{file}: keys[{number}]", clip, home)
        path = CameraPath((*path.keys, (day, camera)))
    ordered = tuple(sorted(path.keys, key=lambda key: key[0]))
    if len({day for day, _ in ordered}) < len(ordered):
        raise PlayerError(f"{file}: two keys have the same day.")
    return CameraPath(ordered)


def _key(entry: Any, place: str, clip: Clip, home: Camera) -> tuple[float, Camera]:
    if not isinstance(entry, dict):
        raise PlayerError(f"{place} is not an object.")
    values = {name: _numbers(entry, name, place) for name in FIELDS}
    target = np.array(values["target"]) - clip.origin
    distance, view = values["distance"][0], values["field_of_view"][0]
    if distance <= 0.0:
        raise PlayerError(f"{place}.distance is {distance:g}; a length above 0 is needed.")
    if not 0.1 <= view <= 150.0:
        raise PlayerError(f"{place}.field_of_view is {view:g}; 0.1 to 150 degrees are allowed.")
    camera = replace(
        home,
        target=(float(target[0]), float(target[1]), float(target[2])),
        distance=distance,
        field_of_view=math.radians(view),
    )
    yaw, pitch = math.radians(values["yaw"][0]), math.radians(values["pitch"][0])
    return values["day"][0], camera.looking(yaw, pitch)


def _numbers(entry: dict[str, Any], name: str, place: str) -> list[float]:
    count = 3 if name == "target" else 1
    found = entry.get(name)
    values: list[Any] = found if isinstance(found, list) else [found]
    if len(values) != count or not all(_is_number(value) for value in values):
        wanted = "three finite numbers" if count == 3 else "a finite number"
        raise PlayerError(f"{place}.{name} is {str(found)[:30]}; {wanted} is needed.")
    return [float(value) for value in values]


def _is_number(value: Any) -> bool:
    return (
        isinstance(value, int | float)
        and not isinstance(value, bool)
        and abs(value) < 1e300
        and math.isfinite(value)
    )
