"""How fast the plant grows where: local growth, whatever carries the part of it that grows.

The mean distance of a mover's neighbours from their centre is the same wherever a stem or a stalk
takes them, however they turn; it changes as the surface about the mover stretches.
"""

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Interval, Motion
from gclip.evaluate import positions_on_curve

SAMPLE = 3000  # movers of an organ that rates are found of; the others take that of the nearest
SHARE = 0.05  # of an organ's movers that make a neighbourhood
FEWEST, MOST = 24, 160  # of them: fewer tell the scans' noise


def growth_rates(clip: Clip) -> list[NDArray[np.float64]]:
    """Relative growth rates of lengths on the surface.

    Parameters
    ----------
    clip : gclip.Clip

    Returns
    -------
    list of (N,) float64 ndarray
        For each interval, of each mover in percent by the clip's unit of time: the rate at which
        the logarithm of lengths grows. Infinite where the organ is born, NaN where it is lost.
    """
    born = np.array([track.born for track in clip.track_table])
    return [_rates(interval, born) for interval in clip.intervals]


def _rates(interval: Interval, born: NDArray[np.float64]) -> NDArray[np.float64]:
    from scipy.spatial import cKDTree

    rates = np.full(len(interval), np.nan)
    start, end = (positions_on_curve(interval, slice(None), u).astype(float) for u in (0.0, 1.0))
    tracks = np.asarray(interval.tracks)
    moves = np.zeros(len(interval), bool)
    for group in interval.groups:
        moves[group.first : group.stop] = group.motion is Motion.MOVE
    for track in np.unique(tracks[moves]).tolist():
        own = np.flatnonzero(moves & (tracks == track))
        some = own[:: -(-len(own) // SAMPLE)]
        if born[track] > interval.start:
            rates[own] = np.inf
            continue
        if len(some) < FEWEST:
            continue
        count = min(max(int(SHARE * len(some)), FEWEST), MOST)
        # Neighbours half-way, since those at one end are by choice nearer to each other there.
        half_way = cKDTree((start[some] + end[some]) / 2)
        around = some[half_way.query(half_way.data, k=count)[1]]
        first, last = (points[around].var(axis=1).sum(axis=1) for points in (start, end))
        found = np.log(np.maximum(last, 1e-300) / np.maximum(first, 1e-300)) / 2
        nearest = half_way.query((start[own] + end[own]) / 2)[1]
        rates[own] = 100.0 * found[nearest] / (interval.end - interval.start)
    return rates
