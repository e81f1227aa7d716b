"""Samples cover a cloud evenly: one point a voxel, or each point far from those before it."""

import numpy as np
import pytest

from baker.geometry.sampling import farthest_point_sample, voxel_downsample, voxel_size_for

POINTS = np.random.default_rng(0).random((3000, 3)) * [4.0, 2.0, 0.1]


@pytest.mark.parametrize("first", [None, 7])
def test_each_point_is_the_farthest_from_those_before(first):
    points = POINTS[:30]
    chosen = farthest_point_sample(points, 100, first)
    assert len(chosen) == 30
    assert first in (None, chosen[0])
    for k in range(1, len(chosen)):
        distance = np.linalg.norm(points[:, None] - points[chosen[:k]], axis=2).min(axis=1)
        assert chosen[k] == np.argmax(distance)


def test_no_point_is_chosen_twice():
    points = np.repeat(POINTS[:40], 50, axis=0)
    indices = farthest_point_sample(points, 1000)
    assert len(indices) == len(np.unique(points[indices], axis=0)) == 40


@pytest.mark.parametrize("size", [0.05, 0.3, 10.0])
def test_each_voxel_has_one_point(size):
    kept = voxel_downsample(POINTS, size)
    voxels = np.floor((POINTS - POINTS.min(axis=0)) / size)
    assert len(kept) == len(np.unique(voxels, axis=0)) == len(np.unique(voxels[kept], axis=0))


def test_voxels_of_no_size_keep_all_points():
    np.testing.assert_array_equal(voxel_downsample(POINTS, 0.0), np.arange(len(POINTS)))


@pytest.mark.parametrize("count", [50, 1000])
def test_the_size_for_a_number_of_points_is_the_smallest(count):
    size = voxel_size_for(POINTS, count)
    assert len(voxel_downsample(POINTS, size)) <= count
    assert len(voxel_downsample(POINTS, size / 1.1)) > 0.8 * count
    assert voxel_size_for(POINTS, len(POINTS)) == 0.0
