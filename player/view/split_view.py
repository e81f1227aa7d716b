"""What stands beside the plant: one of its scans, or another clip in step. No graphics."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gclip import Clip
from player.view.camera import Camera, axes, triple
from player.view.choices import Compare
from player.view.dates import date_at
from player.view.state import Scene

ALIKE = 3.0  # how many times as large another plant may be to be shown at the same scale
NEAR = 0.3  # of its radius: how near plants stand to count as the same one


@dataclass(frozen=True)
class Pane:
    """A part of the window that shows a clip on a day."""

    clip: int  #: its number among those shown
    day: float
    camera: Camera
    left: float = 0.0  #: where the part begins, and ends, in shares of the width
    right: float = 1.0
    #: the part holds a whole picture; else it is cut out of one as wide as all of them
    own: bool = True
    caption: str = ""  #: what is seen there, "" where there is nothing to tell
    #: number of the scan that is seen instead, of those left out of the clip
    left_out: int | None = None


def paired_homes(clips: Sequence[Clip], homes: Sequence[Camera]) -> tuple[Camera, Camera]:
    """Of two clips the cameras that show them alike: the same plant from the same place, others of
    like size at the same scale.

    homes: of each clip the camera that shows all of it.
    """
    (first, second), (home, other) = clips, homes
    target = np.add(home.target, np.subtract(first.origin, second.origin))  # in the second clip
    small, large = sorted((home.radius, other.radius))
    alike, apart = large < ALIKE * small, float(np.linalg.norm(target - other.target))
    if alike and apart < NEAR * large and first.up == second.up:
        return home, replace(home, target=triple(target))
    if alike:
        farther = max(home.distance, other.distance)
        return replace(home, distance=farther), replace(other, distance=farther)
    return home, other


def transferred(camera: Camera, home: Camera, other: Camera) -> Camera:
    """The camera that is to `other` as `camera` is to `home`."""
    scale = other.distance / home.distance
    moved = axes(other.up).T @ axes(home.up) @ np.subtract(camera.target, home.target)
    return replace(
        camera,
        target=triple(other.target + scale * moved),
        distance=scale * camera.distance,
        yaw=math.remainder(other.yaw + camera.yaw - home.yaw, 2.0 * math.pi),
        up=other.up,
        radius=other.radius,
    )


def panes_of(scene: Scene, names: Sequence[str]) -> tuple[Pane, ...]:
    """The panes of a scene, from left to right; names: of its clips."""
    day, first = scene.timeline.day, scene.clip
    if scene.compare is Compare.OFF:
        return (Pane(0, day, scene.camera),)
    if scene.other_home is not None:
        left = Pane(0, day, scene.camera, caption=names[0])
        camera = transferred(scene.camera, scene.home, scene.other_home)
        right = Pane(1, matched_day(first, scene.clips[1], day), camera, caption=names[1])
    else:
        left = _nearest_scan(first, day, scene.camera)
        right = Pane(0, day, scene.camera, caption=f"Now, {date_at(first.scans, day)}")
    cut = scene.wipe if scene.compare is Compare.WIPE else 0.5
    own = scene.compare is Compare.BESIDE
    return replace(left, right=cut, own=own), replace(right, left=cut, own=own)


def _nearest_scan(clip: Clip, day: float, camera: Camera) -> Pane:
    """The scan nearest in time, be it one that was left out."""
    scans = [Pane(0, scan.time, camera, caption=f"Scan of {scan.date}") for scan in clip.scans]
    for number, held in enumerate(clip.held_out):
        caption = f"Left out: scan of {held.date}"
        scans.append(Pane(0, held.time, camera, caption=caption, left_out=number))
    return min(scans, key=lambda pane: abs(pane.day - day))


def matched_day(first: Clip, second: Clip, day: float) -> float:
    """The day of another clip that goes with one of the first: the same where the series overlap,
    else as long after its own first scan.
    """
    (begin, end), (low, high) = (clip.times[:: len(clip.times) - 1] for clip in (first, second))
    if max(begin, low) < min(end, high):
        return min(max(day, low), high)
    return min(low + day - begin, high)
