"""Scraps of our own cutting fade; what a plant has shed falls."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker.interpolation.scraps import FEWEST, is_scrap


def strip(count: int, length: float, width: float) -> np.ndarray:
    """A leaf along +x from the origin."""
    drawn = np.random.default_rng(0).uniform((0, -0.5, 0), (1, 0.5, 0), (count, 3))
    return drawn * (length, width, 1.0)


@pytest.mark.parametrize("width", [0.02, 0.2, 0.6])
def test_a_leaf_that_has_fallen_is_none(width: float) -> None:
    """What is left is the stem that it was attached to."""
    stem = np.c_[np.zeros((100, 2)), np.linspace(-1, 1, 100)]
    assert not is_scrap(strip(300, 1.0, width), cKDTree(stem))


def test_a_bit_of_a_leaf_that_is_still_there_is_one() -> None:
    leaf = strip(3000, 1.0, 0.3)
    bit = leaf[(np.abs(leaf[:, 0] - 0.6) < 0.1)]
    assert is_scrap(bit, cKDTree(leaf + np.array([0.05, 0.0, 0.1])))


def test_a_few_points_are_one() -> None:
    far = cKDTree(np.full((5, 3), 100.0))
    assert is_scrap(strip(FEWEST - 1, 1.0, 0.3), far)
    assert not is_scrap(strip(FEWEST, 1.0, 0.3), far)


def test_equal_points_are_one_where_they_are_still_there() -> None:
    same = np.ones((60, 3))
    assert is_scrap(same, cKDTree(same))
    assert not is_scrap(same, cKDTree(same + 1.0))
