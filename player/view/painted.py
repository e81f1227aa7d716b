"""Values as the colours of a clip, so that all that shows colours shows them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gclip import Interval

UNKNOWN = (150, 150, 150)  # sRGB of movers whose value is not known


def painted(interval: Interval, ramp: NDArray[np.uint8], *ends: NDArray[np.floating]) -> Interval:
    """A copy of an interval that wears values as colours.

    Parameters
    ----------
    interval : Interval
        Of N movers.
    ramp : (steps, 3) uint8 ndarray
        sRGB of values from 0 to 1, and of those beyond.
    *ends : (N,) ndarray
        The movers' values at the interval's start and at its end, or one for both; NaN is unknown.
    """
    colors = []
    for values in ends:
        paint = np.full((len(interval), 4), 255, np.uint8)
        paint[:, :3] = UNKNOWN
        known = np.flatnonzero(~np.isnan(values))
        steps = np.clip(values[known], 0.0, 1.0) * (len(ramp) - 1)
        paint[known, :3] = ramp[np.round(steps).astype(int)]
        colors.append(paint)
    return replace(interval, start_colors=colors[0], end_colors=colors[-1])
