"""Which points may be near another segment: none that is may be missed, and most are not."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from baker.borders import near_others


def two_blades(count, apart):
    """Two parallel blades, and which of them each point is on."""
    points = np.random.default_rng(1).random((count, 3)) * [10.0, 1.0, 0.01]
    owner = np.arange(count) % 2
    points[:, 2] += owner * apart + owner * points[:, 0]  # they part along their length
    return points, owner


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("threshold", [0.02, 0.2, 3.0])
def test_every_point_that_is_near_another_segment_is_found(threshold, dtype):
    points, owner = two_blades(900, 0.05)
    points = points.astype(dtype)
    foreign = np.where(owner[:, None] == owner, np.inf, cdist(points, points)).min(axis=1)
    near = near_others(points, owner, threshold)
    assert near[foreign < threshold].all()
    # Cubes reach no farther than two of their diagonals.
    assert not near[foreign > 2 * 3**0.5 * 1.002 * threshold].any()


def test_one_segment_is_near_no_other():
    points, _ = two_blades(300, 0.1)
    assert not near_others(points, np.zeros(300, np.intp), 0.5).any()


def test_without_a_threshold_any_point_may_be():
    points, owner = two_blades(30, 0.1)
    assert near_others(points, owner, 0.0).all()
    assert near_others(np.zeros((4, 3)), np.array([0, 1, 0, 1]), 0.1).all()
