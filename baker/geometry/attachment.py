"""Where an organ is attached to its parent: at its points nearest to it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

SHARE_AT_ATTACHMENT = 0.02  # of an organ's points, whose mean is its attachment point
TINY = 1e-30
SAMPLE_SIZE = 50  # points of an organ that bound its distance from its parent


class Attachment(NamedTuple):
    """Where an organ touches its parent."""

    nearest: int  # index of the organ's point that is nearest to its parent
    gap: float  # the distance between the two
    point: NDArray[np.float64]  # (3,) mean of the organ's nearest points, at most 2 % of them


def attachment(organ: NDArray[np.floating], parent: cKDTree) -> Attachment:
    """Find where an organ, (n, 3) points, is attached.

    Searches far from the points of a tree are slow. So a sample bounds the distance: of fifty
    points the nearest is about as near as 2 % of all.
    """
    nearest = parent.query(organ[:: max(1, len(organ) // SAMPLE_SIZE)])[0].min()
    bound = max(1.000001 * nearest, TINY)  # what is found is nearer than the bound, by its square
    distances = parent.query(organ, distance_upper_bound=bound)[0]
    near = np.flatnonzero(distances < np.inf)
    count = max(1, round(SHARE_AT_ATTACHMENT * len(organ)))
    near = near[np.argsort(distances[near], kind="stable")][:count]
    point = organ[near].mean(axis=0, dtype=np.float64)
    return Attachment(int(near[0]), float(distances[near[0]]), point)
