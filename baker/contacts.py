"""Which segments of a labelled cloud touch each other, and how far they are apart there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.borders import near_others

REACH = 3.0  # gap that still counts as touching, in median point spacings
NEIGHBORS = 32  # neighbours looked at for touching points of other segments

MOST_ORGANS = 1000
"""Labels of a scan, above which they number something else than organs (matching all of them with
all of the next scan's would take hours)."""

Gaps = Mapping[tuple[int, int], float]  # by what grows, and what it may grow from


@dataclass(frozen=True)
class Borders:
    """Where segments of a labelled cloud may touch.

    points: (N, 3), best along a Morton curve: searches are faster then.
    names:  (K,) the labels.
    owner:  (N,) which of them each point has.
    near:   (N,) whether a point may be within reach of another segment; most are not.
    reach:  the gap that still counts as touching.
    """

    points: NDArray[np.floating]
    names: NDArray[np.integer]
    owner: NDArray[np.intp]
    near: NDArray[np.bool_]
    reach: float

    @classmethod
    def of(
        cls, points: NDArray[np.floating], labels: NDArray[np.integer], spacing: float
    ) -> Borders:
        """Those of (N, 3) points of (N,) labels; spacing: of the cloud's points."""
        names, owner = np.unique(labels, return_inverse=True)
        reach = REACH * spacing
        return cls(points, names, owner, near_others(points, owner, reach), reach)


def contacts(borders: Borders, workers: int = 1) -> Gaps:
    """By their labels, both ways, how far apart segments are that touch; workers: threads."""
    names = borders.names.tolist()
    return {
        (names[one], names[other]): gap
        for (a, b), gap in _smallest_gaps(borders, workers).items()
        for one, other in ((a, b), (b, a))
    }


def _smallest_gaps(borders: Borders, workers: int) -> dict[tuple[int, int], float]:
    """Smallest distance between each two segments that come closer than the reach."""
    from scipy.spatial import cKDTree

    # Points of two segments that are near each other are both among these.
    points, owner = borders.points[borders.near], borders.owner[borders.near]
    k = min(NEIGHBORS, len(points))
    if k < 2:
        return {}
    distances, neighbors = cKDTree(points, balanced_tree=False).query(
        points,
        k=k,
        distance_upper_bound=max(borders.reach, np.finfo(float).tiny),
        workers=workers,
    )
    others = np.append(owner, -1)[neighbors]  # none where there are not as many within reach
    place, rank = np.nonzero((others != owner[:, None]) & (others >= 0))
    one, other, gap = owner[place], others[place, rank], distances[place, rank]
    a, b = np.minimum(one, other), np.maximum(one, other)
    order = np.lexsort((gap, b, a))
    pairs, nearest = np.unique(np.stack([a, b], axis=1)[order], axis=0, return_index=True)
    return {
        (int(i), int(j)): float(g) for (i, j), g in zip(pairs, gap[order][nearest], strict=True)
    }
