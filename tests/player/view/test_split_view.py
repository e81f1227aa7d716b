"""What stands beside the plant, and which organ is under the cursor."""

from dataclasses import replace

import numpy as np
import pytest

from gclip import Clip
from player.view.camera import Camera
from player.view.choices import Compare
from player.view.playback import Timeline
from player.view.split_view import (
    corresponding_day,
    paired_home_cameras,
    panes_of,
    transferred_camera,
)
from player.view.state import Scene
from player.view.style import Style
from tests.player.conftest import ClipMaker


def scene_of(clip: object, day: float, compare: Compare) -> Scene:
    camera = Camera.home(clip, 4 / 3)  # type: ignore[arg-type]
    timeline = Timeline.of(clip.times).at(day)  # type: ignore[attr-defined]
    return Scene(timeline, camera, camera, Style(), (clip,), compare=compare)


def test_the_nearest_scan_stands_beside_the_day(make_clip: ClipMaker) -> None:
    clip = make_clip()
    for day, scan in ((0.9, 0.0), (1.1, 2.0), (4.0, 5.0)):
        left, right = panes_of(scene_of(clip, day, Compare.BESIDE), ["a"])
        assert (left.day, right.day) == (scan, day)
        assert (left.left, left.right, right.left, right.right) == (0.0, 0.5, 0.5, 1.0)
        assert f"day {scan:g}" in left.caption
    assert len(panes_of(scene_of(clip, 1.0, Compare.OFF), ["a"])) == 1
    wiped = replace(scene_of(clip, 1.0, Compare.WIPE), wipe=0.3)
    left, right = panes_of(wiped, ["a"])
    assert (left.right, right.left, left.is_whole) == (0.3, 0.3, False)


def delayed(clip: Clip, days: float) -> Clip:
    scans = [replace(scan, time=scan.time + days) for scan in clip.scans]
    intervals = [replace(i, start=i.start + days, end=i.end + days) for i in clip.intervals]
    return replace(clip, scans=tuple(scans), intervals=tuple(intervals))


def test_days_of_two_series(make_clip: ClipMaker) -> None:
    clip = make_clip()
    later, next_year = delayed(clip, 1.0), delayed(clip, 365.0)
    assert corresponding_day(clip, later, 3.0) == 3.0
    assert corresponding_day(clip, later, 0.0) == 1.0
    assert corresponding_day(clip, next_year, 3.0) == 368.0
    assert corresponding_day(next_year, clip, 368.0) == 3.0


def test_the_same_plant_is_seen_from_the_same_place(make_clip: ClipMaker) -> None:
    clip = make_clip()
    moved = replace(clip, origin=(5.0, 0.0, 0.0))
    homes = (Camera.home(clip), Camera.home(moved))
    camera = homes[0].orbit(0.4, 0.1).pan(0.1, 0.2)
    seen = transferred_camera(camera, *paired_home_cameras((clip, moved), homes))
    assert np.allclose(seen.eye + moved.origin, camera.eye + clip.origin)


def test_another_plant_is_seen_from_its_own_side_at_the_same_scale(make_clip: ClipMaker) -> None:
    first, second = make_clip(), replace(make_clip(up="y"), origin=(9000.0, 0.0, 0.0))
    home, other = paired_home_cameras((first, second), (Camera.home(first), Camera.home(second)))
    seen = transferred_camera(home, home, other)
    assert seen.up == "y"
    assert seen.distance == home.distance
    assert np.allclose(seen.target, other.target)
    assert seen.yaw == pytest.approx(other.yaw)
