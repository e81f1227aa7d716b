"""Distances between segments: exact or estimated."""

import numpy as np
import pytest

from baker.transport.solve import solve, wasserstein
from baker.transport.space_partition import random_rotation
from tests.baker.transport.transport_clouds import grown_leaf, leaf


def test_exact_for_small_segments():
    start, end = grown_leaf(120, 90)
    assert wasserstein(start, end) == solve(start, end).distance


@pytest.mark.parametrize(
    ("start", "end"),
    [
        grown_leaf(1500, 2000),
        (leaf(1500), leaf(1200, 1.1, seed=9)),
        (leaf(1500), leaf(1500, seed=3)[:, [2, 0, 1]]),
        (
            leaf(1500),
            np.concatenate([leaf(800, seed=4), leaf(700, seed=5) + np.array([0.5, 0.5, 0])]),
        ),
    ],
    ids=["grown", "a little grown", "turned", "doubled"],
)
def test_the_estimate_is_within_two_percent(start, end):
    exact = solve(start, end).distance
    for turn in map(random_rotation, range(3)):  # so that other blocks are made
        assert wasserstein(start @ turn, end @ turn) == pytest.approx(exact, rel=0.02)


def test_one_scan_twice_is_near_zero_and_translation_is_exact():
    points = leaf(3000)
    assert wasserstein(points, points) == pytest.approx(0.0, abs=1e-6)
    assert wasserstein(points, points + np.array([0, 3.0, 4.0])) == pytest.approx(5.0)


def test_the_estimate_is_exact_as_soon_as_every_point_is_a_block():
    start, end = grown_leaf(300, 280)
    exact = solve(start, end).distance
    assert wasserstein(start, end, samples=299) == pytest.approx(exact, rel=2e-3)
