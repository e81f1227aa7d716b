"""Growth curves: the lengths of the organs at the scans."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from traits.axis import axis_of
from traits.organs import samples_at
from traits.traits import up_vector

if TYPE_CHECKING:
    from gclip import Clip

POINTS_FOR_LENGTH = 800  # of an organ, that its length is measured on


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
    """Lengths of the organs along their midlines at the scans.

    They are measured on fewer points than those of `measure`, which says how sure each is.

    Parameters
    ----------
    clip : gclip.Clip

    Returns
    -------
    list of Curve
        The longest organ first.
    """
    up = up_vector(clip.up)
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
