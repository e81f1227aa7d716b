"""Organs are paired by their scores."""

import numpy as np
from scipy.spatial.distance import cdist

from baker.matching.descriptors import OrganDescriptors
from baker.matching.score import best_pairs, match_penalties, shape_penalties


def scattered_organs(count: int, seed: int) -> OrganDescriptors:
    """Rods of random lengths and directions, at random places; no stem."""
    rng = np.random.default_rng(seed)
    starts = rng.uniform(0.0, 6.0, (count, 1, 3))
    directions = rng.normal(size=(count, 1, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    lengths = rng.uniform(0.2, 3.0, (count, 1, 1))
    samples = starts + np.linspace(0.0, 1.0, 40)[:, None] * lengths * directions
    sizes = np.sqrt(((samples - starts) ** 2).sum(axis=2).mean(axis=1))
    none = np.zeros(count)
    return OrganDescriptors(
        list(samples), starts[:, 0], sizes, directions[:, 0], none, none, np.zeros(3)
    )


def test_pairs_have_the_greatest_total_score_and_none_is_made_at_a_loss():
    scores = np.array([[3.0, 2.5, 0.0], [2.5, 1.0, -1.0], [-np.inf, 0.0, -0.5]])
    pairs, total = best_pairs(scores)
    assert pairs.tolist() == [[0, 1], [1, 0]]
    assert total == 5.0


def test_distances_that_are_not_computed_belong_to_impossible_pairs():
    young, old = (scattered_organs(30, seed) for seed in (0, 1))
    young, old = sorted((young, old), key=lambda organs: float((organs.sizes**2).sum()))
    distances = [[cdist(a, b).min(axis=1).mean() for b in old.samples] for a in young.samples]
    cosines = young.directions @ old.directions.T
    base_bonus = np.full_like(cosines, -0.75)  # all of `height` is 0
    expected = shape_penalties(young, old, np.array(distances), cosines, base_bonus)
    assert 0.05 < np.isfinite(expected).mean() < 0.6
    np.testing.assert_allclose(match_penalties(young, old), expected)
