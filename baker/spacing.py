"""Point spacing: the length scale that every threshold of the baker is relative to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gclip.pack import morton_codes

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

SAMPLE = 20_000
NEIGHBORS, ALONE = 8, 10.0  # a point is alone whose 8th neighbour is ten times as far as usual
BATCH = 1000


@dataclass(frozen=True)
class Surroundings:
    """What a point cloud's points have around them.

    spacing: as `point_spacing` has it.
    reach:   (N,) distance to the eighth nearest other point, or the last one of fewer; None for a
             cloud of one point.
    """

    spacing: float
    reach: NDArray[np.float64] | None

    @classmethod
    def of(cls, points: NDArray[np.floating], workers: int = 1) -> Surroundings:
        """All from one search; workers: threads."""
        k = min(NEIGHBORS, len(points) - 1)
        if k < 1:
            return cls(0.0, None)
        nearest, farther = _distances(points, (1, k), workers)
        return cls(float(np.median(nearest[:: -(-len(points) // SAMPLE)])), farther)


def point_spacing(points: NDArray[np.floating], tree: cKDTree | None = None) -> float:
    """Median distance from a point of an (N, 3) cloud to its nearest neighbour; 0 for N < 2.

    tree: of the points, where there is one.

    Estimated on evenly strided points where there are more than 20,000, always against all points.
    """
    from scipy.spatial import cKDTree

    if len(points) < 2:
        return 0.0
    sample = points[:: -(-len(points) // SAMPLE)]
    distances, _ = (tree or cKDTree(points)).query(sample, k=2)
    return float(np.median(distances[:, 1]))


def lowest_point(
    points: NDArray[np.floating],
    heights: NDArray[np.floating],
    reach: NDArray[np.floating] | None = None,
) -> int:
    """Index of the lowest point of an (N, 3) cloud that is not alone.

    reach: as in the cloud's `Surroundings`, where these are known.

    Alone is a point whose 8th neighbour is more than ten times as far as is usual in the cloud.
    """
    from scipy.spatial import cKDTree

    order = np.argsort(heights, kind="stable")
    k = min(NEIGHBORS, len(points) - 1)
    if k < 1:
        return int(order[0])
    sample = slice(None, None, -(-len(points) // SAMPLE))
    tree = cKDTree(points) if reach is None else None

    def reach_of(chosen: NDArray[np.intp] | slice) -> NDArray[np.floating]:
        if tree is None:
            assert reach is not None
            return reach[chosen]
        return tree.query(points[chosen], k=[k + 1])[0][:, 0]

    usual = np.median(reach_of(sample))
    for first in range(0, len(order), BATCH):
        batch = order[first : first + BATCH]
        dense = reach_of(batch) <= ALONE * usual
        if dense.any():
            return int(batch[np.argmax(dense)])
    return int(order[0])


def without_outliers(points: NDArray[np.floating]) -> NDArray[np.bool_]:
    """(N,) mask of the points that are not alone, as `lowest_point` means it."""
    k = min(NEIGHBORS, len(points) - 1)
    if k < 1:
        return np.ones(len(points), bool)
    distance = reach(points, k)
    return distance <= ALONE * np.median(distance)


def reach(points: NDArray[np.floating], k: int) -> NDArray[np.float64]:
    """(N,) each point's distance to its k-th nearest other point, k < N.

    Asked for in the order of a Morton curve, which is three times as fast where scans are shuffled.
    """
    return _distances(points, (k,))[0]


def _distances(
    points: NDArray[np.floating], ranks: tuple[int, ...], workers: int = 1
) -> NDArray[np.float64]:
    """(ranks, N) each point's distance to its nearest other points of these ranks, from 1 on."""
    from scipy.spatial import cKDTree

    order = np.argsort(morton_codes(points), kind="stable")
    sorted_points = points[order]
    found = cKDTree(sorted_points).query(sorted_points, [k + 1 for k in ranks], workers=workers)[0]
    distances = np.empty((len(ranks), len(points)))
    distances[:, order] = found.T
    return distances
