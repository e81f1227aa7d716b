"""Blades are told from stem and petioles, at any scale, density and turn."""

import numpy as np
import pytest

from baker.alignment.stem_base import base_point
from baker.geometry.up_axis import Vertical
from baker.segmentation.organs import find_organs
from tests.baker.segmentation.seedling import seedling, tube

UP = Vertical.named("z")


def organs(cloud: np.ndarray) -> np.ndarray:
    """The most likely segmentation."""
    return find_organs(cloud, base_point(cloud, UP))


def mean_overlap(truth: np.ndarray, found: np.ndarray) -> float:
    """Mean over the true organs of the best intersection over union."""
    best = []
    for label in np.unique(truth):
        own = truth == label
        best.append(
            max((own & (found == n)).sum() / (own | (found == n)).sum() for n in np.unique(found))
        )
    return float(np.mean(best))


@pytest.mark.parametrize("blades", [1, 2, 3])
def test_blades_are_told_from_stem_and_petioles(blades):
    points, truth = seedling(blades)
    found = organs(points)
    assert len(np.unique(found)) == blades + 1
    assert mean_overlap(truth, found) > 0.9
    stem = truth == 0
    assert (found[stem] == 0).mean() > 0.9


def test_blades_include_their_bases():
    """There, the neighbourhoods of points are half of petiole."""
    shares = []
    for seed in range(4):
        points, truth = seedling(density=60.0, seed=seed)
        found = organs(points)
        for leaf in (1, 2, 3):
            away = np.array([np.cos(2.1 * leaf), np.sin(2.1 * leaf), 0.0])
            base = (truth == leaf) & (points @ away < 2.9)  # from 2.5 to 7.5
            shares.append((found[base] == np.bincount(found[truth == leaf]).argmax()).mean())
    assert np.mean(shares) > 0.8


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_the_unit_does_not_matter(scale):
    points, truth = seedling()
    found = organs(points * scale + 7.0 * scale)
    assert mean_overlap(truth, found) > 0.9


@pytest.mark.parametrize("density", [12.0, 200.0])
def test_the_density_does_not_matter(density):
    points, truth = seedling(density=density)
    found = organs(points)
    assert mean_overlap(truth, found) > 0.85


@pytest.mark.parametrize("density", [3.0, 6.0, 12.0])
def test_sparse_points_at_random_do_not_make_more_organs(density):
    """At the lowest density, a stem has nine points on a length of its diameter."""
    plants = [(blades, seed) for blades in (2, 3, 5) for seed in range(8)]
    found = [organs(seedling(blades, density=density, seed=seed)[0]) for blades, seed in plants]
    right = [len(np.unique(o)) == blades + 1 for o, (blades, _) in zip(found, plants, strict=True)]
    assert np.mean(right) > 0.9


@pytest.mark.parametrize("offset", [0.3, 0.6, 0.9])
def test_a_slit_in_a_blade_does_not_divide_it(offset):
    """The strip beside the slit is so broad that most of its points are not at the slit."""
    points, truth = seedling(1, density=100.0)
    away = np.array([np.cos(2.1), np.sin(2.1), 0.0])
    along, across = points @ away, points @ [-away[1], away[0], 0.0]
    slit = (truth == 1) & (along < 5.0) & (abs(across - offset) < 0.1)
    found = organs(points[~slit])
    assert len(np.unique(found)) == 2
    assert mean_overlap(truth[~slit], found) > 0.9


@pytest.mark.parametrize("seed", range(6))
def test_a_stem_that_thickens_is_no_blade(seed):
    """Its thick part alone could be a blade, but it carries three others."""
    points, truth = seedling(3, seed=seed)
    thick = (truth == 0) & (np.hypot(points[:, 0], points[:, 1]) < 0.6)
    points[thick, :2] *= 1.5
    below = tube([0, 0, -6], [0, 0, 0], 1.0, 30.0, np.random.default_rng(seed))
    found = organs(np.vstack([points, below]))
    assert mean_overlap(truth, found[: len(points)]) > 0.9


def test_strips_of_noisy_blades_do_not_make_them_a_stem():
    """Noise lets blades fork into strips, which are no organs that a stem would carry."""
    overlaps = []
    for seed in range(6):
        points, truth = seedling(3, size=8.0, density=12.0, seed=seed)
        noise = np.random.default_rng(seed).normal(0, 0.15, points.shape)
        overlaps.append(mean_overlap(truth, organs(points + noise)))
    assert np.mean(overlaps) > 0.94


def test_an_uneven_density_does_not_matter():
    points, truth = seedling(density=100.0)
    rng = np.random.default_rng(2)
    share = (points[:, 0] - points[:, 0].min()) / np.ptp(points[:, 0])
    kept = rng.random(len(points)) < 0.15 + 0.85 * share
    found = organs(points[kept])
    assert mean_overlap(truth[kept], found) > 0.85


def test_floating_points_do_not_mislead():
    points, truth = seedling()
    rng = np.random.default_rng(3)
    low, high = points.min(axis=0), points.max(axis=0)
    floating = rng.uniform(low, high, (len(points) // 50, 3))
    found = organs(np.vstack([points, floating]))
    assert mean_overlap(truth, found[: len(points)]) > 0.85


def test_the_same_cloud_gives_the_same_organs():
    points, _ = seedling()
    assert np.array_equal(organs(points), organs(points.copy()))


def test_a_bare_stem_is_one_organ():
    rng = np.random.default_rng(0)
    found = organs(tube([0, 0, 0], [1, 0, 12], 1.0, 40, rng))
    assert not found.any()


def test_a_bare_branch_is_an_organ():
    rng = np.random.default_rng(0)
    trunk = tube([0, 0, 0], [0, 0, 20], 1.0, 40, rng)
    twig = tube([0.4, 0, 8], [8, 0, 12], 0.5, 40, rng)
    found = organs(np.vstack([trunk, twig]))
    assert mean_overlap(np.repeat([0, 1], [len(trunk), len(twig)]), found) > 0.9


@pytest.mark.parametrize("count", [1, 2, 10])
def test_a_handful_of_points_is_one_organ(count):
    found = organs(np.random.default_rng(0).random((count, 3)))
    assert found.shape == (count,)
    assert not found.any()


def test_points_all_in_one_place():
    found = organs(np.zeros((50, 3)))
    assert not found.any()
