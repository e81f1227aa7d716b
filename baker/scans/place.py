"""One origin for a whole series, so that big world coordinates survive in float32."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.scans.cloud import Cloud

MAX_DISTANCE_RATIO = 16
"""Scans further from the world's zero than this many times their own size get an own origin."""

MIN_COORDINATE = 1e-18
"""Coordinates nearer to the origin than this are zero: in 32 bits their squares are nothing."""

MAX_SAMPLES = 20_000  # points of a scan by which its place is found

MAX_STEP_RATIO = 1e-5
"""A float32 step larger than this fraction of the scan's size is worth a note."""


def shared_origin(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The origin of a series: zeros, or a round place near its first scan.

    Parameters
    ----------
    points : (N, 3) ndarray of float64
        World positions of the first scan.

    Returns
    -------
    (3,) ndarray of float64

    Notes
    -----
    Zeros while float32 about the world's zero is exact enough (its step stays below 2e-6 of the
    plant); beyond that the lower corner of the box that holds 98 % of the points along each axis
    (single stray points, such as a scanner's zero returns, don't count), rounded down to the power
    of ten below the box's size so that it reads well and is the same for nearly equal scans.
    """
    low, high = np.percentile(points, [1, 99], axis=0)
    size = float((high - low).max())
    if size == 0 or max(np.abs(low).max(), np.abs(high).max()) <= MAX_DISTANCE_RATIO * size:
        return np.zeros(3)
    digits = -int(np.floor(np.log10(size)))
    step = 10.0**-digits
    return np.round(np.floor(low / step) * step, max(digits, 0))


def relative_to(origin: NDArray[np.float64], cloud: Cloud) -> Cloud:
    """`cloud` with points in float32 about `origin`; a note if this scan lies too far from it."""
    # Adding zero turns -0.0 into 0.0, so that equal points have equal bytes.
    exact = cloud.points - origin + 0.0
    local = np.where(np.abs(exact) < MIN_COORDINATE, 0.0, exact).astype(np.float32)
    moved = replace(cloud, points=local)

    low, high = np.percentile(exact[:: -(-len(exact) // MAX_SAMPLES)], [1, 99], axis=0)
    step = 2.0**-23 * max(np.abs(low).max(), np.abs(high).max())
    if step > MAX_STEP_RATIO * float((high - low).max()) > 0:
        return moved.noting(
            f"lies far from the series' first scan: its positions are kept to {step:.2g} only."
        )
    return moved
