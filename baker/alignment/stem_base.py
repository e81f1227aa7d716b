"""The plant base, where the stem leaves the ground: of a scan, and of a series."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.geometry.graph import MIN_LENGTH
from baker.geometry.neighbors import NEIGHBORS_FOR_REACH, Neighbors, nearest_neighbors
from baker.geometry.up_axis import Vertical

CLOSE_SCORE = 0.4  # of two labels that may be the stem's; the likeliest is it in all real scans
MAX_CANDIDATES = 3
LOW_SHARE = 0.1  # of the height: the slab in which the stem's base is looked for
MIN_PART_SHARE = 0.1  # of that slab's points: fewer are noise, not a stem
BASE_SHARE = 0.04  # of the height: the part of the stem whose middle is the base
MAX_BASE_OFFSET = 0.06  # of the plant's largest size: bases so near are in one place

Points = NDArray[np.float64]


def stem_labels(samples: Sequence[EvenSample], vertical: Vertical) -> list[int]:
    """The label of each scan's stem: the organ that touches most others and stands lowest.

    A hanging leaf may reach lower, but touches few others and is high up for the most part. A label
    that is the stem's in two thirds of the scans is it in the others too, where it may be.
    """
    scores = [_stem_scores(sample, vertical) for sample in samples]
    likeliest = [max(own, key=own.__getitem__) for own in scores]
    usual, count = Counter(likeliest).most_common(1)[0]
    margin = CLOSE_SCORE if 3 * count >= 2 * len(scores) else 0.0
    return [
        usual if own.get(usual, -np.inf) >= own[best] - margin else best
        for own, best in zip(scores, likeliest, strict=True)
    ]


def _stem_scores(sample: EvenSample, vertical: Vertical) -> dict[int, float]:
    labels, heights = sample.pool_labels, vertical.height(sample.pool)
    touching = Counter(label for label, _ in sample.gaps)
    most = max(touching.values(), default=1)
    heights = (heights - heights.min()) / max(np.ptp(heights), np.finfo(float).tiny)
    scores = {}
    for label in np.unique(labels).tolist():
        own = heights[labels == label]
        scores[label] = touching[label] / most - float(own.min() + np.median(own))
    return scores


def stem_base(points: Points, vertical: Vertical) -> Points:
    """(3,) middle of the lowest points of a stem's (N, 3), at the height of the lowest one."""
    heights = vertical.height(points)
    low = heights <= heights.min() + BASE_SHARE * np.ptp(heights)
    middle = points[low].mean(axis=0)[None]
    return np.asarray(vertical.at_height(middle, float(heights.min()))[0], np.float64)


def common_base(
    samples: Sequence[EvenSample],
    stems: Sequence[int | None],
    vertical: Vertical,
) -> tuple[list[list[Points]], NDArray[np.bool_]]:
    """Where each scan's stem leaves the ground, and which scans have it in one place.

    A place is a scan's base if the lowest points about the vertical through it are there: a leaf
    that hangs lower hangs elsewhere. Of the bases that single scans may have, the place on which
    most scans agree is taken. Only the points of a labelled stem are looked at.

    Returned are each scan's base in its own coordinates, or the candidates where it is not in
    place; and (S,) whether it is. None is where there is no place on which most scans agree.
    """
    pools = [
        sample.pool if stem is None else sample.pool[sample.pool_labels == stem]
        for sample, stem in zip(samples, stems, strict=True)
    ]
    own = [
        base_candidates(sample, vertical) if stem is None else [stem_base(pool, vertical)]
        for sample, stem, pool in zip(samples, stems, pools, strict=True)
    ]
    radius = MAX_BASE_OFFSET * max(float(np.ptp(s.points, axis=0).max()) for s in samples)
    best: list[Points | None] = [None] * len(samples)
    for candidates, sample in zip(own, samples, strict=True):
        for place in candidates:
            found = [
                _base_about(place + sample.offset - s.offset, tried, pool, radius, vertical)
                for tried, pool, s in zip(own, pools, samples, strict=True)
            ]
            if sum(f is None for f in found) < sum(b is None for b in best):
                best = found
    in_place = np.array([base is not None for base in best])
    if 3 * in_place.sum() < 2 * len(samples):
        return own, np.zeros(len(samples), bool)
    return [b if base is None else [base] for b, base in zip(own, best, strict=True)], in_place


def _base_about(
    place: Points, candidates: Sequence[Points], pool: Points, radius: float, vertical: Vertical
) -> Points | None:
    """A scan's base at a place: a candidate near it, else the lowest points about it, or None."""
    nearest = min(candidates, key=lambda base: float(np.linalg.norm(base - place)))
    if np.linalg.norm(nearest - place) <= radius:
        return nearest
    about = pool[np.linalg.norm(vertical.at_height(pool - place, 0.0), axis=1) <= radius]
    if not len(about) or abs(vertical.height(about - place).min()) > radius:
        return None
    return stem_base(about, vertical)


def base_candidates(sample: EvenSample, vertical: Vertical) -> list[Points]:
    """Positions where a single scan's stem may leave the ground, the likeliest first.

    The tip of a hanging leaf may lie as low as the stem's base, or lower. But the paths from the
    base to the plant's points lead upwards, except where organs droop, and those from a tip have to
    come down from the leaf's own bend: low parts are ranked by the mean descent on the paths from
    them. That is not always decisive, so up to three stay in question.
    """
    from scipy.sparse.csgraph import connected_components, dijkstra

    graph = surface_graph(sample.points)
    heights = vertical.height(sample.points)
    height = np.ptp(heights)
    low = np.flatnonzero(heights <= heights.min() + LOW_SHARE * height)
    parts, part = connected_components(graph[low][:, low], directed=False)
    starts, ends = graph.nonzero()
    graph.data = np.maximum(heights[starts] - heights[ends], MIN_LENGTH)
    candidates = []
    for members in (low[part == number] for number in range(parts)):
        if len(members) < MIN_PART_SHARE * len(low):
            continue
        lowest = int(members[np.argmin(heights[members])])
        base = members[heights[members] <= heights[lowest] + BASE_SHARE * height]
        middle = vertical.at_height(sample.points[base].mean(axis=0)[None], heights[lowest])[0]
        candidates.append((float(dijkstra(graph, indices=lowest).mean()), lowest, middle))
    if not candidates:
        return [sample.points[np.argmin(heights)]]
    ranked = sorted(candidates, key=lambda candidate: candidate[:2])
    return [middle for _, _, middle in ranked[:MAX_CANDIDATES]]


def base_point(
    points: NDArray[np.floating],
    vertical: Vertical,
    neighbors: Neighbors | None = None,
    near: NDArray[np.floating] | None = None,
) -> int:
    """The point of an (N, 3) scan that is nearest to the (3,) plant base, outliers aside.

    Where that is not known it is the lowest point.
    """
    neighbors = neighbors or nearest_neighbors(points, NEIGHBORS_FOR_REACH)
    distance = vertical.height(points) if near is None else ((points - near) ** 2).sum(axis=1)
    return int(np.argmin(np.where(neighbors.inliers, distance, np.inf)))
