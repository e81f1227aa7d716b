"""Trimmed iterative closest points (section 3.1; Besl & McKay 1992, Chetverikov et al. 2002)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.sampling import EvenSample

KEPT_SHARE = 0.8  # the rest of the earlier points may have no partner: moved, lost or hidden
ITERATIONS, SMALLEST_GAIN = 100, 1e-4
DETERMINED = 1e-9  # of the largest singular value of the pairs' covariance: the second


def trimmed_icp(
    earlier: EvenSample, later: EvenSample, start: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(4, 4) rigid transform from the later scan's coordinates to the earlier's, from `start` on.

    Every earlier point looks for its nearest later one, as the plant has grown since; the worst
    fifth does not count.
    """
    from scipy.spatial import cKDTree

    tree = cKDTree(later.pool)
    transform, last = start, np.inf
    for _ in range(ITERATIONS):
        back = np.linalg.inv(transform)
        distances, nearest = tree.query(earlier.points @ back[:3, :3].T + back[:3, 3])
        kept = _nearest_share(distances)
        error = float(np.sqrt((distances[kept] ** 2).mean()))
        if error >= (1.0 - SMALLEST_GAIN) * last:
            break
        last = error
        transform = rigid_fit(later.pool[nearest[kept]], earlier.points[kept])
    return transform


def trimmed_residual(
    earlier: EvenSample, later: EvenSample, transform: NDArray[np.float64]
) -> float:
    """Root mean square distance from the earlier sample to the later scan, best four fifths."""
    from scipy.spatial import cKDTree

    moved = later.pool @ transform[:3, :3].T + transform[:3, 3]
    distances, _ = cKDTree(moved).query(earlier.points)
    return float(np.sqrt((distances[_nearest_share(distances)] ** 2).mean()))


def rigid_fit(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """(4, 4) rotation and translation of least squares between (n, 3) pairs (Kabsch 1976).

    Without a rotation where the pairs don't determine one, as points on a line don't.
    """
    centers = source.mean(axis=0), target.mean(axis=0)
    left, spread, right = np.linalg.svd((source - centers[0]).T @ (target - centers[1]))
    transform = np.eye(4)
    if spread[1] > DETERMINED * spread[0]:
        mirrored = np.linalg.det(left @ right) < 0
        transform[:3, :3] = (left @ np.diag([1.0, 1.0, -1.0 if mirrored else 1.0]) @ right).T
    transform[:3, 3] = centers[1] - transform[:3, :3] @ centers[0]
    return transform


def _nearest_share(distances: NDArray[np.float64]) -> NDArray[np.intp]:
    count = max(int(np.ceil(KEPT_SHARE * len(distances))), 1)
    return np.argsort(distances, kind="stable")[:count]
