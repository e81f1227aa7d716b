"""The plant base: the lowest point that is no outlier, and on which most scans agree."""

from __future__ import annotations

import numpy as np
import pytest

from baker.alignment.stem_base import agreed_base_points, base_point
from baker.geometry.up_axis import Vertical

SIZE = 100.0
FOOT = np.array([3.0, -2.0, 0.0])


def plant(seed: int, drooping: bool = False, at: np.ndarray = FOOT) -> np.ndarray:
    """A stem with one leaf, whose tip hangs 30 aside, above the stem's foot or below it."""
    rng = np.random.default_rng(seed)
    stem = rng.normal(0, 0.4, (400, 3)) + np.linspace(0, 1, 400)[:, None] * [0, 0, SIZE]
    droop = np.linspace(0, 1, 200)[:, None]
    tip = np.array([30.0, 0.0, -55.0 if drooping else 20.0])
    leaf = rng.normal(0, 0.4, (200, 3)) + [0, 0, 50] + droop * tip
    return (np.concatenate([stem, leaf]) + at).astype(np.float32)


def bases_of(clouds: list[np.ndarray], vertical: Vertical) -> list[int]:
    return [base_point(cloud, vertical) for cloud in clouds]


@pytest.mark.parametrize("up", ["z", "-z", "y", "-x"])
def test_a_leaf_that_hangs_below_the_foot_is_no_foot(up: str) -> None:
    vertical = Vertical.named(up)
    clouds = [plant(0), plant(1), plant(2), plant(3, drooping=True)]
    clouds = [vertical.sign * np.roll(cloud, vertical.axis - 2, axis=1) for cloud in clouds]
    lowest = bases_of(clouds, vertical)
    assert lowest[3] >= 400
    found = agreed_base_points(clouds, lowest, vertical)
    assert found[:3] == lowest[:3]
    assert found[3] < 400
    assert vertical.height(clouds[3])[found[3]] < 3.0


def test_plants_that_stand_anywhere_keep_their_lowest_points() -> None:
    vertical = Vertical.named("z")
    places = np.random.default_rng(5).uniform(-500, 500, (6, 3))
    clouds = [plant(k, drooping=k == 3, at=place) for k, place in enumerate(places)]
    lowest = bases_of(clouds, vertical)
    assert agreed_base_points(clouds, lowest, vertical) == lowest


def test_two_scans_outvote_nobody() -> None:
    vertical = Vertical.named("z")
    clouds = [plant(0), plant(1, drooping=True)]
    lowest = bases_of(clouds, vertical)
    assert agreed_base_points(clouds, lowest, vertical) == lowest


def test_an_outlier_below_ground_is_not_the_base() -> None:
    cloud = np.random.default_rng(0).random((500, 3))
    points = np.vstack([cloud, [[0.5, 0.5, -30.0 - i] for i in range(5)]])
    up = Vertical.named("z")
    assert base_point(points, up) == np.argmin(cloud[:, 2])
    assert base_point(points, up, np.array([0.5, 0.5, -29.0])) == 500


@pytest.mark.parametrize("up", ["x", "y", "z", "-x", "-y", "-z"])
def test_the_base_is_lowest_along_any_axis(up: str) -> None:
    vertical = Vertical.named(up)
    cloud = np.random.default_rng(0).random((500, 3))
    heights = vertical.height(cloud)
    assert heights[base_point(cloud, vertical)] == heights.min()
    assert np.allclose(vertical.height(vertical.at_height(cloud, -3.0)), -3.0)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_lowest_of_few_points_is_the_base(count: int) -> None:
    points = np.array([[0.0, 0.0, 1.0], [0.0, 3.0, 0.0], [5.0, 0.0, 2.0]])[:count]
    assert base_point(points, Vertical.named("z")) == np.argmin(points[:, 2])
