"""Speeds at which the points of a plant move."""

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Motion
from gclip.evaluate import positions_on_curve

MAX_SAMPLE = 20_000  # movers of an interval whose speeds are computed


def mean_speeds(clip: Clip) -> list[NDArray[np.float64]]:
    """Mean speeds between scans of a sample of the movers.

    Parameters
    ----------
    clip : gclip.Clip

    Returns
    -------
    list of (n,) float64 ndarray
        For each interval, the distance from start to end of some of the movers that persist,
        divided by the interval's duration, in the clip's units of length and time.
    """
    speeds = []
    for interval in clip.intervals:
        count = sum(group.count for group in interval.groups if group.motion is Motion.MOVE)
        sample = slice(0, count, max(count // MAX_SAMPLE, 1))
        start, end = (positions_on_curve(interval, sample, share) for share in (0.0, 1.0))
        distance = np.linalg.norm(end.astype(float) - start, axis=1)
        speeds.append(distance / (interval.end - interval.start))
    return speeds
