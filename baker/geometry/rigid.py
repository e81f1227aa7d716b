"""Rigid motions: fitted to pairs of points, and the smallest rotations between directions."""

import numpy as np
from numpy.typing import NDArray

MIN_SPREAD = 1e-9  # second singular value of the pairs' covariance, relative to the first
MIN_COSINE = -0.999  # between directions; nearly opposite, their smallest rotation is not unique


def fit_rigid(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation and translation of least squares between pairs of points (Kabsch 1976).

    Parameters
    ----------
    source, target : (n, 3) float64

    Returns
    -------
    (4, 4) float64, from `source` to `target`; without a rotation where the pairs do not determine
    one, as points on a line do not.
    """
    from scipy.spatial.transform import Rotation

    centers = source.mean(axis=0), target.mean(axis=0)
    before, after = source - centers[0], target - centers[1]
    transform = np.eye(4)
    spread = np.linalg.svd(before.T @ after, compute_uv=False)
    if spread[1] > MIN_SPREAD * spread[0]:
        transform[:3, :3] = Rotation.align_vectors(after, before)[0].as_matrix()
    transform[:3, 3] = centers[1] - transform[:3, :3] @ centers[0]
    return transform


def rotations_between(
    origin: NDArray[np.float64], target: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Smallest rotations of directions onto others.

    Parameters
    ----------
    origin, target : (n, 3) float64, unit vectors

    Returns
    -------
    (n, 3, 3) float64, the identity where two directions are nearly opposite.
    """
    axes, cosines = np.cross(origin, target), (origin * target).sum(axis=1)
    skew = np.swapaxes(np.cross(axes[:, None], np.eye(3)), 1, 2)  # skew @ x is the cross product
    # Rodrigues' formula without the angle: Rotation would be imported for this alone.
    turns = np.eye(3) + skew + skew @ skew / np.maximum(1.0 + cosines, 1e-9)[:, None, None]
    turns[cosines < MIN_COSINE] = np.eye(3)
    return turns
