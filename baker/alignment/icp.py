"""Trimmed iterative closest points (section 3.1; Besl & McKay 1992, Chetverikov et al. 2002)."""

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample
from baker.geometry.rigid import fit_rotation

INLIER_SHARE = 0.8  # of the pairs; the other points may have moved, or be lost or hidden
MAX_ITERATIONS, MIN_GAIN = 100, 1e-4  # relative decrease of the error of a further iteration

Matrix = NDArray[np.float64]


def trimmed_icp(earlier: EvenSample, later: EvenSample) -> Matrix:
    """(4, 4) rigid transform that registers a later scan with an earlier one."""
    transform, last = np.eye(4), np.inf
    for _ in range(MAX_ITERATIONS):
        error, source, target = nearest_pairs(earlier, later, transform)
        if error >= (1.0 - MIN_GAIN) * last:
            break
        last = error
        transform = fit_rigid(source, target)
    return transform


def nearest_pairs(
    earlier: EvenSample, later: EvenSample, transform: Matrix
) -> tuple[float, Matrix, Matrix]:
    """Pair the points of an earlier scan with the nearest ones of the later, grown scan.

    The fifth of the pairs with the largest distances is left out. Returns the root mean square
    distance of the remaining pairs, and their (n, 3) points in the later and the earlier scan.

    transform: (4, 4) from the later scan's coordinates to those of the earlier one.
    """
    from scipy.spatial import cKDTree

    moved = (earlier.points - transform[:3, 3]) @ transform[:3, :3]
    distances, nearest = cKDTree(later.pool).query(moved)
    count = max(int(np.ceil(INLIER_SHARE * len(distances))), 1)
    inliers = np.argsort(distances, kind="stable")[:count]
    error = float(np.sqrt((distances[inliers] ** 2).mean()))
    return error, later.pool[nearest[inliers]], earlier.points[inliers]


def fit_rigid(source: Matrix, target: Matrix) -> Matrix:
    """Least squares rigid transform (4, 4) between (n, 3) pairs of points."""
    centers = source.mean(axis=0), target.mean(axis=0)
    transform = np.eye(4)
    transform[:3, :3] = fit_rotation(source - centers[0], target - centers[1])
    transform[:3, 3] = centers[1] - transform[:3, :3] @ centers[0]
    return transform
