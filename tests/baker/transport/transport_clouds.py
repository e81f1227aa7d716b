"""Segments to transport: a leaf that grows and bends, seen by two scans that share no point."""

import numpy as np
from numpy.typing import NDArray


def leaf(count: int, length: float = 1.0, seed: int = 0) -> NDArray[np.float64]:
    """A curved leaf with some depth noise; longer ones are bent more."""
    random = np.random.default_rng(seed)
    along, across = random.random(count), random.random(count) - 0.5
    width = 0.3 * length * np.sin(np.pi * along)
    points = np.stack(
        [along * length, across * width, 0.3 * length * np.sin(2.0 * along * length**0.3)], axis=1
    )
    return points + random.normal(scale=0.002, size=points.shape)


def grown_leaf(n: int, m: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return leaf(n, 1.0, seed=n), leaf(m, 1.5, seed=m + 1)
