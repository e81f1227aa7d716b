"""What the report draws: the organs' growth curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.up_axis import Vertical
from gclip import Clip
from traits.axis import axis_of
from traits.organs import samples_at

POINTS_FOR_LENGTH = 800  # of an organ, that its length is measured on
MAX_TICKS = 5  # of the growth curves' axis, above 0


@dataclass(frozen=True)
class Curve:
    """The lengths of one organ at the scans that show it."""

    track: int
    times: list[float]
    lengths: list[float]

    @property
    def last(self) -> float:
        return self.lengths[-1]


def growth_curves(clip: Clip) -> list[Curve]:
    """Lengths of the organs along their midlines at the scans, the longest organ first.

    They are measured on fewer points than those of `bake --traits`, which says how sure each is.
    """
    vertical = Vertical.named(clip.up)
    up = vertical.sign * np.eye(3)[vertical.axis]
    born = {track.id: track.born for track in clip.track_table}
    parents = {track.id: track.parent for track in clip.track_table}
    found: dict[int, list[tuple[float, float]]] = {}
    for time in clip.times:
        (sample,) = samples_at(clip, time)
        clouds: dict[int | None, NDArray[np.float64]] = {
            track: organ.points[:: -(-len(organ.points) // POINTS_FOR_LENGTH)]
            for track, organ in sample.organs.items()
            if born[track] <= time
        }
        for track in sample.organs.keys() & clouds.keys():
            cloud = clouds[track]
            axis = axis_of(cloud, clouds.get(parents[track], np.zeros((0, 3))), up)
            if axis is not None:
                found.setdefault(track, []).append((time, axis.length))
    curves = [Curve(t, *map(list, zip(*values, strict=True))) for t, values in found.items()]
    return sorted(curves, key=lambda curve: -max(curve.lengths))


def length_ticks(curves: Sequence[Curve]) -> list[float]:
    """Round lengths from 0 to no less than the longest of the growth curves."""
    longest = max((max(curve.lengths) for curve in curves), default=1.0)
    most = 2.5 * longest / MAX_TICKS  # rounding may more than halve it
    power = 10.0 ** np.floor(np.log10(most))
    step = float(max(digit * power for digit in (1.0, 2.0, 5.0) if digit * power <= most))
    return [step * k for k in range(int(np.ceil(longest / step)) + 1)]
