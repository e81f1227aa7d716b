"""How far a clip is from the scans that it was baked without (`bake --holdout`), as colours."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Group, Interval, Motion
from gclip.evaluate import evaluate_layer, layers_at, locate


def holdout_errors(clip: Clip) -> list[NDArray[np.float64]]:
    """Of each interval's movers, (N,), the distances to the nearest point of the scan that was left
    out there, at its own time; NaN where the mover is no part of the plant then, or none was.
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


def held_out_as_clip(clip: Clip, number: int) -> tuple[Clip, NDArray[np.float64]]:
    """A scan that was left out, by its number, as a clip that stands still: to be seen beside the
    state that was rebuilt. Each of its points has the organ and the colour of the nearest mover;
    the distances to it tell what the clip lacks.
    """
    from scipy.spatial import cKDTree

    scan = clip.held_out[number]
    frame = clip.at(scan.time)
    missed, nearest = cKDTree(frame.local).query(scan.positions)
    paint = frame.colors[nearest] if clip.has_colors else None
    interval = Interval(
        start=clip.times[0],
        end=clip.times[-1],
        degree=1,
        groups=(Group(0, len(scan.positions), Motion.MOVE),),
        curve=(scan.positions, scan.positions),
        tracks=np.asarray(frame.tracks)[nearest].astype(np.uint32),
        start_colors=paint,
        end_colors=paint,
    )
    ends = tuple(replace(clip.scans[end], points=len(scan.positions)) for end in (0, -1))
    return replace(clip, scans=ends, intervals=(interval,), fields=(), held_out=()), missed
