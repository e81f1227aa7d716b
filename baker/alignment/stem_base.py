"""Find the plant base, where the stem leaves the ground, in the scans of a series."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.geometry.graph import MIN_LENGTH
from baker.geometry.neighbors import NEIGHBORS_FOR_REACH, Neighbors, nearest_neighbors
from baker.geometry.up_axis import Vertical

CLOSE_SCORE = 0.4  # by which the usual label of the stem may score less than another in a scan
MAX_CANDIDATES = 3
LOW_SHARE = 0.1  # of the height: the slab in which the base is searched for
MIN_PART_SHARE = 0.1  # of the points of that slab; smaller components are noise
BASE_SHARE = 0.04  # of the height: the part of the stem whose centroid is the base
MAX_BASE_OFFSET = 0.06  # of the plant's largest size, between bases that are in one place

Points = NDArray[np.float64]


def stem_labels(samples: Sequence[EvenSample], vertical: Vertical) -> list[int]:
    """The label of the stem in each scan: a low organ that is adjacent to many others.

    A hanging leaf may reach lower, but it is adjacent to few others, and most of it is high up. The
    label of the stem in two thirds of the scans is used in the others, too, if it scores well.
    """
    scores = [_stem_scores(sample, vertical) for sample in samples]
    best_labels = [max(of_scan, key=of_scan.__getitem__) for of_scan in scores]
    usual, count = Counter(best_labels).most_common(1)[0]
    margin = CLOSE_SCORE if 3 * count >= 2 * len(scores) else 0.0
    return [
        usual if of_scan.get(usual, -np.inf) >= of_scan[best] - margin else best
        for of_scan, best in zip(scores, best_labels, strict=True)
    ]


def _stem_scores(sample: EvenSample, vertical: Vertical) -> dict[int, float]:
    """Label -> score as the stem, by the number of adjacent organs and the height."""
    labels, heights = sample.pool_labels, vertical.height(sample.pool)
    adjacent = Counter(label for label, _ in sample.gaps)
    most = max(adjacent.values(), default=1)
    heights = (heights - heights.min()) / max(np.ptp(heights), np.finfo(float).tiny)
    scores = {}
    for label in np.unique(labels).tolist():
        of_organ = heights[labels == label]
        scores[label] = adjacent[label] / most - float(of_organ.min() + np.median(of_organ))
    return scores


def stem_base(points: Points, vertical: Vertical) -> Points:
    """(3,) centroid of the lowest of a stem's (N, 3) points, at the height of the lowest one."""
    heights = vertical.height(points)
    low = heights <= heights.min() + BASE_SHARE * np.ptp(heights)
    middle = points[low].mean(axis=0)[None]
    return np.asarray(vertical.at_height(middle, float(heights.min()))[0], np.float64)


def common_base(
    samples: Sequence[EvenSample], stems: Sequence[int | None], vertical: Vertical
) -> tuple[list[list[Points]], NDArray[np.bool_]]:
    """Find the position of the plant base on which most scans agree.

    Each scan has one or several candidates. A scan agrees with a position if one of its candidates
    is near, or if its lowest points near the vertical through the position are there; a leaf that
    hangs lower does so elsewhere. If the stem is labelled, only its points count.

    Parameters
    ----------
    samples : sequence of EvenSample
    stems : sequence of int or None
        The label of the stem in each scan.
    vertical : Vertical

    Returns
    -------
    bases : list of lists of (3,) float64
        The base of each scan in its coordinates, or its candidates if the scan does not agree.
    in_place : (S,) bool
        Whether each scan agrees; all False if there is no position on which two thirds agree.
    """
    pools = [
        sample.pool if stem is None else sample.pool[sample.pool_labels == stem]
        for sample, stem in zip(samples, stems, strict=True)
    ]
    candidates = [
        base_candidates(sample, vertical) if stem is None else [stem_base(pool, vertical)]
        for sample, stem, pool in zip(samples, stems, pools, strict=True)
    ]
    radius = MAX_BASE_OFFSET * max(float(np.ptp(s.points, axis=0).max()) for s in samples)
    best: list[Points | None] = [None] * len(samples)
    for of_scan, sample in zip(candidates, samples, strict=True):
        for position in of_scan:
            bases = [
                _base_near(position + sample.offset - s.offset, other, pool, radius, vertical)
                for other, pool, s in zip(candidates, pools, samples, strict=True)
            ]
            if sum(base is None for base in bases) < sum(base is None for base in best):
                best = bases
    in_place = np.array([base is not None for base in best])
    if 3 * in_place.sum() < 2 * len(samples):
        return candidates, np.zeros(len(samples), bool)
    return [
        of_scan if base is None else [base] for of_scan, base in zip(candidates, best, strict=True)
    ], in_place


def _base_near(
    position: Points, candidates: Sequence[Points], pool: Points, radius: float, vertical: Vertical
) -> Points | None:
    """The base of a scan near a position: a candidate, else its lowest points there, or None."""
    nearest = min(candidates, key=lambda base: float(np.linalg.norm(base - position)))
    if np.linalg.norm(nearest - position) <= radius:
        return nearest
    column = pool[np.linalg.norm(vertical.at_height(pool - position, 0.0), axis=1) <= radius]
    if not len(column) or abs(vertical.height(column - position).min()) > radius:
        return None
    return stem_base(column, vertical)


def base_candidates(sample: EvenSample, vertical: Vertical) -> list[Points]:
    """At most three possible positions of the plant base of a scan, the most likely first.

    The tip of a hanging leaf may be as low as the plant base. But the paths from the base to other
    points lead upwards, except where organs droop, while the paths from the tip first lead up the
    leaf and then down again. So low components are ranked by the mean descent on the paths from
    them to all points.
    """
    from scipy.sparse.csgraph import connected_components, dijkstra

    graph = surface_graph(sample.points)
    heights = vertical.height(sample.points)
    height = np.ptp(heights)
    low = np.flatnonzero(heights <= heights.min() + LOW_SHARE * height)
    count, component = connected_components(graph[low][:, low], directed=False)
    starts, ends = graph.nonzero()
    graph.data = np.maximum(heights[starts] - heights[ends], MIN_LENGTH)
    candidates = []
    for members in (low[component == number] for number in range(count)):
        if len(members) < MIN_PART_SHARE * len(low):
            continue
        lowest = int(members[np.argmin(heights[members])])
        base = members[heights[members] <= heights[lowest] + BASE_SHARE * height]
        center = vertical.at_height(sample.points[base].mean(axis=0)[None], heights[lowest])[0]
        candidates.append((float(dijkstra(graph, indices=lowest).mean()), lowest, center))
    if not candidates:
        return [sample.points[np.argmin(heights)]]
    ranked = sorted(candidates, key=lambda candidate: candidate[:2])
    return [center for _, _, center in ranked[:MAX_CANDIDATES]]


def base_point(
    points: NDArray[np.floating],
    vertical: Vertical,
    neighbors: Neighbors | None = None,
    near: NDArray[np.floating] | None = None,
) -> int:
    """Index of the point of a scan that is the base of the plant.

    Parameters
    ----------
    points : (N, 3) float
    vertical : Vertical
    neighbors : Neighbors, optional
        Of the points; those that are outliers are ignored.
    near : (3,) float, optional
        The plant base, to which the nearest point is taken; by default, the lowest point is.
    """
    neighbors = neighbors or nearest_neighbors(points, NEIGHBORS_FOR_REACH)
    distance = vertical.height(points) if near is None else ((points - near) ** 2).sum(axis=1)
    return int(np.argmin(np.where(neighbors.inliers, distance, np.inf)))
