"""Panes of a split view: the clip beside one of its scans, or beside a second clip."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gclip import Clip
from player.view.camera import Camera, as_tuple
from player.view.choices import Compare
from player.view.state import Scene
from traits.dates import date_at
from traits.upright import upright_axes

MAX_SIZE_RATIO = 3.0  # of two plants that are shown at the same scale
SAME_PLANT_DISTANCE = 0.3  # between the targets of two clips of one plant, in scene radii


@dataclass(frozen=True)
class Pane:
    """A part of the window that shows a clip on a day."""

    clip: int  #: index of the clip in `Scene.clips`
    day: float
    camera: Camera
    left: float = 0.0  #: left and right edge, as shares of the width of all panes
    right: float = 1.0
    #: whether the pane shows a picture of its own; if not, a part of one as wide as all panes
    is_whole: bool = True
    caption: str = ""
    held_out_index: int | None = None  #: index of a held-out scan that is shown instead


def paired_home_cameras(clips: Sequence[Clip], homes: Sequence[Camera]) -> tuple[Camera, Camera]:
    """Adapt the home cameras of two clips to each other for comparison.

    Two clips of one plant are seen from the same position, and plants of similar size at the same
    scale. Other cameras are returned unchanged.
    """
    (first, second), (home, second_home) = clips, homes
    target = np.add(home.target, np.subtract(first.origin, second.origin))  # in the second clip
    small, large = sorted((home.radius, second_home.radius))
    is_similar = large < MAX_SIZE_RATIO * small
    offset = float(np.linalg.norm(target - second_home.target))
    if is_similar and offset < SAME_PLANT_DISTANCE * large and first.up == second.up:
        return home, replace(home, target=as_tuple(target))
    if is_similar:
        distance = max(home.distance, second_home.distance)
        return replace(home, distance=distance), replace(second_home, distance=distance)
    return home, second_home


def transferred_camera(camera: Camera, source: Camera, target: Camera) -> Camera:
    """The camera that relates to `target` as `camera` does to `source`.

    source, target: home cameras, for example of two clips.
    """
    scale = target.distance / source.distance
    rotation = upright_axes(target.up).T @ upright_axes(source.up)
    offset = rotation @ np.subtract(camera.target, source.target)
    return replace(
        camera,
        target=as_tuple(target.target + scale * offset),
        distance=scale * camera.distance,
        yaw=math.remainder(target.yaw + camera.yaw - source.yaw, 2.0 * math.pi),
        up=target.up,
        radius=target.radius,
    )


def panes_of(scene: Scene, names: Sequence[str]) -> tuple[Pane, ...]:
    """The panes of a scene from left to right; `names` of its clips become captions."""
    day, first = scene.timeline.day, scene.clip
    if scene.compare is Compare.OFF:
        return (Pane(0, day, scene.camera),)
    if scene.second_home is not None:
        left = Pane(0, day, scene.camera, caption=names[0])
        camera = transferred_camera(scene.camera, scene.home, scene.second_home)
        right = Pane(1, corresponding_day(first, scene.clips[1], day), camera, caption=names[1])
    else:
        left = _nearest_scan(first, day, scene.camera)
        right = Pane(0, day, scene.camera, caption=f"Now, {date_at(first.scans, day)}")
    border = scene.wipe if scene.compare is Compare.WIPE else 0.5
    whole = scene.compare is Compare.BESIDE
    return replace(left, right=border, is_whole=whole), replace(right, left=border, is_whole=whole)


def _nearest_scan(clip: Clip, day: float, camera: Camera) -> Pane:
    """A pane with the scan nearest in time, which may be a held-out one."""
    scans = [Pane(0, scan.time, camera, caption=f"Scan of {scan.date}") for scan in clip.scans]
    for index, scan in enumerate(clip.held_out):
        caption = f"Left out: scan of {scan.date}"
        scans.append(Pane(0, scan.time, camera, caption=caption, held_out_index=index))
    return min(scans, key=lambda pane: abs(pane.day - day))


def corresponding_day(first: Clip, second: Clip, day: float) -> float:
    """The day of the second clip that is compared with a day of the first one.

    It is the same day if the series overlap in time; if not, the days since the first scan agree.
    """
    (start, end), (low, high) = (clip.times[:: len(clip.times) - 1] for clip in (first, second))
    if max(start, low) < min(end, high):
        return min(max(day, low), high)
    return min(low + day - start, high)
