"""The plant base: of the stem where organs are known, else where the plant stands on most scans."""

from __future__ import annotations

import numpy as np
import pytest

from baker.alignment.register import align
from baker.alignment.sample import even_sample
from baker.alignment.stem_base import base_point, named_base, stem_labels
from baker.errors import InputError
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Scan
from tests.baker.series import series_of

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


def labels_of(scan: np.ndarray) -> np.ndarray:
    """4 on the stem, 7 on the leaf."""
    return np.where(np.arange(len(scan)) < 400, 4, 7)


@pytest.mark.parametrize("up", ["z", "-z", "y", "-x"])
@pytest.mark.parametrize("labelled", [False, True])
def test_a_leaf_that_hangs_below_the_foot_is_no_foot(up: str, labelled: bool) -> None:
    vertical = Vertical.named(up)
    clouds = [plant(0), plant(1), plant(2), plant(3, drooping=True)]
    clouds = [vertical.sign * np.roll(cloud, vertical.axis - 2, axis=1) for cloud in clouds]
    assert base_point(clouds[3], vertical) >= 400
    labels = [labels_of(cloud) for cloud in clouds] if labelled else None
    found = align(series_of(clouds, labels), "none", up)
    for cloud, base in zip(clouds, found.bases, strict=True):
        point = base_point(cloud, vertical, near=base)
        assert point < 400
        assert vertical.height(cloud)[point] < 4.0


def test_the_stem_is_the_organ_that_carries_the_others() -> None:
    rng = np.random.default_rng(1)
    cloud = plant(0, drooping=True)
    along = np.linspace([0, 0, 70], [-20, 0, 90], 200)
    cloud = np.concatenate([cloud, rng.normal(0, 0.4, (200, 3)) + along + FOOT])
    stem = np.repeat([True, False], [400, 400])
    leaf = np.repeat([1, 2, 3], [400, 200, 200])
    anew = np.where(stem, 9, leaf)
    samples = [even_sample(cloud, labels) for labels in (leaf, leaf, leaf, anew)]
    assert stem_labels(samples, Vertical.named("z")) == [1, 1, 1, 9]


def test_an_outlier_below_ground_is_not_the_base() -> None:
    cloud = np.random.default_rng(0).random((500, 3))
    points = np.vstack([cloud, [[0.5, 0.5, -30.0 - i] for i in range(5)]])
    up = Vertical.named("z")
    assert base_point(points, up) == np.argmin(cloud[:, 2])
    assert base_point(points, up, near=np.array([0.5, 0.5, 0.5])) < 500


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


def test_a_place_far_from_the_plant_is_no_base() -> None:
    scan = Scan(plant(0), name="day0.ply", origin=np.array([100.0, 0.0, 0.0]))
    assert np.array_equal(named_base((100.0, 0.0, 0.0), scan), np.zeros(3))
    with pytest.raises(InputError, match=r"--root is .* from 'day0.ply', which is 99.8 across"):
        named_base((0.0, 0.0, 900.0), scan)
