"""Trimmed iterative closest points (section 3.1; Besl & McKay 1992, Chetverikov et al. 2002)."""

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample

INLIER_SHARE = 0.8  # of the pairs; the other points may have moved, or be lost or hidden
MAX_ITERATIONS, MIN_GAIN = 100, 1e-4
MIN_SPREAD = 1e-9  # second singular value of the pairs' covariance, relative to the first

Matrix = NDArray[np.float64]


def trimmed_icp(earlier: EvenSample, later: EvenSample, start: Matrix) -> Matrix:
    """Register a later scan with an earlier one.

    Every point of the earlier sample is paired with the nearest point of the later scan, in which
    the plant has grown; the fifth of the pairs with the largest distances is left out.

    Parameters
    ----------
    earlier, later : EvenSample
    start : (4, 4) float64
        Initial transform.

    Returns
    -------
    (4, 4) float64
        The rigid transform from the later scan's coordinates to the earlier's.
    """
    transform, last = start, np.inf
    for _ in range(MAX_ITERATIONS):
        error, source, target = _nearest_pairs(earlier, later, transform)
        if error >= (1.0 - MIN_GAIN) * last:
            break
        last = error
        transform = fit_rigid(source, target)
    return transform


def trimmed_residual(earlier: EvenSample, later: EvenSample, transform: Matrix) -> float:
    """Root mean square of the smallest four fifths of the distances of the pairs."""
    return _nearest_pairs(earlier, later, transform)[0]


def fit_rigid(source: Matrix, target: Matrix) -> Matrix:
    """Least squares rigid transform (4, 4) between (n, 3) pairs of points (Kabsch 1976).

    It is a translation if the pairs do not determine a rotation, like points on a line.
    """
    from scipy.spatial.transform import Rotation

    centers = source.mean(axis=0), target.mean(axis=0)
    centered_source, centered_target = source - centers[0], target - centers[1]
    transform = np.eye(4)
    spread = np.linalg.svd(centered_source.T @ centered_target, compute_uv=False)
    if spread[1] > MIN_SPREAD * spread[0]:
        rotation, _ = Rotation.align_vectors(centered_target, centered_source)
        transform[:3, :3] = rotation.as_matrix()
    transform[:3, 3] = centers[1] - transform[:3, :3] @ centers[0]
    return transform


def _nearest_pairs(
    earlier: EvenSample, later: EvenSample, transform: Matrix
) -> tuple[float, Matrix, Matrix]:
    """Root mean square distance of the pairs, and their later and earlier points."""
    from scipy.spatial import KDTree

    inverse = np.linalg.inv(transform)
    moved = earlier.points @ inverse[:3, :3].T + inverse[:3, 3]
    distances, nearest = KDTree(later.pool).query(moved)
    count = max(int(np.ceil(INLIER_SHARE * len(distances))), 1)
    inliers = np.argsort(distances, kind="stable")[:count]
    error = float(np.sqrt((distances[inliers] ** 2).mean()))
    return error, later.pool[nearest[inliers]], earlier.points[inliers]
