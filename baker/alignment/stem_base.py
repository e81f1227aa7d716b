"""The plant base: where the stem leaves the ground."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import (
    NEIGHBORS_ON_SURFACE,
    EvenSample,
    touching_pairs,
    weighted_graph,
)
from baker.geometry.neighbors import NEIGHBORS_FOR_REACH, Neighbors, nearest_neighbors
from baker.geometry.up_axis import Vertical

CLOSE_SCORE = 0.4  # of two labels that may be the stem's; the likeliest is it in all real scans
MAX_CANDIDATES = 3
LOW_SHARE = 0.1  # of the height: the slab in which the stem's base is looked for
MIN_PART_SHARE = 0.1  # of that slab's points: fewer are noise, not a stem
BASE_SHARE = 0.04  # of the height: the part of the stem whose middle is the base


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


def stem_base(points: NDArray[np.float64], vertical: Vertical) -> NDArray[np.float64]:
    """(3,) middle of the lowest points of a stem's (N, 3), at the height of the lowest one."""
    heights = vertical.height(points)
    low = heights <= heights.min() + BASE_SHARE * np.ptp(heights)
    middle = points[low].mean(axis=0)[None]
    return np.asarray(vertical.at_height(middle, float(heights.min()))[0], np.float64)


def base_candidates(sample: EvenSample, vertical: Vertical) -> list[NDArray[np.float64]]:
    """Positions where a single scan's stem may leave the ground, the likeliest first.

    The tip of a hanging leaf may lie as low as the stem's base, or lower. But the paths from the
    base to the plant's points lead upwards, except where organs droop, and those from a tip have to
    come down from the leaf's own bend: low parts are ranked by the mean descent on the paths from
    them. That is not always decisive, so up to three stay in question.
    """
    from scipy.sparse.csgraph import connected_components, dijkstra

    pairs = touching_pairs(sample, NEIGHBORS_ON_SURFACE)
    count, heights = len(sample.points), vertical.height(sample.points)
    height = np.ptp(heights)
    low = heights <= heights.min() + LOW_SHARE * height
    among_low = pairs[low[pairs].all(axis=1)]
    _, part = connected_components(weighted_graph(among_low, np.ones(len(among_low)), count))
    descents = np.maximum(heights[pairs[:, 0]] - heights[pairs[:, 1]], 0.0)
    graph = weighted_graph(pairs, descents, count)
    candidates = []
    for number in np.unique(part[low]):
        members = np.flatnonzero(low & (part == number))
        if len(members) < MIN_PART_SHARE * low.sum():
            continue
        lowest = members[np.argmin(heights[members])]
        base = members[heights[members] <= heights[lowest] + BASE_SHARE * height]
        middle = vertical.at_height(sample.points[base].mean(axis=0)[None], heights[lowest])[0]
        candidates.append((float(dijkstra(graph, indices=lowest).mean()), int(lowest), middle))
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
    """The point of a scan where the plant leaves the ground; outliers aside.

    Parameters
    ----------
    points : (N, 3) float
    vertical : Vertical
    neighbors : Neighbors, optional
    near : (3,) float, optional
        The plant base, of which the nearest point is taken; by default it is the lowest point.
    """
    neighbors = neighbors or nearest_neighbors(points, NEIGHBORS_FOR_REACH)
    distance = vertical.height(points) if near is None else ((points - near) ** 2).sum(axis=1)
    return int(np.argmin(np.where(neighbors.inliers, distance, np.inf)))
