"""Merge organs that one scan divides into more parts than its neighbouring scans (section 3.3.1).

If labels are numbered anew in every scan, a leaf may be one organ in one scan and two in the next.
The tracks then show a new organ next to one that has suddenly become smaller. The two are merged if
together they have the size and shape of the organ in the neighbouring scan.
"""

from collections.abc import Collection, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.hierarchy import split_by_label

Points = NDArray[np.floating]
Tracks = NDArray[np.int64]

SAMPLE_SIZE = 200  # points of an organ from which distances are computed
MIN_POINTS = 5  # of an organ that is compared
# Thresholds of docs/method.md, "Merging". Lengths are relative to the size of the whole organ in
# the neighbouring scan, times the growth of the other organs (of MAX_REST_SIZE and MAX_GAP).
MAX_REST_SIZE = 0.95  # of the organ without the part
WHOLE_SIZES = (0.85, 1.5)  # of the organ with the part, with or without growth
MAX_DISTANCE_RATIO = 0.85  # distance of the whole organ to both parts : to the rest alone
MAX_GAP = 0.15  # between the parts


def merge_parts(
    clouds: Sequence[Points], tracks: Sequence[Tracks], kept: Collection[int] = ()
) -> list[Tracks]:
    """Merge the organs of a scan that are one organ in the previous or next scan.

    clouds: (N, 3) aligned scans. tracks: (N,) track number of each point. kept: organs that are
    never merged into another one. Returns tracks without new numbers.

    References
    ----------
    Section 3.3.1 of the paper, which merges segments down the hierarchies of two scans.
    """
    merged = list(tracks)
    for order in (range(len(merged)), range(len(merged))[::-1]):
        known = set(kept)
        for other, scan in pairwise(order):
            known |= set(np.unique(merged[other]).tolist())
            neighbor = clouds[other], merged[other]
            merged[scan] = _merge_new(*neighbor, clouds[scan], merged[scan], known)
    return merged


def _merge_new(
    other_cloud: Points, other_tracks: Tracks, cloud: Points, tracks: Tracks, known: set[int]
) -> Tracks:
    """Merge the new organs of a scan, those not in `known`, by comparison with another scan."""
    whole, organs = _organs(other_cloud, other_tracks), _organs(cloud, tracks)
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
    """Track number -> points, of the organs with at least `MIN_POINTS`."""
    names, members = split_by_label(tracks)
    organs = zip(names, members, strict=True)
    return {name: cloud.take(each, axis=0) for name, each in organs if len(each) >= MIN_POINTS}


def _distance_ratio(whole: Points, rest: Points, part: Points, growth: float) -> float:
    """The mean distance of an organ to two parts together, over that to the rest alone.

    It is infinite if the parts are far apart or don't have the size of the organ.

    whole: the organ in the neighbouring scan. rest, part: its two parts in this scan.
    growth: ratio of the sizes of the other organs in this scan and in the neighbouring one.
    """
    from scipy.spatial import KDTree

    size = _size(whole)
    expected = growth * size
    low, high = WHOLE_SIZES[0] * min(size, expected), WHOLE_SIZES[1] * max(size, expected)
    is_whole = low < _size(np.concatenate([rest, part])) < high
    if _size(rest) > MAX_REST_SIZE * expected or not is_whole:
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
