"""The closest pair is that of all pairs, whatever is passed over."""

from __future__ import annotations

import numpy as np
import pytest

from baker.motion.closest import BLOCK, closest


@pytest.mark.parametrize("count", [1, BLOCK - 1, BLOCK, BLOCK + 1, 5 * BLOCK + 3])
def test_the_closest_of_all_pairs(count: int) -> None:
    rng = np.random.default_rng(count)
    mine = rng.normal(size=(4, 40, 3))
    theirs = np.sort(rng.normal(size=(4, count, 3)), axis=1) + np.array([3.0, 0.0, 0.0])
    gap, a, b = closest(mine, theirs)
    apart = np.linalg.norm(mine[:, :, None] - theirs[:, None], axis=3)
    np.testing.assert_allclose(gap, apart.min(axis=(1, 2)), rtol=1e-12)
    np.testing.assert_allclose(apart[np.arange(4), a, b], gap, rtol=1e-12)


def test_points_that_touch() -> None:
    same = np.zeros((2, 20, 3))
    gap, a, b = closest(same, same)
    assert gap.tolist() == [0.0, 0.0]
    assert a.tolist() == b.tolist() == [0, 0]
