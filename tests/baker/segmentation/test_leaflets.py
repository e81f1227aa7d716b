"""Limbs: a twig's leaves are told from one another and from the stalk, a blade has none."""

import numpy as np
import pytest

from baker.segmentation.leaflets import MAX_POINTS_SEARCHED, segment_leaflets
from tests.baker.twigs import blade, twig


def share_right(found: np.ndarray, leaf: np.ndarray) -> float:
    """Points of leaves that lie on the limb which most of their leaf lies on, and no other's."""
    right = 0
    for one in range(leaf.max() + 1):
        names, counts = np.unique(found[leaf == one], return_counts=True)
        name = names[counts.argmax()]
        right += counts.max() if name >= 0 and (leaf[found == name] == one).mean() > 0.9 else 0
    return right / (leaf >= 0).sum()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("leaves", [4, 9])
def test_each_leaf_is_a_limb(leaves, seed):
    plant = twig(leaves, seed)
    found = segment_leaflets(plant.points, plant.foot)
    assert share_right(found, plant.leaf) > 0.75
    assert set(np.unique(found)) == set(range(-1, found.max() + 1))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("count", [30, 400, 3000])
def test_a_single_blade_has_none(count, seed):
    points = blade(np.random.default_rng(seed), count, 10.0, 2.0)
    foot = int(np.argmin(points[:, 0]))
    assert (segment_leaflets(points, foot) == -1).all()


def test_of_many_points_a_share_tells_as_much():
    plant = twig(6, density=20)
    assert len(plant.points) > 1.5 * MAX_POINTS_SEARCHED
    found = segment_leaflets(plant.points, plant.foot)
    assert found.shape == plant.leaf.shape
    assert share_right(found, plant.leaf) > 0.75


def test_neither_the_unit_nor_where_it_stands_matters():
    plant = twig(6)
    found = segment_leaflets(plant.points, plant.foot)
    far = segment_leaflets(1000 * plant.points + 5e4, plant.foot)
    np.testing.assert_array_equal(found, far)


@pytest.mark.parametrize("count", [1, 2, 5, 9, 10, 11])
def test_a_handful_of_points_has_none(count):
    points = np.random.default_rng(0).random((count, 3))
    assert (segment_leaflets(points, 0) == -1).all()


def test_points_in_one_place_have_none():
    assert (segment_leaflets(np.zeros((40, 3)), 0) == -1).all()
