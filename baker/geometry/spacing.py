"""Point spacing: the length scale that every threshold of the baker is relative to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.contacts import Gaps
from baker.geometry.parallel import thread_map

if TYPE_CHECKING:
    from baker.geometry.halves import Halves

SAMPLE = 20_000
NEIGHBORS, ALONE = 8, 10.0  # a point is alone whose 8th neighbour is ten times as far as usual


@dataclass(frozen=True)
class Surroundings:
    """What a point cloud's points have around them.

    spacing: as `point_spacing` has it.
    reach:   (N,) distance to the eighth nearest other point, or the last one of fewer; None for a
             cloud of one point.
    surface: (N,) what surface its eight nearest lie on, up to a factor; None if that is not asked.
    touching: by their labels, how far apart segments are that touch; None where that is not known.
    """

    spacing: float
    reach: NDArray[np.float64] | None
    surface: NDArray[np.float64] | None = None
    touching: Gaps | None = None

    @classmethod
    def of(
        cls,
        points: NDArray[np.floating],
        workers: int = 1,
        surface: bool = False,
        halves: Halves | None = None,
    ) -> Surroundings:
        """All from one search.

        workers: threads; surface: whether that is asked; halves: of the points, where known.
        """
        from baker.geometry.halves import Halves

        k = min(NEIGHBORS, len(points) - 1)
        if k < 1:
            return cls(0.0, None, np.ones(len(points)) if surface else None)
        found = _around(halves or Halves.of(points), k, workers, surface)
        spacing = float(np.median(found[0, :: -(-len(points) // SAMPLE)]))
        return cls(spacing, found[1], found[2] if surface else None)


def _around(halves: Halves, k: int, workers: int, surface: bool) -> NDArray[np.float64]:
    """(2 or 3, N) how far each point's nearest and k-th other point are; its surface, if asked."""
    from baker.geometry.surface import patches

    def look(batch: slice) -> NDArray[np.float64]:
        squared, near = halves.nearest(k, batch)
        nearest, farthest = np.sqrt(squared[:, 0]), np.sqrt(squared[:, -1])
        begin = halves.first[batch.start]
        patch = [patches(halves.points, begin, near, farthest)] if surface else []
        return np.stack([nearest, farthest, *patch])

    found = np.empty((3 if surface else 2, len(halves.points)))
    with thread_map(workers) as map:
        looks = list(map(look, halves.batches()))
    found[:, halves.order] = np.concatenate(looks, axis=1)
    return found


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


def lowest_point(
    points: NDArray[np.floating],
    heights: NDArray[np.floating],
    reach: NDArray[np.floating] | None = None,
) -> int:
    """Index of the lowest point of an (N, 3) cloud that is not alone.

    reach: as in the cloud's `Surroundings`, where these are known.

    Alone is a point whose 8th neighbour is more than ten times as far as is usual in the cloud.
    """
    k = min(NEIGHBORS, len(points) - 1)
    if k < 1:
        return 0
    apart = reaches(points, k) if reach is None else reach
    usual = np.median(apart[:: -(-len(points) // SAMPLE)])
    return int(np.argmin(np.where(apart <= ALONE * usual, heights, np.inf)))


def without_outliers(points: NDArray[np.floating]) -> NDArray[np.bool_]:
    """(N,) mask of the points that are not alone, as `lowest_point` means it."""
    k = min(NEIGHBORS, len(points) - 1)
    if k < 1:
        return np.ones(len(points), bool)
    distance = reaches(points, k)
    return distance <= ALONE * np.median(distance)


def reaches(points: NDArray[np.floating], k: int) -> NDArray[np.float64]:
    """(N,) each point's distance to its k-th nearest other point, k < N."""
    from baker.geometry.halves import Halves

    return _around(Halves.of(points), k, workers=1, surface=False)[1]
