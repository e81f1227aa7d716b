"""Distances between segments: exact, estimated, bounded from below."""

import numpy as np
import pytest

from baker.transport.problem import TransportOptions
from baker.transport.solve import solve
from baker.transport.wasserstein import Moments, gaussian_distance, least_distance, wasserstein
from tests.baker.transport.transport_clouds import grown_leaf, leaf


def test_exact_for_small_segments():
    start, end = grown_leaf(120, 90)
    assert wasserstein(start, end) == solve(start, end).distance
    assert wasserstein(start, end, power=1) == solve(start, end, TransportOptions(power=1)).distance


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
    for seed in range(3):
        assert wasserstein(start, end, seed=seed) == pytest.approx(exact, rel=0.02)
    assert wasserstein(start, end, power=1) == pytest.approx(
        solve(start, end, TransportOptions(power=1)).distance, rel=0.05
    )


def test_one_scan_twice_is_near_zero_and_translation_is_exact():
    points = leaf(3000)
    assert wasserstein(points, points) == pytest.approx(0.0, abs=1e-6)
    assert wasserstein(points, points + np.array([0, 3.0, 4.0])) == pytest.approx(5.0)


def test_the_estimate_is_exact_as_soon_as_every_point_is_a_block():
    start, end = grown_leaf(300, 280)
    exact = solve(start, end).distance
    assert wasserstein(start, end, samples=299) == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("seed", range(8))
def test_the_gaussian_distance_never_exceeds_the_true_one(seed):
    random = np.random.default_rng(seed)
    start = random.normal(size=(40, 3)) ** 3 @ random.normal(size=(3, 3))
    end = random.exponential(size=(55, 3)) @ random.normal(size=(3, 3)) + random.normal(size=3)
    bound = gaussian_distance(Moments.of(start), Moments.of(end))
    assert 0 < bound <= solve(start, end).distance * (1 + 1e-9)


def test_the_gaussian_distance_of_affine_copies_is_the_true_one():
    start = leaf(200)
    end = start @ np.diag([2.0, 1.5, 0.5]) + (1.0, 0, 0)
    bound = gaussian_distance(Moments.of(start), Moments.of(end))
    assert bound == pytest.approx(solve(start, end).distance, rel=1e-6)


def test_moments_merge():
    first, second = leaf(70), leaf(110, 2.0, seed=2) + 1.0
    together, merged = (
        Moments.of(np.concatenate([first, second])),
        Moments.of(first) + Moments.of(second),
    )
    assert merged.count == 180
    np.testing.assert_allclose(merged.mean, together.mean)
    np.testing.assert_allclose(merged.covariance, together.covariance)


def test_a_single_point_has_moments():
    moments = Moments.of(np.array([[1.0, 2.0, 3.0]]))
    assert gaussian_distance(moments, moments) == 0.0


CLOUDS = {
    "leaf": leaf,
    "ball": lambda n: np.random.default_rng(1).normal(size=(n, 3)),
    "line": lambda n: np.outer(np.linspace(0, 1, n), [1.0, 2.0, 3.0]),
    "plane": lambda n: np.random.default_rng(2).random((n, 3)) * [1.0, 0.0, 2.0],
    "point": lambda n: np.ones((n, 3)),
    "two far": lambda n: leaf(n) + 1e4 * (np.arange(n) % 2)[:, None],
    "tiny": lambda n: 1e-9 * np.random.default_rng(4).normal(size=(n, 3)),
    "needle": lambda n: np.random.default_rng(5).normal(size=(n, 3)) * [1e-6, 1e-6, 1.0],
    "far": lambda n: leaf(n) + 1e5,
}


@pytest.mark.parametrize("count", [1, 40, 256, 300])
@pytest.mark.parametrize("name", CLOUDS)
def test_no_distance_is_below_what_its_moments_allow(name, count):
    """Neither one that is worked out exactly nor one that is estimated."""
    start = CLOUDS[name](count)
    ends = [make(size) for make in CLOUDS.values() for size in (1, 50, 280)]
    bounds = least_distance(Moments.of(start), [Moments.of(end) for end in ends])
    distances = np.array([wasserstein(start, end) for end in ends])
    assert (bounds <= distances).all()
    assert np.isfinite(bounds).all()


def test_the_bound_is_close_where_clouds_are_far_apart():
    start, end = leaf(300), leaf(280, seed=2) + np.array([0.0, 3.0, 0.0])
    (bound,) = least_distance(Moments.of(start), [Moments.of(end)])
    assert 0.99 * wasserstein(start, end) < bound <= wasserstein(start, end)
    # Clouds that are merged have the moments of their union.
    whole = Moments.of(start[:100]) + Moments.of(start[100:])
    assert least_distance(whole, [Moments.of(end)]) == pytest.approx([bound])
