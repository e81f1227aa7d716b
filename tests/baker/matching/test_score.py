"""Organs are paired by their scores."""

import numpy as np

from baker.matching.score import best_pairs


def test_pairs_have_the_greatest_total_score_and_none_is_made_at_a_loss():
    scores = np.array([[3.0, 2.5, 0.0], [2.5, 1.0, -1.0], [-np.inf, 0.0, -0.5]])
    pairs, total = best_pairs(scores)
    assert pairs.tolist() == [[0, 1], [1, 0]]
    assert total == 5.0
