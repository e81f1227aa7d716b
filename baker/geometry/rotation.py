"""Rotations as arrays of (n, 3, 3) matrices for column vectors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Matrices = NDArray[np.float64]

OPPOSITE = -0.999  # cosine of an angle at which the smallest rotation is anyone's guess


def between(origin: NDArray[np.float64], target: NDArray[np.float64]) -> Matrices:
    """(n, 3, 3) the smallest rotations of unit vectors (n, 3) onto others.

    The identity where they oppose each other.
    """
    cosine = np.clip((origin * target).sum(axis=1), -1.0, 1.0)
    skew = _cross_matrices(np.cross(origin, target))
    opposite = cosine < OPPOSITE
    factor = 1.0 / np.where(opposite, 1.0, 1.0 + cosine)
    turns = np.eye(3) + skew + skew @ skew * factor[:, None, None]
    turns[opposite] = np.eye(3)
    return turns


def about(axes: NDArray[np.float64], angles: NDArray[np.float64]) -> Matrices:
    """(n, 3, 3) rotations about unit axes (n, 3) by angles (n,), radians (Rodrigues' formula)."""
    skew = _cross_matrices(axes)
    angle = angles[:, None, None]
    return np.eye(3) + np.sin(angle) * skew + (1.0 - np.cos(angle)) * (skew @ skew)


def _cross_matrices(axes: NDArray[np.float64]) -> Matrices:
    """(n, 3, 3) so that each times v is axis x v."""
    x, y, z = axes.T
    zero = np.zeros(len(axes))
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
