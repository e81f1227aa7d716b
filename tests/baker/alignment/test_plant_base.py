"""The foot of a plant that all scans agree on, where in one of them something hangs lower."""

from __future__ import annotations

import numpy as np
import pytest

from baker.alignment.plant_base import standing_bases
from baker.geometry.up_axis import Vertical
from baker.segmentation.from_labels import root_point

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
    return [root_point(cloud, vertical) for cloud in clouds]


@pytest.mark.parametrize("up", ["z", "-z", "y", "-x"])
def test_a_leaf_that_hangs_below_the_foot_is_no_foot(up: str) -> None:
    vertical = Vertical.named(up)
    clouds = [plant(0), plant(1), plant(2), plant(3, drooping=True)]
    clouds = [vertical.sign * np.roll(cloud, vertical.axis - 2, axis=1) for cloud in clouds]
    lowest = bases_of(clouds, vertical)
    assert lowest[3] >= 400
    found = standing_bases(clouds, lowest, vertical)
    assert found[:3] == lowest[:3]
    assert found[3] < 400
    assert vertical.height(clouds[3])[found[3]] < 3.0


def test_plants_that_stand_anywhere_keep_their_lowest_points() -> None:
    vertical = Vertical.named("z")
    places = np.random.default_rng(5).uniform(-500, 500, (6, 3))
    clouds = [plant(k, drooping=k == 3, at=place) for k, place in enumerate(places)]
    lowest = bases_of(clouds, vertical)
    assert standing_bases(clouds, lowest, vertical) == lowest


def test_two_scans_outvote_nobody() -> None:
    vertical = Vertical.named("z")
    clouds = [plant(0), plant(1, drooping=True)]
    lowest = bases_of(clouds, vertical)
    assert standing_bases(clouds, lowest, vertical) == lowest
