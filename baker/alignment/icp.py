"""Trimmed iterative closest points (section 3.1; Besl & McKay 1992, Chetverikov et al. 2002)."""

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample
from baker.geometry.rigid import fit_rigid

INLIER_SHARE = 0.8  # the rest of the earlier points may have no partner: moved, lost or hidden
MAX_ITERATIONS, MIN_GAIN = 100, 1e-4


def trimmed_icp(
    earlier: EvenSample, later: EvenSample, start: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Register a later scan with an earlier one.

    Every point of the earlier sample is paired with the nearest one of the later scan, which has
    grown since; the farthest fifth of the pairs is trimmed.
    Returns the (4, 4) rigid transform from the later scan's coordinates to the earlier's.
    """
    from scipy.spatial import KDTree

    tree = KDTree(later.pool)
    transform, last = start, np.inf
    for _ in range(MAX_ITERATIONS):
        inverse = np.linalg.inv(transform)
        distances, nearest = tree.query(earlier.points @ inverse[:3, :3].T + inverse[:3, 3])
        inliers = _inliers(distances)
        error = float(np.sqrt((distances[inliers] ** 2).mean()))
        if error >= (1.0 - MIN_GAIN) * last:
            break
        last = error
        transform = fit_rigid(later.pool[nearest[inliers]], earlier.points[inliers])
    return transform


def trimmed_residual(
    earlier: EvenSample, later: EvenSample, transform: NDArray[np.float64]
) -> float:
    """Root mean square distance from the earlier sample to the later scan, best four fifths."""
    from scipy.spatial import KDTree

    moved = later.pool @ transform[:3, :3].T + transform[:3, 3]
    distances, _ = KDTree(moved).query(earlier.points)
    return float(np.sqrt((distances[_inliers(distances)] ** 2).mean()))


def _inliers(distances: NDArray[np.float64]) -> NDArray[np.intp]:
    count = max(int(np.ceil(INLIER_SHARE * len(distances))), 1)
    return np.argsort(distances, kind="stable")[:count]
