"""The scans' own scalar fields (NDVI, temperature, ...) on the movers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.scans import Scan
from gclip import Interval, Motion, PointField, Track
from gclip.evaluate import positions_on_curve


def mover_fields(
    intervals: Sequence[Interval],
    clouds: Sequence[NDArray[np.float32]],
    scans: Sequence[Scan],
    tracks: Sequence[Track],
) -> tuple[PointField, ...]:
    """Each field's values at both ends of the movers: those of the scans' points there.

    Parameters
    ----------
    intervals : sequence of Interval
        Between successive scans.
    clouds : sequence of (N, 3) float32 ndarray
        The scans about the clip's origin.
    scans : sequence of Scan
        With fields (`scalars`) of the same names.
    tracks : sequence of Track
        An organ that is born, or lost, has the values of the one scan that shows it throughout.

    Returns
    -------
    tuple of PointField
    """
    from scipy.spatial import cKDTree

    scalars = [scan.scalars for scan in scans]
    if not scalars[0]:
        return ()
    trees, born = [cKDTree(cloud) for cloud in clouds], np.array([track.born for track in tracks])
    values: dict[str, list[NDArray[np.float32]]] = {name: [] for name in scalars[0]}
    for k, interval in enumerate(intervals):
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
    return tuple(PointField(name, tuple(found)) for name, found in values.items())
