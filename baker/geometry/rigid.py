"""Rotations between directions, and between points."""

import numpy as np
from numpy.typing import NDArray

MIN_COSINE = -0.999  # the smallest rotation between nearly opposite directions is not unique


def rotations_between(
    origin: NDArray[np.floating], target: NDArray[np.floating]
) -> NDArray[np.float64]:
    """(n, 3, 3) smallest rotations between (n, 3) unit vectors, the identity for opposite ones."""
    axes, cosines = np.cross(origin, target), (origin * target).sum(axis=1)
    skew = np.swapaxes(np.cross(axes[:, None], np.eye(3)), 1, 2)  # skew @ x is the cross product
    # Rodrigues' formula without the angle; importing scipy's Rotation would take longer.
    turns = np.eye(3) + skew + skew @ skew / np.maximum(1.0 + cosines, 1e-9)[:, None, None]
    turns[cosines < MIN_COSINE] = np.eye(3)
    return turns


def fit_rotation(
    source: NDArray[np.floating], target: NDArray[np.floating], stiffness: float = 0.0
) -> NDArray[np.float64]:
    """Least squares rotation (3, 3) of centred (n, 3) points to their targets (Kabsch 1976).

    stiffness: resistance to a rotation, as a share of the points' moments. With a small one, points
    near a line are not rotated about it.
    """
    moments = source.T @ target
    u, _, vt = np.linalg.svd(moments + stiffness * np.linalg.norm(moments) * np.eye(3))
    vt[2] *= np.sign(np.linalg.det(u @ vt))  # no reflection
    return np.asarray((u @ vt).T)
