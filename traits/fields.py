"""Means of the scans' own fields (NDVI, temperature, ...) over organs."""

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
        At a scan's own time the mean is that of its points; in between, those of both scans are
        weighted by time.
    track : int, optional
        Id of the organ; the whole plant if not given.

    Returns
    -------
    dict of str to float
        By the field's name; without those that no point has.
    """
    if not clip.fields:
        return {}
    index, share = locate(clip, day)
    interval = clip.intervals[index]
    shown = np.ones(len(interval), bool)
    for group in interval.groups:
        shown[group.first : group.stop] = group.motion is Motion.MOVE or share < 1.0
    if track is not None:
        shown &= np.asarray(interval.tracks) == track
    own = np.flatnonzero(shown)
    # Several movers may share a scan's point, which counts once.
    places = (interval.start_positions, interval.end_positions)
    first, last = (np.unique(np.asarray(at[own]), axis=0, return_index=True)[1] for at in places)
    found = {}
    for field in clip.fields:
        values = np.asarray(field.values[index], float)[own]
        both = ((1.0 - share, values[first, 0]), (share, values[last, 1]))
        means = [weight * _mean(ends) for weight, ends in both if weight]
        if np.isfinite(means).all():
            found[field.name] = float(sum(means))
    return found


def _mean(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else float("nan")
