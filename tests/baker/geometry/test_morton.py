"""Morton order: what is near in space is near in memory."""

import numpy as np
import pytest

from baker.geometry.morton import block_shuffle, morton_codes, morton_order
from gclip.schema import extent


@pytest.mark.parametrize("count", [1, 2, 3, 64, 1000, 65_536])
def test_order_is_that_of_the_leading_bits_and_equal_ones_stay(count):
    points = np.random.default_rng(count).random((count, 3))
    points[::2] = points[0]  # many are equal
    leading = (morton_codes(points) >> np.uint64(count.bit_length())).tolist()
    order = sorted(range(count), key=lambda point: (leading[point], point))
    np.testing.assert_array_equal(morton_order(points), order)


@pytest.mark.parametrize("count", [1, 127, 128, 1000])
def test_blocks_are_shuffled_whole(count):
    points = np.random.default_rng(count).random((count, 3))
    order = block_shuffle(points)
    np.testing.assert_array_equal(np.sort(order), np.arange(count))
    place = np.argsort(morton_order(points))[order]
    starts = np.flatnonzero(np.diff(place, prepend=-2) != 1)
    assert set(place[starts]) <= set(range(0, count, 128))


def test_morton_codes_interleave_bits():
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    assert np.array_equal(np.argsort(morton_codes(corners)), np.arange(8))


@pytest.mark.parametrize("extent", [1e-29, 1e-31, 1e-38, 1e-44])
def test_morton_codes_of_the_smallest_plants(extent):
    random = np.random.default_rng(0)
    points = random.random((50, 3))
    points[:2] = [[0, 0, 0], [1, 1, 1]]
    found = morton_codes((points * extent).astype(np.float32))
    assert found[0] == 0
    assert found[1] == found.max()
    if extent > 1e-30:  # smaller ones have fewer cells, down to a single one
        assert found[1] == 2**63 - 1
        assert np.array_equal(np.argsort(found), np.argsort(morton_codes(points)))


@pytest.mark.parametrize("count", [1, 63, 64, 65, 1000])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_extent_of_points(count: int, dtype: type) -> None:
    points = np.random.default_rng(count).normal(size=(count, 3)).astype(dtype)
    for given in (points, np.asfortranarray(points), points[::-1]):
        low, high = extent(given)
        np.testing.assert_array_equal(low, points.min(axis=0))
        np.testing.assert_array_equal(high, points.max(axis=0))
        assert low.dtype == high.dtype == dtype
