"""Point spacing: the length scale that every threshold of the baker is relative to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SAMPLE = 20_000


def point_spacing(points: NDArray[np.floating]) -> float:
    """Median distance from a point of an (N, 3) cloud to its nearest neighbour; 0 for N < 2.

    Estimated on evenly strided points where there are more than 20,000, always against all points.
    """
    from scipy.spatial import cKDTree

    if len(points) < 2:
        return 0.0
    sample = points[:: -(-len(points) // SAMPLE)]
    distances, _ = cKDTree(points).query(sample, k=2)
    return float(np.median(distances[:, 1]))


def without_outliers(points: NDArray[np.floating], neighbors: int = 8) -> NDArray[np.bool_]:
    """(N,) mask of the points that are not alone: k-th neighbour within ten times the median."""
    from scipy.spatial import cKDTree

    k = min(neighbors, len(points) - 1)
    if k < 1:
        return np.ones(len(points), bool)
    reach = cKDTree(points).query(points, k=[k + 1])[0][:, 0]
    return reach <= 10.0 * np.median(reach)
