"""Local growth rates of the surface of organs.

The variance of the positions of neighbouring movers does not change where an organ is displaced or
rotated, but only where its surface grows.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from os import cpu_count

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Interval, Motion
from gclip.evaluate import positions_on_curve

MAX_SAMPLE = 3000  # movers of an organ whose rates are computed; others get that of the nearest
NEIGHBOR_SHARE = 0.05  # number of neighbours : number of an organ's sampled movers
MIN_NEIGHBORS, MAX_NEIGHBORS = 24, 160  # with fewer, the noise of the scans dominates the rates


def growth_rates(clip: Clip) -> list[NDArray[np.float64]]:
    """Relative growth rates of lengths on the surface.

    Parameters
    ----------
    clip : gclip.Clip

    Returns
    -------
    list of (N,) float64 ndarray
        For each interval, the rate of each mover in percent by the clip's unit of time: the
        derivative of the logarithm of lengths. Infinite if the organ is born, NaN if it is lost.
    """
    born = np.array([track.born for track in clip.track_table])
    with ThreadPoolExecutor(cpu_count()) as threads:
        return list(threads.map(partial(_interval_rates, born), clip.intervals))


def _interval_rates(born: NDArray[np.float64], interval: Interval) -> NDArray[np.float64]:
    """(N,) rates of the movers of an interval; born: (T,) times at which organs are born."""
    from scipy.spatial import KDTree

    rates = np.full(len(interval), np.nan)
    start, end = (positions_on_curve(interval, slice(None), u).astype(float) for u in (0.0, 1.0))
    tracks = np.asarray(interval.tracks)
    is_moving = np.zeros(len(interval), bool)
    for group in interval.groups:
        is_moving[group.first : group.stop] = group.motion is Motion.MOVE
    for track in np.unique(tracks[is_moving]).tolist():
        movers = np.flatnonzero(is_moving & (tracks == track))
        sample = movers[:: -(-len(movers) // MAX_SAMPLE)]
        if born[track] > interval.start:
            rates[movers] = np.inf
            continue
        if len(sample) < MIN_NEIGHBORS:
            continue
        count = min(max(int(NEIGHBOR_SHARE * len(sample)), MIN_NEIGHBORS), MAX_NEIGHBORS)
        # Neighbours are found at mid-interval. If they were found at one end, they would be nearest
        # there by selection, and would seem to move apart towards the other end.
        tree = KDTree((start[sample] + end[sample]) / 2)
        neighbors = sample[tree.query(tree.data, k=count)[1]]
        first, last = (points[neighbors].var(axis=1).sum(axis=1) for points in (start, end))
        growth = np.log(np.maximum(last, 1e-300) / np.maximum(first, 1e-300)) / 2
        nearest = tree.query((start[movers] + end[movers]) / 2)[1]
        rates[movers] = 100.0 * growth[nearest] / (interval.end - interval.start)
    return rates
