"""Where a plant leaves the ground, asked of all scans of a series at once: it never walks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.spacing import lowest_point
from baker.geometry.up_axis import Vertical
from gclip.morton import extent

ASTRAY = 4.0  # times as far from where most scans have it as it usually is
FAR = 0.03  # of the plant's size, that it is off by at least


def standing_bases(
    clouds: Sequence[NDArray[np.floating]], bases: Sequence[int], vertical: Vertical
) -> list[int]:
    """The bases of aligned scans, indices of points, those led astray put back.

    The lowest point may be the tip of a leaf that hangs below the stem's foot. Then it is far, seen
    from above, from where most scans have it, and the lowest point around there is the foot.
    """
    feet = _level(
        np.array([cloud[base] for cloud, base in zip(clouds, bases, strict=True)]), vertical
    )
    middle = np.median(feet, axis=0)
    off = np.linalg.norm(feet - middle, axis=1)
    put = []
    for cloud, base, away in zip(clouds, bases, off, strict=True):
        usual = max(ASTRAY * float(np.median(off)), FAR * _size(cloud))
        if away > usual:
            aside = np.linalg.norm(_level(cloud, vertical) - middle, axis=1)
            around = np.flatnonzero(aside <= usual)
            if len(around):
                heights = vertical.height(cloud[around])
                base = int(around[lowest_point(cloud[around], heights)])
        put.append(base)
    return put


def _size(points: NDArray[np.floating]) -> float:
    low, high = extent(points)
    return float((high - low).max())


def _level(points: NDArray[np.floating], vertical: Vertical) -> NDArray[np.floating]:
    """(n, 3) points at the height of the ground."""
    return vertical.at_height(points, 0.0)
