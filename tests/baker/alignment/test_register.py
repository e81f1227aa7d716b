"""Series are brought into the first scan's frame, whatever way their scans lay."""

import numpy as np
import pytest

from baker.alignment.register import align
from baker.geometry.up_axis import Vertical
from tests.baker.series import series_of


def moved(transform: np.ndarray, points: np.ndarray) -> np.ndarray:
    return points @ transform[:3, :3].T + transform[:3, 3]


def yaw(transform: np.ndarray) -> float:
    return float(np.degrees(np.arctan2(transform[1, 0], transform[0, 0])))


def test_scattered_scans_come_back(days, scattered):
    found = align(series_of(scattered))
    assert found.up == "z"
    for transform, cloud, there in zip(found.transforms, scattered, days, strict=True):
        size = np.ptp(there[:, 2])
        error = np.linalg.norm(moved(transform, cloud) - there, axis=1)
        assert error.max() < 0.03 * size


@pytest.mark.parametrize("up", ["x", "y", "-x", "-y", "-z"])
def test_in_any_orientation(days, scattered, up):
    turn = Vertical.named(up).to_z.T
    clouds = [cloud @ turn.T for cloud in scattered]
    found = align(series_of(clouds, ground_up=up))
    assert found.up == up
    for transform, cloud, there in zip(found.transforms, scattered, days, strict=True):
        error = np.linalg.norm(moved(transform, cloud @ turn.T) - there @ turn.T, axis=1)
        assert error.max() < 0.03 * np.ptp(there[:, 2])
    guessed = align(series_of(clouds))
    assert guessed.up == up or guessed.findings[0].option == f"--up {up}"


def test_what_is_told_of_the_moves(scattered):
    found = align(series_of(scattered))
    assert np.array_equal(found.transforms[0], np.eye(4))
    up, frame = found.findings
    assert (up.topic, up.doubt) == ("up", "")
    assert (frame.topic, frame.option) == ("frame", "--align none")
    assert "scan 3 was moved by 46" in frame.doubt


def test_transforms_are_rigid_and_keep_the_vertical(scattered):
    for transform in align(series_of(scattered)).transforms:
        assert np.allclose(transform[:3, :3] @ transform[:3, :3].T, np.eye(3))
        assert np.linalg.det(transform[:3, :3]) == pytest.approx(1.0)
        assert np.allclose(transform[2, :3], [0.0, 0.0, 1.0])


def test_aligned_scans_stay_exactly(days):
    found = align(series_of(days))
    assert all(np.array_equal(transform, np.eye(4)) for transform in found.transforms)
    assert not any(finding.doubt for finding in found.findings)


def test_a_turntable_is_not_taken_for_one_frame(days, posed):
    turned = [posed(cloud, yaw, (0, 0, 0)) for cloud, yaw in zip(days, (0, 60, 170), strict=True)]
    found = align(series_of(turned))
    assert abs(yaw(found.transforms[1]) + 60.0) < 2.0


def test_a_leaf_that_turns_does_not_turn_the_plant(plant, posed):
    before, after = plant(0), plant(1, turned={2: -50.0})
    found = align(series_of([before, posed(after, 90.0, (20, 0, 0))]))
    assert abs(yaw(found.transforms[1]) + 90.0) < 3.0


def test_a_tip_that_hangs_lower_is_not_the_base(days, posed):
    along = np.linspace(0.0, 1.0, 300)[:, None]
    rng = np.random.default_rng(0)
    bow = np.concatenate(
        [
            [0.0, 0.0, 20.0] + along * [25.0, 25.0, 10.0],
            [25.0, 25.0, 30.0] + along * [5.0, 5.0, -33.0],
        ]
    )
    later = np.concatenate([days[1], bow + rng.normal(0.0, 0.3, bow.shape)])
    found = align(series_of([days[0], posed(later, 45.0, (7, 8, 9))]))
    assert np.linalg.norm(moved(found.transforms[1], np.array([7.0, 8.0, 9.0]))) < 2.0


def test_a_known_root_is_used(scattered):
    found = align(series_of(scattered), root=np.array([10.0, 0.0, 0.0]))
    free = align(series_of(scattered))
    offset = found.transforms[1][:3, 3] - free.transforms[1][:3, 3]
    assert np.linalg.norm(offset) > 5.0


def test_none_moves_nothing(scattered):
    found = align(series_of(scattered), method="none", up="-y")
    assert found.up == "-y"
    assert all(np.array_equal(transform, np.eye(4)) for transform in found.transforms)


def test_icp_undoes_a_small_motion(days, posed):
    later = posed(days[0], 4.0, (0.5, -0.5, 0.3))
    found = align(series_of([days[0], later]), method="icp")
    assert np.linalg.norm(moved(found.transforms[1], later) - days[0], axis=1).max() < 0.2


def test_same_scans_same_transforms(scattered):
    first, second = align(series_of(scattered)), align(series_of(scattered))
    assert [t.tobytes() for t in first.transforms] == [t.tobytes() for t in second.transforms]
    assert first.findings == second.findings


def test_progress_counts_up_to_the_end(days):
    seen: list[tuple[int, int]] = []
    align(series_of(days), progress=lambda stage, done, total: seen.append((done, total)))
    assert [done for done, _ in seen] == sorted({done for done, _ in seen})
    assert seen[-1][0] == seen[-1][1]


DEGENERATE = {
    "a point": np.zeros((1, 3)),
    "two points": np.eye(3)[:2],
    "three points": np.eye(3),
    "one place": np.ones((40, 3)),
    "a line": np.outer(np.arange(50.0), [0.0, 0.0, 1.0]),
    "a slanting line": np.outer(np.arange(50.0), [1.0, 2.0, 3.0]),
    "a plane": np.random.default_rng(0).random((200, 3)) * [1.0, 1.0, 0.0],
    "nearly nothing": np.random.default_rng(0).random((200, 3)) * 1e-12,
}


@pytest.mark.parametrize("method", ["auto", "icp", "none"])
@pytest.mark.parametrize("kind", DEGENERATE)
def test_degenerate_clouds_pass(kind, method, days):
    cloud = DEGENERATE[kind]
    for series in ([cloud, cloud + 3.0], [cloud, days[0][::9], cloud]):
        found = align(series_of(series), method=method)
        for transform in found.transforms:
            assert np.isfinite(transform).all()
            assert np.allclose(transform[:3, :3] @ transform[:3, :3].T, np.eye(3))
