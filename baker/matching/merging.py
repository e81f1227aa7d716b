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

SAMPLE_SIZE = 200  # number of points of an organ from which distances are computed
MIN_POINTS = 5  # of an organ that is compared
# docs/method.md, "Merging". Sizes and gaps are relative to the size of the organ in the
# neighbouring scan, times the growth of the other organs.
MAX_REST_SIZE = 0.95  # of the organ without the part
SIZE_RANGE = (0.85, 1.5)  # of the organ with the part; also allowed without growth
MAX_DISTANCE_RATIO = 0.85  # ratio of the whole's distance to both parts to that to the rest
MAX_GAP = 0.15  # between the parts


def merge_parts(
    clouds: Sequence[Points], tracks: Sequence[Tracks], protected: Collection[int] = ()
) -> list[Tracks]:
    """Merge the organs of a scan that are one organ in the previous or next scan.

    clouds, tracks: (N, 3) points and (N,) track numbers of each aligned scan. protected: tracks
    that are never merged into another one. Returns the tracks, without new numbers. In section
    3.3.1 of the paper, segments are merged down the hierarchies of two scans instead.
    """
    merged = list(tracks)
    for order in (range(len(merged)), range(len(merged))[::-1]):
        earlier = set(protected)
        for neighbor, scan in pairwise(order):
            earlier |= set(np.unique(merged[neighbor]).tolist())
            pair = clouds[neighbor], merged[neighbor]
            merged[scan] = _merge_new(pair, clouds[scan], merged[scan], earlier)
    return merged


def _merge_new(
    neighbor: tuple[Points, Tracks], cloud: Points, tracks: Tracks, earlier: set[int]
) -> Tracks:
    """Merge the new organs of a scan, those not in `earlier`, by comparison with a neighbour."""
    reference, organs = _organs(*neighbor), _organs(cloud, tracks)
    shared = reference.keys() & organs.keys()
    new = sorted(organs.keys() - earlier, key=lambda organ: -len(organs[organ]))
    if not new or not shared:
        return tracks
    growth = float(np.median([_size(organs[organ]) / _size(reference[organ]) for organ in shared]))
    tracks = tracks.copy()
    for part in new:
        ratios = {
            organ: _distance_ratio(reference[organ], organs[organ], organs[part], growth)
            for organ in sorted(shared)
        }
        organ = min(ratios, key=lambda organ: ratios[organ])
        if ratios[organ] < MAX_DISTANCE_RATIO:
            tracks[tracks == part] = organ
            organs[organ] = np.concatenate([organs[organ], organs.pop(part)])
    return tracks


def _organs(cloud: Points, tracks: Tracks) -> dict[int, Points]:
    """The points of the organs with at least `MIN_POINTS`, by track number."""
    organs = zip(*split_by_label(tracks), strict=True)
    return {track: cloud.take(part, axis=0) for track, part in organs if len(part) >= MIN_POINTS}


def _distance_ratio(reference: Points, rest: Points, part: Points, growth: float) -> float:
    """Ratio of the mean distance from an organ to two parts together, to that to the rest alone.

    It is infinite if the parts are not adjacent or don't have the size of the organ.

    reference: the organ in the neighbouring scan. rest, part: its two parts in this scan.
    growth: ratio of the sizes of the other organs in this scan to those in the neighbouring one.
    """
    from scipy.spatial import cKDTree

    size = _size(reference)
    expected = growth * size
    low, high = SIZE_RANGE[0] * min(size, expected), SIZE_RANGE[1] * max(size, expected)
    is_whole = low < _size(np.concatenate([rest, part])) < high
    if _size(rest) > MAX_REST_SIZE * expected or not is_whole:
        return np.inf
    if cKDTree(_sample(rest)).query(_sample(part))[0].min() > MAX_GAP * expected:
        return np.inf
    centered = _sample(reference) - reference.mean(axis=0)
    distances = [
        cKDTree(target).query(centered + target.mean(axis=0))[0].mean()
        for target in (np.concatenate([_sample(rest), _sample(part)]), _sample(rest))
    ]
    return float(distances[0] / distances[1]) if distances[1] > 0 else np.inf


def _sample(points: Points) -> Points:
    """Every k-th point, with the smallest k that leaves at most `SAMPLE_SIZE` of them."""
    return points[:: -(-len(points) // SAMPLE_SIZE)]


def _size(points: Points) -> float:
    """Root mean square distance of points from their mean."""
    return float(np.sqrt(points.var(axis=0).sum())) or np.finfo(float).tiny
