"""The compiled steps of bending and drawing do what numpy does."""

from __future__ import annotations

import numpy as np
import pytest

from baker.interpolation.coherent import draw
from baker.interpolation.drawing import laid, mapped, maps, spread_out, terms
from baker.interpolation.nearest import nearest
from baker.interpolation.spine import LEVELS, at_levels

STIFF = 0.3


def test_maps_are_those_of_weighted_least_squares() -> None:
    rng = np.random.default_rng(0)
    here, there = rng.normal(size=(40, 3)), rng.normal(size=(25, 3))
    ahead, back = nearest(here, there), nearest(there, here)
    weights = rng.uniform(size=(5, 40)).astype(np.float32)
    found = maps(weights @ terms(here, there, ahead, back, 3.0), STIFF)
    rows, partner = np.r_[np.arange(40), back[1]], np.r_[ahead[1], np.arange(25)]
    away = np.r_[ahead[0], back[0]]
    trust = 1.0 / (1.0 + (away / (3.0 * np.median(away))) ** 2)
    for centre in range(5):
        weight = trust * weights[centre, rows]
        points, shift = here[rows], there[partner] - here[rows]
        mean, shifted = weight @ points / weight.sum(), weight @ shift / weight.sum()
        off = points - mean
        second = (weight[:, None] * off).T @ off + STIFF * weight.sum() * np.eye(3)
        slopes = np.linalg.solve(second, (weight[:, None] * off).T @ (shift - shifted))
        np.testing.assert_allclose(found[centre, :9], slopes.ravel(), atol=1e-5)
        np.testing.assert_allclose(found[centre, 9:], shifted - mean @ slopes, atol=1e-5)


def test_each_point_has_its_own_map() -> None:
    rng = np.random.default_rng(1)
    points, local = rng.normal(size=(9, 3)), rng.normal(size=(9, 12))
    expected = points + np.einsum("na,nab->nb", points, local[:, :9].reshape(-1, 3, 3))
    np.testing.assert_allclose(mapped(points, local), expected + local[:, 9:])


def test_points_are_laid_between_the_levels() -> None:
    rng = np.random.default_rng(2)
    nodes, turns = rng.normal(size=(LEVELS, 3)), rng.normal(size=(4, LEVELS, 3, 3))
    along, offset = np.r_[0.0, 1.0, rng.uniform(size=20)], rng.normal(size=(22, 3))
    for way, found in zip(turns, laid(nodes, turns, along, offset, 1.5), strict=True):
        turned = (at_levels(way, along) @ offset[:, :, None])[..., 0]
        np.testing.assert_allclose(found, at_levels(nodes, along) + 1.5 * turned)


@pytest.mark.parametrize("count", [1, 5, 30, 100])
def test_each_is_the_farthest_from_those_before(count: int) -> None:
    points = np.random.default_rng(count).normal(size=(30, 3))
    chosen = spread_out(points, count)
    assert len(chosen) == min(count, 30)
    for k in range(1, len(chosen)):
        away = np.linalg.norm(points[:, None] - points[chosen[:k]], axis=2).min(axis=1)
        assert chosen[k] == np.argmax(away)


def test_of_points_in_one_place_one_is_enough() -> None:
    assert spread_out(np.repeat(np.eye(3), 4, axis=0), 60).tolist() == [0, 4, 8]


def test_clouds_without_extent_are_drawn_onto_each_other() -> None:
    found = draw(np.ones((50, 3)), np.full((30, 3), 2.0))
    np.testing.assert_allclose(found, 2.0, atol=1e-4)
