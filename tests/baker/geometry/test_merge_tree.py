"""Branches are what rises above the points where it meets something else."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix

from baker.geometry.merge_tree import branches


def chain(count):
    before = np.arange(count - 1)
    return coo_matrix((np.ones(count - 1), (before, before + 1)), (count, count))


def found(heights, min_length, **limits):
    return branches(np.array(heights), chain(len(heights)), min_length, **limits).tolist()


def test_two_peaks_meet_at_their_pass():
    numbers = found([0.0, 3.0, 5.0, 2.0, 4.0, 1.0], 1.0)
    assert numbers[:3] + numbers[4:] == [-1, 0, 0, 1, -1]


def test_a_small_peak_is_part_of_the_greater():
    assert found([0.0, 3.0, 5.0, 3.5, 4.0, 1.0], 1.0) == [-1] * 6
    both = found([0.0, 3.0, 5.0, 3.5, 4.0, 1.0, 6.0], 1.0)
    assert both[1:5] == [1] * 4
    assert both[6] == 0


def test_a_third_peak_is_a_branch_of_its_own():
    numbers = np.array(found([0.0, 2.0, 1.0, 5.0, 3.0, 6.0, 0.5], 0.5))
    assert set(numbers[[1, 3, 5]]) == {0, 1, 2}
    assert (numbers[[0, 6]] == -1).all()


@pytest.mark.parametrize(("share", "count"), [(0.5, 2), (0.51, 0)])
def test_a_bump_is_short_against_what_it_is_on(share, count):
    assert max(found([3.0, 1.0, 2.0], 1.0, min_share=share)) == count - 1


@pytest.mark.parametrize(("points", "count"), [(2, 2), (4, 0)])
def test_a_bump_has_few_points(points, count):
    assert max(found([0.0, 5.0, 4.0, 1.0, 6.0, 5.5], 1.0, min_points=points)) == count - 1


def test_every_point_above_its_meeting_point_is_on_a_branch():
    rng = np.random.default_rng(0)
    heights = rng.random(300)
    numbers = np.array(found(heights, 0.0))
    peaks = np.flatnonzero((heights[1:-1] > heights[:-2]) & (heights[1:-1] > heights[2:])) + 1
    assert len(set(numbers[peaks])) == len(peaks)
    assert (numbers[peaks] >= 0).all()
