"""Rotations between directions."""

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
