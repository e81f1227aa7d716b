"""The nearest neighbours of every point of an organ, which one query finds for all traits."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

NEIGHBORS = 24  # enough to bound the Voronoi cell of a point


class Neighbors(NamedTuple):
    """The k nearest other points of each of N points, sorted by distance.

    Attributes
    ----------
    distances : ndarray of shape (N, k)
    indices : ndarray of shape (N, k)
    """

    distances: NDArray[np.float64]
    indices: NDArray[np.intp]


def nearest_neighbors(points: NDArray[np.float64], k: int = NEIGHBORS) -> Neighbors:
    """Find the k nearest other points of each of (N, 3) points, fewer if N is at most k."""
    from scipy.spatial import cKDTree

    ranks = [*range(1, min(k + 1, len(points)) + 1)]  # the first is the point itself
    distances, indices = cKDTree(points).query(points, ranks)
    return Neighbors(distances[:, 1:], indices[:, 1:])
