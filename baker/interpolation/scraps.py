"""Which lost organs are scraps of our own cutting, and none that the plant has shed.

Where organs are found without labels, a bit of a leaf may be an organ in one scan and a part of its
leaf in the next. It is lost then, but nothing has fallen: the plant is still there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

FEWEST = 40  # points of an organ that may be told from a scrap
# Of its radii (root mean square), how far nine in ten of a scrap's points are at most from what is
# there later: 0.2 to 2.0 on real scans. A leaf is three radii long from where it was attached.
NEAR, MOST = 2.2, 0.9


def is_scrap(points: NDArray[np.floating], later: cKDTree) -> bool:
    """Whether a lost organ of (n, 3) points was no organ of its own.

    later: the next scan's points, to search in.
    """
    if len(points) < FEWEST:
        return True
    away = later.query(points)[0]
    radius = np.sqrt(((points - points.mean(axis=0)) ** 2).sum(axis=1).mean())
    return bool(np.quantile(away, MOST) <= NEAR * radius)
