"""The camera keeps the plant in the picture and its up axis upright."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion
from gclip.evaluate import positions_on_curve
from player.view.camera import Camera, sampled_positions
from tests.player.drawn import fitted
from tests.player.shown import small_clip
from traits.upright import upright_axes

UP_AXES = ("x", "y", "z", "-x", "-y", "-z")

BOX = (np.array([-3.0, 10.0, 5.0]), np.array([9.0, 12.0, 40.0]))


def on_screen(camera: Camera, points: np.ndarray, aspect: float) -> np.ndarray:
    """(n, 3) normalised device coordinates."""
    columns = np.column_stack([points, np.ones(len(points))]).T
    seen = camera.projection(aspect) @ camera.view() @ columns
    return (seen[:3] / seen[3]).T


def corners() -> np.ndarray:
    return np.array(
        [[BOX[i][0], BOX[j][1], BOX[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    )


@pytest.mark.parametrize("up", UP_AXES)
def test_axes_are_a_rotation(up: str) -> None:
    frame = upright_axes(up)
    assert np.allclose(frame @ frame.T, np.eye(3))
    assert np.linalg.det(frame) == pytest.approx(1.0)


@pytest.mark.parametrize("up", UP_AXES)
@given(yaw=st.floats(-7, 7), aspect=st.floats(0.3, 3.0))
def test_a_fitted_box_is_in_the_picture_from_every_yaw(up: str, yaw: float, aspect: float) -> None:
    camera = fitted(BOX, up, aspect).orbit(yaw, 0.0)
    assert np.abs(on_screen(camera, corners(), aspect)).max() <= 1.0


@given(yaw=st.floats(-7, 7), pitch=st.floats(-7, 7))
def test_up_points_up_and_the_target_stays_in_the_middle(yaw: float, pitch: float) -> None:
    camera = fitted(BOX).orbit(yaw, pitch)
    target = np.array([camera.target])
    assert np.allclose(on_screen(camera, target, 1.5)[0, :2], 0.0, atol=1e-9)
    assert on_screen(camera, target + np.array([0, 0, 1]), 1.5)[0, 1] > 0.0
    assert np.linalg.norm(camera.eye - target) == pytest.approx(camera.distance)


def test_pan_moves_the_picture_by_shares_of_its_height() -> None:
    camera = fitted(BOX)
    target = np.array([camera.target])
    assert np.allclose(on_screen(camera.pan(0.1, 0.2), target, 2.0)[0, :2], [0.1, 0.4])


def test_zoom_comes_nearer_and_never_through_the_target() -> None:
    camera = fitted(BOX)
    assert camera.zoom(2.0).distance == pytest.approx(camera.distance / 2)
    nearest = camera.zoom(1e9)
    assert nearest.distance > 0.0
    assert 0.0 < nearest.near < nearest.distance < nearest.far


def test_a_turntable_goes_round_the_stem(make_clip) -> None:
    clip = make_clip()
    first = clip.at(clip.times[0])
    target = np.array(Camera.home(clip, turning=True).target)
    np.testing.assert_allclose(target[:2], np.median(first.local[first.tracks == 0], axis=0)[:2])
    # From every side the stem's line is upright in the middle of the picture.
    line = target + np.array([[0.0, 0, -1], [0, 0, 1]])
    for yaw in (0.0, 1.0, 4.0):
        camera = Camera.home(clip, turning=True).orbit(yaw, 0)
        np.testing.assert_allclose(on_screen(camera, line, 1.0)[:, 0], 0.0, atol=1e-9)


def test_a_camera_is_found_from_a_sample_of_many_movers(monkeypatch) -> None:
    stem, leaf = (np.random.default_rng(0).random((100_000, 3)) for _ in range(2))
    points = np.concatenate([stem * [0.1, 0.1, 9.0], leaf * [5.0, 5.0, 1.0]])
    movers = Movers(Motion.MOVE, (points, points), np.repeat([0, 1], 100_000))
    interval = pack_interval(0.0, 1.0, [movers], spacing=0.1)
    clip = replace(small_clip(["a", "b"], [0.0, 1.0]), intervals=(interval,))
    evaluated = []

    def counted(interval, some, parameter):
        found = positions_on_curve(interval, some, parameter)
        evaluated.append(len(found))
        return found

    monkeypatch.setattr("player.view.camera.positions_on_curve", counted)
    monkeypatch.setattr(Clip, "at", None)
    assert Camera.home(clip, turning=True).target[:2] == pytest.approx((0.05, 0.05), abs=0.01)
    assert sum(evaluated) < 80_000


@pytest.mark.parametrize("aspect", [0.6, 1.0, 16 / 9])
@pytest.mark.parametrize("up", ["z", "-y"])
def test_home_shows_the_whole_clip_and_fills_the_picture(make_clip, aspect: float, up: str) -> None:
    clip = make_clip(up=up)
    points = sampled_positions(clip) @ upright_axes(up)
    close = np.abs(on_screen(Camera.home(clip, aspect), points, aspect)[:, :2])
    assert 0.8 < close.max() < 1.0
    turning = Camera.home(clip, aspect, turning=True)
    for yaw in np.linspace(0, 2 * math.pi, 12):
        assert np.abs(on_screen(turning.orbit(yaw, 0), points, aspect)[:, :2]).max() <= 1.0


@pytest.mark.parametrize("factor", [0.5, 1.3, 4.0])
def test_zooming_keeps_what_is_under_the_cursor(factor: float) -> None:
    camera = fitted(BOX).orbit(0.3, 0.2)
    right, up = 0.21, -0.33
    matrix = camera.projection(1.5) @ camera.view()
    # A point at the target's depth, under the cursor.
    height = 2.0 * camera.distance * np.tan(camera.field_of_view / 2)
    point = np.asarray(camera.target) + camera.view()[:3, :3].T @ [right * height, up * height, 0.0]
    nearer = camera.zoom_at(factor, right, up)
    for seen in (matrix, nearer.projection(1.5) @ nearer.view()):
        x, y, _, w = seen @ [*point, 1.0]
        assert (x / w * 1.5 / 2, y / w / 2) == pytest.approx((right, up), abs=1e-9)


def test_parallels_stay_parallel_in_the_flat_view() -> None:
    camera = fitted(BOX)
    flat = camera.with_orthographic(True)
    assert flat.orthographic
    assert not camera.orthographic
    back = flat.with_orthographic(False)
    assert back.distance == pytest.approx(camera.distance)
    shares = []
    for seen in (camera, flat):
        matrix = seen.projection(1.0) @ seen.view()
        widths = []
        for away in (-5.0, 5.0):
            middle = np.asarray(seen.target) + away * seen.view()[2, :3]
            ends = [matrix @ [*(middle + side * seen.view()[0, :3]), 1.0] for side in (-0.5, 0.5)]
            widths.append(ends[1][0] / ends[1][3] - ends[0][0] / ends[0][3])
        shares.append(widths[1] / widths[0])
    assert shares[0] > 1.05
    assert shares[1] == pytest.approx(1.0, abs=1e-12)
