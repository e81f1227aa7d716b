"""Where an organ is attached to its parent: at its points nearest to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

SHARE_AT_ATTACHMENT = 0.02  # of an organ's points, whose mean is its attachment point
SAMPLE_SIZE = 50  # points of an organ that bound its distance from its parent


def attachment_point(organ: NDArray[np.floating], parent: cKDTree) -> NDArray[np.float64]:
    """(3,) mean of the 2 % of an organ's points, (n, 3), that are nearest to its parent's."""
    distances = parent.query(organ)[0]
    count = max(1, round(SHARE_AT_ATTACHMENT * len(organ)))
    return organ[np.argsort(distances, kind="stable")[:count]].mean(axis=0, dtype=np.float64)


def points_near(
    parent: cKDTree, organ: NDArray[np.floating], margin: float = 0.0
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Indices, ascending, and distances of an organ's points, (n, 3), nearest to its parent's.

    margin: how much farther than the nearest one a point may be. Searches of a tree far from the
    points are slow, so a sample of them bounds the distance.
    """
    bound = parent.query(organ[:: max(1, len(organ) // SAMPLE_SIZE)])[0].min()
    bound = np.nextafter(bound + margin, np.inf)
    distances = parent.query(organ, distance_upper_bound=bound)[0]
    near = np.flatnonzero(distances <= distances.min() + margin)
    return near, distances[near]
