"""Scans that stand in one frame are left there, whatever single scans did."""

import numpy as np
import pytest

from baker.alignment import Alignment, align


@pytest.fixture(scope="module")
def week(plant) -> list[np.ndarray]:
    return [plant(day)[::2] for day in range(5)]


def aligned(clouds: list[np.ndarray]) -> Alignment:
    return align([cloud.astype(np.float32) for cloud in clouds], up="z")


def farthest(transform: np.ndarray, cloud: np.ndarray, there: np.ndarray) -> float:
    moved = cloud @ transform[:3, :3].T + transform[:3, 3]
    return float(np.linalg.norm(moved - there, axis=1).max())


@pytest.mark.parametrize(
    ("number", "shift"),
    [(1, (25.0, -10.0, 6.0)), (2, (0.0, 0.0, 0.0)), (4, (-3.0, 8.0, 0.0))],
)
def test_one_scan_that_jumped_is_brought_back_and_the_others_stay(week, posed, number, shift):
    jumped = [posed(each, 130.0, shift) if at == number else each for at, each in enumerate(week)]
    found = aligned(jumped)
    for at, transform in enumerate(found.transforms):
        assert np.array_equal(transform, np.eye(4)) == (at != number)
    assert farthest(found.transforms[number], jumped[number], week[number]) < 3.0
    assert f"scan {number + 1}" in " ".join(found.notes)


def test_where_the_first_scan_jumped_the_others_follow_it_together(week, posed):
    first = posed(week[0], -70.0, (9.0, 4.0, 2.0))
    found = aligned([first, *week[1:]])
    assert np.array_equal(found.transforms[0], np.eye(4))
    for transform in found.transforms[2:]:
        assert np.array_equal(transform, found.transforms[1])
    assert farthest(np.linalg.inv(found.transforms[1]), first, week[0]) < 3.0


def test_an_organ_that_turned_is_no_jump(week, plant):
    turned = [*week[:2], plant(2, turned={3: 60.0})[::2], *week[3:]]
    assert all(np.array_equal(each, np.eye(4)) for each in aligned(turned).transforms)


def test_two_scans_apart_are_no_series_in_one_frame(week, posed):
    found = aligned([week[0], posed(week[1], 80.0, (0.0, 0.0, 0.0))])
    assert abs(found.drift[0].yaw + 80.0) < 2.0
