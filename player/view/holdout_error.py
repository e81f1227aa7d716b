"""How far a clip is from the scans that it was baked without, and in colours.

`bake --holdout 2` leaves every second scan out, and the clip carries those aligned with it
(docs/format.md, `held_out`). At such a scan's own time each mover of its interval is so far from
the nearest of its points. That distance is the mover's error; it keeps its colour while its
interval lasts, so that one sees where the plant went wrong, and how it came to that.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Group, Interval, Motion
from gclip.evaluate import evaluate_layer, layers_at, locate

HIGH = 0.98  # share of the movers whose error is below the highest colour's


class Errors:
    """Of one clip that holds scans that were left out."""

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._scans = {locate(clip, scan.time)[0]: scan for scan in clip.held_out}

    @cached_property
    def intervals(self) -> dict[int, NDArray[np.float64]]:
        """By interval, (N,) each mover's error in the clip's length unit; NaN where the mover is
        no part of the plant at that time. Intervals without a scan left out are missing.
        """
        return {index: self._of(index) for index in self._scans}

    @property
    def values(self) -> list[NDArray[np.float64]]:
        """As `intervals`, of all of them: NaN where there is no scan to compare with."""
        unknown = (np.full(len(interval), np.nan) for interval in self._clip.intervals)
        return [self.intervals.get(index, nothing) for index, nothing in enumerate(unknown)]

    @cached_property
    def high(self) -> float:
        """An error that few movers exceed."""
        known = np.concatenate([errors[np.isfinite(errors)] for errors in self.intervals.values()])
        return float(np.quantile(known, HIGH)) if len(known) else 0.0

    def scan_as_clip(self, number: int) -> tuple[Clip, NDArray[np.float64]]:
        """A scan that was left out, by its number, as a clip that stands still: to be seen beside
        the state that was rebuilt. Each of its points has the organ and the colour of the nearest
        mover; the distances to it tell what the clip lacks.
        """
        from scipy.spatial import cKDTree

        clip, scan = self._clip, self._clip.held_out[number]
        frame = clip.at(scan.time)
        missed, nearest = cKDTree(frame.local).query(scan.positions)
        interval = Interval(
            start=clip.times[0],
            end=clip.times[-1],
            box=None,
            groups=(Group(0, len(scan.positions), Motion.MOVE),),
            start_positions=scan.positions,
            end_positions=scan.positions,
            control_positions=(),
            tracks=np.asarray(frame.tracks)[nearest].astype(np.uint32),
        )
        if clip.has_colors:
            paint = frame.colors[nearest]
            interval = replace(interval, start_colors=paint, end_colors=paint)
        ends = tuple(replace(clip.scans[end], points=len(scan.positions)) for end in (0, -1))
        return replace(clip, scans=ends, intervals=(interval,), held_out=()), missed

    def _of(self, index: int) -> NDArray[np.float64]:
        from scipy.spatial import cKDTree

        clip, scan = self._clip, self._scans[index]
        errors = np.full(len(clip.intervals[index]), np.nan)
        if not len(scan.positions):
            return errors
        nearest = cKDTree(scan.positions)
        for layer in layers_at(clip, scan.time):
            if layer.interval == index and not layer.litter:
                local = evaluate_layer(clip, layer)[0]
                errors[layer.group.first : layer.group.stop] = nearest.query(local)[0]
        return errors
