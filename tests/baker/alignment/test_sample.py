"""Even samples cover a cloud evenly, however unevenly it was scanned."""

import numpy as np
from scipy.spatial import cKDTree

from baker.alignment.sample import SAMPLE_SIZE, even_sample


def test_the_first_n_points_cover_the_cloud_as_the_next_one_tells(days):
    sample = even_sample(days[0])
    for count in (1, 10, 300):
        distances, _ = cKDTree(sample.points[:count]).query(sample.pool)
        nearest, _ = cKDTree(sample.points[:count]).query(sample.points[count])
        assert np.isclose(distances.max(), nearest)


def test_density_does_not_matter():
    rng = np.random.default_rng(0)
    dense, thin = rng.random((9_000, 2)), rng.random((1_000, 2)) + np.array([1.0, 0.0])
    cloud = np.column_stack([np.concatenate([dense, thin]), np.zeros(10_000)])
    share = (even_sample(cloud).points[:200, 0] < 1.0).mean()
    assert 0.4 < share < 0.6


def test_outliers_are_left_out(days):
    cloud = np.concatenate([days[0], [[500.0, 0.0, -500.0]]])
    assert even_sample(cloud).points.min() > -400.0


def test_at_most_so_many_points_and_no_point_twice():
    cloud = np.repeat(np.random.default_rng(0).random((40, 3)), 50, axis=0)
    assert len(even_sample(cloud).points) == 40
    assert len(even_sample(np.random.default_rng(0).random((20_000, 3))).points) == SAMPLE_SIZE
