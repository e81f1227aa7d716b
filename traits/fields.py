"""Means of scalar fields (NDVI, temperature, ...) over organs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gclip import Motion
from gclip.evaluate import locate

if TYPE_CHECKING:
    from gclip import Clip


def field_means(clip: Clip, day: float, track: int | None = None) -> dict[str, float]:
    """Mean of each field over the points of an organ, or of the plant.

    Parameters
    ----------
    clip : gclip.Clip
    day : float
        At the time of a scan, the mean is over its points; in between, the means of both scans are
        interpolated.
    track : int, optional
        Id of the organ; by default the whole plant.

    Returns
    -------
    dict of str to float
        By field, without fields that have no values.
    """
    if not clip.fields:
        return {}
    index, share = locate(clip, day)
    interval = clip.intervals[index]
    is_visible = np.ones(len(interval), bool)
    for group in interval.groups:
        is_visible[group.first : group.stop] = group.motion is Motion.MOVE or share < 1.0
    if track is not None:
        is_visible &= np.asarray(interval.tracks) == track
    movers = np.flatnonzero(is_visible)
    # Several movers may share a point of a scan, which counts once.
    ends = (np.asarray(p[movers]) for p in (interval.curve[0], interval.curve[-1]))
    first, last = (np.unique(points, axis=0, return_index=True)[1] for points in ends)
    result = {}
    for name, ends_of_movers in zip(clip.fields, interval.fields, strict=True):
        values = np.asarray(ends_of_movers, float)[movers]
        weighted = ((1.0 - share, values[first, 0]), (share, values[last, 1]))
        means = [weight * _mean(of_scan) for weight, of_scan in weighted if weight]
        if np.isfinite(means).all():
            result[name] = float(sum(means))
    return result


def _mean(values: np.ndarray) -> float:
    """The mean of the finite values; NaN if there are none."""
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else float("nan")
