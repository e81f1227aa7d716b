"""Merging of organs that one scan cuts finer than its neighbors (section 3.3.1).

Where labels are numbered anew in every scan, a leaf may be one organ on one day and two on the
next. The tracks then show a new organ beside one that has suddenly become smaller. Both are merged
where together they have the size and the shape that the organ had in the neighboring scan.
"""

from collections.abc import Collection, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.hierarchy import split_by_label

Points = NDArray[np.floating]
Tracks = NDArray[np.int64]

SAMPLE_SIZE = 200  # points of an organ that it is compared by
MIN_POINTS = 5  # of an organ that has a shape
# Thresholds of docs/method.md, "Merging". Lengths are relative to the size of the whole organ in
# the neighboring scan, or to the size that it would have now if it grew as the other organs do.
MAX_REST_SIZE = 0.95  # of what is left of the organ
WHOLE_SIZES = (0.85, 1.5)  # of both parts together, which need not have grown as others do
MAX_DISTANCE_RATIO = 0.85  # of the distance from the whole organ, over that from what is left of it
MAX_GAP = 0.15  # between the parts


def merge_parts(
    clouds: Sequence[Points], tracks: Sequence[Tracks], kept: Collection[int] = ()
) -> list[Tracks]:
    """Merge the organs of a scan that are one organ in the scan before or after it.

    Parameters
    ----------
    clouds : sequence of (N, 3) float ndarray
        The aligned scans.
    tracks : sequence of (N,) int64 ndarray
        The organ of each point, numbered the same in all scans.
    kept : collection of int
        Organs that are never merged into another one.

    Returns
    -------
    list of (N,) int64 ndarray
        The organ of each point; no organ has a number that it did not have before.

    References
    ----------
    Section 3.3.1 of the paper, which merges segments down the hierarchies of two scans.
    """
    merged = list(tracks)
    for order in (range(len(merged)), range(len(merged))[::-1]):
        known = set(kept)
        for near, scan in pairwise(order):
            known |= set(np.unique(merged[near]).tolist())
            merged[scan] = _merged(clouds[near], merged[near], clouds[scan], merged[scan], known)
    return merged


def _merged(
    near_cloud: Points, near_tracks: Tracks, cloud: Points, tracks: Tracks, known: set[int]
) -> Tracks:
    """The tracks of a scan, its new organs merged as the neighboring scan has them.

    known: organs that are not new.
    """
    whole, organs = _organs(near_cloud, near_tracks), _organs(cloud, tracks)
    shared = whole.keys() & organs.keys()
    new = sorted(organs.keys() - known, key=lambda organ: -len(organs[organ]))
    if not new or not shared:
        return tracks
    growth = float(np.median([_size(organs[organ]) / _size(whole[organ]) for organ in shared]))
    tracks = tracks.copy()
    for part in new:
        ratios = {
            organ: _distance_ratio(whole[organ], organs[organ], organs[part], growth)
            for organ in sorted(shared)
        }
        organ = min(ratios, key=lambda organ: ratios[organ])
        if ratios[organ] < MAX_DISTANCE_RATIO:
            tracks[tracks == part] = organ
            organs[organ] = np.concatenate([organs[organ], organs.pop(part)])
    return tracks


def _organs(cloud: Points, tracks: Tracks) -> dict[int, Points]:
    """The points of each organ that has enough of them, by its track number."""
    names, members = split_by_label(tracks)
    organs = zip(names, members, strict=True)
    return {name: cloud.take(own, axis=0) for name, own in organs if len(own) >= MIN_POINTS}


def _distance_ratio(whole: Points, rest: Points, part: Points, growth: float) -> float:
    """How much nearer an organ is to both its parts than to the rest; inf if these don't make it.

    whole: the organ in the neighboring scan. rest, part: what it may be cut into in this scan.
    growth: ratio of the sizes of other organs in this scan and in the neighboring one.
    """
    from scipy.spatial import KDTree

    size = _size(whole)
    expected = growth * size
    least, most = WHOLE_SIZES[0] * min(size, expected), WHOLE_SIZES[1] * max(size, expected)
    whole_again = least < _size(np.concatenate([rest, part])) < most
    if _size(rest) > MAX_REST_SIZE * expected or not whole_again:
        return np.inf
    if KDTree(_sample(rest)).query(_sample(part))[0].min() > MAX_GAP * expected:
        return np.inf
    distances = [
        KDTree(target).query(_sample(whole) - whole.mean(axis=0) + target.mean(axis=0))[0].mean()
        for target in (np.concatenate([_sample(rest), _sample(part)]), _sample(rest))
    ]
    return float(distances[0] / distances[1]) if distances[1] > 0 else np.inf


def _sample(points: Points) -> Points:
    return points[:: -(-len(points) // SAMPLE_SIZE)]


def _size(points: Points) -> float:
    """Root mean square distance of points from their mean."""
    return float(np.sqrt(points.var(axis=0).sum())) or np.finfo(float).tiny
