"""The nearest neighbours of every point of an organ, which one query finds for all traits."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

NEIGHBORS = 24  # of a point, enough to bound its Voronoi cell


class Neighbors(NamedTuple):
    """The k nearest other points of each of N points, sorted by distance.

    Attributes
    ----------
    distances : ndarray of shape (N, k)
    indices : ndarray of shape (N, k)
    """

    distances: NDArray[np.float64]
    indices: NDArray[np.intp]


def nearest_neighbors(points: NDArray[np.float64]) -> Neighbors:
    """Find the 24 nearest other points of each of (N, 3) points, or all others if N is smaller."""
    from scipy.spatial import cKDTree

    ranks = [*range(1, min(NEIGHBORS + 1, len(points)) + 1)]  # the first is the point itself
    distances, indices = cKDTree(points).query(points, ranks)
    return Neighbors(distances[:, 1:], indices[:, 1:])
