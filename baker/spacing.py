"""Point spacing: the length scale that every threshold of the baker is relative to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gclip.pack import morton_codes

SAMPLE = 20_000
NEIGHBORS, ALONE = 8, 10.0  # a point is alone whose 8th neighbour is ten times as far as usual
BATCH = 1000


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


def lowest_point(points: NDArray[np.floating], heights: NDArray[np.floating]) -> int:
    """Index of the lowest point of an (N, 3) cloud that is not alone.

    Alone is a point whose 8th neighbour is more than ten times as far as is usual in the cloud.
    """
    from scipy.spatial import cKDTree

    order = np.argsort(heights, kind="stable")
    k = min(NEIGHBORS, len(points) - 1)
    if k < 1:
        return int(order[0])
    tree = cKDTree(points)
    usual = np.median(tree.query(points[:: -(-len(points) // SAMPLE)], k=[k + 1])[0])
    for first in range(0, len(order), BATCH):
        batch = order[first : first + BATCH]
        reach = tree.query(points[batch], k=[k + 1])[0][:, 0]
        if (reach <= ALONE * usual).any():
            return int(batch[np.argmax(reach <= ALONE * usual)])
    return int(order[0])


def without_outliers(points: NDArray[np.floating]) -> NDArray[np.bool_]:
    """(N,) mask of the points that are not alone, as `lowest_point` means it."""
    k = min(NEIGHBORS, len(points) - 1)
    if k < 1:
        return np.ones(len(points), bool)
    distance = reach(points, k)
    return distance <= ALONE * np.median(distance)


def reach(points: NDArray[np.floating], k: int, workers: int = 1) -> NDArray[np.float64]:
    """(N,) each point's distance to its k-th nearest other point, k < N.

    workers: threads.

    Asked for in the order of a Morton curve, which is three times as fast where scans are shuffled.
    """
    from scipy.spatial import cKDTree

    order = np.argsort(morton_codes(points), kind="stable")
    sorted_points = points[order]
    distance = np.empty(len(points))
    tree = cKDTree(sorted_points)
    distance[order] = tree.query(sorted_points, k=[k + 1], workers=workers)[0][:, 0]
    return distance
