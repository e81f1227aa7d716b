"""Where an organ is attached to its parent: at its points nearest to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

SHARE_AT_ATTACHMENT = 0.02  # of an organ's points, whose mean is its attachment point


def attachment_point(organ: NDArray[np.floating], parent: cKDTree) -> NDArray[np.float64]:
    """The mean of the 2 % of an organ's points that are nearest to its parent.

    Parameters
    ----------
    organ : (n, 3) float
    parent : cKDTree
        Of the parent's points.

    Returns
    -------
    (3,) float64
    """
    distances = parent.query(organ)[0]
    count = max(1, round(SHARE_AT_ATTACHMENT * len(organ)))
    return organ[np.argsort(distances, kind="stable")[:count]].mean(axis=0, dtype=np.float64)
