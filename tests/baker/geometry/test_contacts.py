"""Which segments touch: all that come within reach of each other, and only they."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from baker.geometry.contacts import REACH, Borders, contacts


def blocks():
    """Points in a cube cut into eight segments, labelled 10 to 17."""
    points = np.random.default_rng(0).random((600, 3))
    return points, (4 * points[:, 0]).astype(np.intp) * 2 + (points[:, 2] > 0.9) + 10


@pytest.mark.parametrize("workers", [1, 2])
def test_touching_segments_are_all_found_and_only_they(workers):
    points, labels = blocks()
    gaps = contacts(Borders.of(points, labels, 0.12 / REACH, workers))
    apart = cdist(points, points)
    for a in range(10, 18):
        for b in range(10, 18):
            gap = apart[np.ix_(labels == a, labels == b)].min()
            wanted = pytest.approx(gap) if a != b and gap < 0.12 else None
            assert gaps.get((a, b)) == wanted


def test_what_is_near_reaches_no_farther_than_the_points_about_borders():
    points, labels = blocks()
    borders = Borders.of(points, labels, 0.01)
    foreign = np.where(labels[:, None] == labels, np.inf, cdist(points, points)).min(axis=1)
    assert np.isin(np.flatnonzero(foreign < 0.01 * REACH), borders.one).all()
    assert len(np.unique(borders.one)) < len(points)


def test_one_segment_touches_nothing():
    assert contacts(Borders.of(np.random.default_rng(1).random((50, 3)), np.ones(50), 0.1)) == {}
