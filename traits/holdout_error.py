"""Distances between a clip and the scans that it was baked without (`bake --holdout`)."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Group, Interval, Motion
from gclip.evaluate import evaluate_layer, layers_at, locate


def holdout_errors(clip: Clip) -> list[NDArray[np.float64]]:
    """Distances of movers from held-out scans.

    Returns
    -------
    list of (N,) float64 ndarray
        For each mover of each interval the distance to the nearest point of the scan that was held
        out in that interval, at the time of that scan. NaN if there is no such scan, or the mover
        is not part of the plant at that time.
    """
    from scipy.spatial import cKDTree

    errors = [np.full(len(interval), np.nan) for interval in clip.intervals]
    for scan in clip.held_out:
        index, nearest = locate(clip, scan.time)[0], cKDTree(scan.positions)
        for layer in layers_at(clip, scan.time):
            if layer.interval == index and not layer.litter and len(scan.positions):
                local, movers = evaluate_layer(clip, layer)[0], layer.group
                errors[index][movers.first : movers.stop] = nearest.query(local)[0]
    return errors


def held_out_as_clip(clip: Clip, index: int) -> tuple[Clip, NDArray[np.float64]]:
    """Make a clip of one interval without motion from a held-out scan.

    Parameters
    ----------
    clip : gclip.Clip
    index : int
        Of the scan in ``clip.held_out``.

    Returns
    -------
    clip : gclip.Clip
        Each point has the track and the colour of the nearest mover.
    distances : (N,) float64 ndarray
        From each point to that mover.
    """
    from scipy.spatial import cKDTree

    scan = clip.held_out[index]
    frame = clip.at(scan.time)
    distances, nearest = cKDTree(frame.local).query(scan.positions)
    colors = frame.colors[nearest] if clip.has_colors else None
    interval = Interval(
        start=clip.times[0],
        end=clip.times[-1],
        degree=1,
        groups=(Group(0, len(scan.positions), Motion.MOVE),),
        curve=(scan.positions, scan.positions),
        tracks=np.asarray(frame.tracks)[nearest].astype(np.uint32),
        start_colors=colors,
        end_colors=colors,
    )
    ends = tuple(replace(clip.scans[end], points=len(scan.positions)) for end in (0, -1))
    return replace(clip, scans=ends, intervals=(interval,), fields=(), held_out=()), distances
