"""The scans' own scalar fields (NDVI, temperature, ...) on the movers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.scans import Scan
from gclip import Clip, Motion, PointField
from gclip.evaluate import positions_on_curve


def with_fields(clip: Clip, clouds: Sequence[NDArray[np.float32]], scans: Sequence[Scan]) -> Clip:
    """The clip with its scans' fields on the movers: at both ends, those of the points there.

    Parameters
    ----------
    clip : Clip
        An organ that is born, or lost, has the values of the one scan that shows it throughout.
    clouds : sequence of (N, 3) float32 ndarray
        The scans about the clip's origin.
    scans : sequence of Scan
        With fields (`scalars`) of the same names.
    """
    from scipy.spatial import cKDTree

    scalars = [scan.scalars for scan in scans]
    if not scalars[0]:
        return clip
    trees, born = [cKDTree(cloud) for cloud in clouds], np.array([t.born for t in clip.track_table])
    values: dict[str, list[NDArray[np.float32]]] = {name: [] for name in scalars[0]}
    for k, interval in enumerate(clip.intervals):
        first, last = (
            trees[k + u].query(positions_on_curve(interval, slice(None), u))[1] for u in (0, 1)
        )
        newborn = born[np.asarray(interval.tracks)] > interval.start
        lost = np.zeros(len(interval), bool)
        for group in interval.groups:
            lost[group.first : group.stop] = group.motion is not Motion.MOVE
        for name, found in values.items():
            start, end = scalars[k][name][first], scalars[k + 1][name][last]
            ends = np.where(newborn, end, start), np.where(lost, start, end)
            found.append(np.stack(ends, axis=1))
    fields = tuple(PointField(name, tuple(found)) for name, found in values.items())
    return replace(clip, fields=fields)
