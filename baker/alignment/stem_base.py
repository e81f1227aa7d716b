"""The plant base: where the stem leaves the ground."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, weighted_graph
from baker.geometry.neighbors import NEIGHBORS_FOR_REACH, Neighbors, nearest_neighbors
from baker.geometry.up_axis import Vertical

MAX_CANDIDATES = 3
LOW_SHARE = 0.1  # of the height: the slab in which the stem's base is looked for
MIN_PART_SHARE = 0.1  # of that slab's points: fewer are noise, not a stem
BASE_SHARE = 0.04  # of the height: the part of the stem whose middle is the base
MAX_OFFSET_RATIO = 4.0  # of a scan's base from the median one, to the median of these offsets
MIN_OFFSET = 0.03  # of the plant's size: a base that is off by less stays


def base_candidates(
    sample: EvenSample, vertical: Vertical, pairs: NDArray[np.intp]
) -> list[NDArray[np.float64]]:
    """Positions where a single scan's stem may leave the ground, the likeliest first.

    The tip of a hanging leaf may lie as low as the stem's base, or lower. But the paths from the
    base to the plant's points lead upwards, except where organs droop, and those from a tip have to
    come down from the leaf's own bend: low parts are ranked by the mean descent on the paths from
    them. That is not always decisive, so up to three stay in question.

    pairs: (E, 2) points of the sample that touch, see `touching_pairs`.
    """
    from scipy.sparse.csgraph import connected_components, dijkstra

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
    root: NDArray[np.floating] | None = None,
    neighbors: Neighbors | None = None,
) -> int:
    """The point of a scan where the plant leaves the ground: its lowest one, outliers aside.

    Parameters
    ----------
    points : (N, 3) float
    vertical : Vertical
    root : (3,) float, optional
        A position given by the user; then the point nearest to it.
    neighbors : Neighbors, optional
    """
    if root is not None:
        return int(np.argmin(((points - root) ** 2).sum(axis=1)))
    neighbors = neighbors or nearest_neighbors(points, NEIGHBORS_FOR_REACH)
    return int(np.argmin(np.where(neighbors.inliers, vertical.height(points), np.inf)))


def agreed_base_points(
    clouds: Sequence[NDArray[np.floating]], bases: Sequence[int], vertical: Vertical
) -> list[int]:
    """The base points of aligned scans, corrected where a single scan's is far from the others'.

    The lowest point may be the tip of a leaf that hangs below the stem's base. Then it is far, seen
    from above, from where most scans have it, and the lowest point around there is the base.

    Parameters
    ----------
    clouds : sequence of (N, 3) float
    bases : sequence of int
        Each scan's `base_point`.
    vertical : Vertical
    """
    found = np.array([cloud[base] for cloud, base in zip(clouds, bases, strict=True)])
    found = vertical.at_height(found, 0.0)
    median = np.median(found, axis=0)
    offsets = np.linalg.norm(found - median, axis=1)
    agreed = []
    for cloud, base, offset in zip(clouds, bases, offsets, strict=True):
        size = float(np.ptp(cloud, axis=0).max())
        allowed = max(MAX_OFFSET_RATIO * float(np.median(offsets)), MIN_OFFSET * size)
        if offset > allowed:
            aside = np.linalg.norm(vertical.at_height(cloud, 0.0) - median, axis=1)
            near = np.flatnonzero(aside <= allowed)
            base = int(near[base_point(cloud[near], vertical)]) if len(near) else base
        agreed.append(base)
    return agreed
