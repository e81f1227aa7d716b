"""Organs that one scan cuts finer than its neighbors are merged; all others are left alone."""

import numpy as np
import pytest

from baker.matching.merging import merge_parts


def leaf(length: float, azimuth: float, height: float, rng: np.random.Generator):
    """500 points of a leaf that rises from a stem and bends over."""
    along, across = rng.random(500), rng.uniform(-0.1, 0.1, 500)
    out = length * along
    x, y = np.cos(azimuth), np.sin(azimuth)
    width = length * across * np.sin(np.pi * (0.1 + 0.9 * along))
    rise = height + out - 0.6 * length * along**2
    return np.column_stack([out * x - width * y, out * y + width * x, rise])


@pytest.fixture
def series():
    """Four scans of a stem and up to four leaves, the last of which is born on day 2."""
    rng = np.random.default_rng(2)
    clouds, tracks = [], []
    for day in range(4):
        stem = np.column_stack([*rng.normal(0, 0.1, (2, 500)), 9 * rng.random(500)])
        count = 3 + (day >= 2)
        leaves = [leaf(4 + day - k, 2.1 * k, 2 + 2 * k, rng) for k in range(count)]
        clouds.append(np.concatenate([stem, *leaves]))
        tracks.append(np.repeat(np.arange(1 + count), 500))
    return clouds, tracks


@pytest.mark.parametrize("scan", [0, 1, 3])
def test_a_leaf_cut_in_two_is_one_again(series, scan):
    clouds, tracks = series
    outer = (tracks[scan] == 1) & (np.hypot(*clouds[scan][:, :2].T) > 2.0 + scan / 2)
    cut = list(tracks)
    cut[scan] = np.where(outer, 99, tracks[scan])
    for merged, truth in zip(merge_parts(clouds, cut), tracks, strict=True):
        np.testing.assert_array_equal(merged, truth)


def test_both_parts_keep_their_names_where_that_was_asked_for(series):
    clouds, tracks = series
    outer = (tracks[1] == 1) & (np.hypot(*clouds[1][:, :2].T) > 2.5)
    cut = [tracks[0], np.where(outer, 99, tracks[1]), *tracks[2:]]
    for merged, given in zip(merge_parts(clouds, cut, protected=[99]), cut, strict=True):
        np.testing.assert_array_equal(merged, given)


def test_new_and_lost_leaves_are_no_parts_of_others(series):
    clouds, tracks = series
    for order in (slice(None), slice(None, None, -1)):
        merged = merge_parts(clouds[order], tracks[order])
        for found, truth in zip(merged, tracks[order], strict=True):
            np.testing.assert_array_equal(found, truth)


@pytest.mark.parametrize(
    ("rest", "part"),
    [
        # What is left is as long as the organ was: it was not cut.
        (lambda x, y: np.abs(y) < 0.3, lambda x, y: np.abs(y) >= 0.3),
        # The organ has lost its tip, and what is new is somewhere else.
        (lambda x, y: x < 5.0, lambda x, y: x > 8.0),
        # It has lost its tip, and what is new is far too large to be that.
        (lambda x, y: x < 5.0, lambda x, y: x >= 5.0),
    ],
)
def test_what_does_not_make_the_organ_whole_is_no_part_of_it(rest, part):
    rng = np.random.default_rng(0)
    stem = np.column_stack([*rng.normal(0, 0.1, (2, 500)), rng.uniform(-5, 5, 500)])
    x, y = np.meshgrid(np.linspace(0, 30, 301), np.linspace(-1, 1, 11))
    blade = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    whole = blade[blade[:, 0] < 10]
    limit = 30 if part(6.0, 0.0) else 10.5
    kept = blade[rest(*blade[:, :2].T) & (blade[:, 0] < 10)]
    new = blade[part(*blade[:, :2].T) & (blade[:, 0] < limit)]
    clouds = [np.concatenate([stem, whole]), np.concatenate([stem, kept, new])]
    tracks = [
        np.repeat([0, 1], [len(stem), len(whole)]),
        np.repeat([0, 1, 2], [len(stem), len(kept), len(new)]),
    ]
    np.testing.assert_array_equal(merge_parts(clouds, tracks)[1], tracks[1])
