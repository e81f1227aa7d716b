"""Where the stem leaves the ground: the low place from which the plant is reached by climbing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.sample_graph import way_graph
from baker.geometry.sampling import EvenSample
from baker.geometry.up_axis import Vertical

CANDIDATES = 3
LOW_SHARE = 0.1  # of the height: the slab in which the stem's foot is looked for
PART_SHARE = 0.1  # of that slab's points: fewer are strays, not a foot
FOOT_SHARE = 0.04  # of the height: the foot itself, whose middle is the base


def stem_bases(
    sample: EvenSample, vertical: Vertical, pairs: NDArray[np.intp]
) -> list[NDArray[np.float64]]:
    """Where the foot of the stem may be, each (3,), the likeliest first; at least one, at most 3.

    pairs: (E, 2) of the sample's points that touch, see `touching_pairs`.

    The tip of a hanging leaf may lie as low as the foot, or lower. But the ways from the foot to
    the plant's points lead upwards, except where organs droop, and those from a tip have to come
    down from the leaf's own bend: the low parts are told apart by the mean descent on the ways from
    them. That is not always decisive, so the others stay in question.
    """
    from scipy.sparse.csgraph import connected_components, dijkstra

    count, heights = len(sample.points), vertical.height(sample.points)
    extent = np.ptp(heights)
    low = heights <= heights.min() + LOW_SHARE * extent
    among_low = pairs[low[pairs].all(axis=1)]
    _, part = connected_components(way_graph(among_low, np.ones(len(among_low)), count))
    descents = np.maximum(heights[pairs[:, 0]] - heights[pairs[:, 1]], 0.0)
    ways = way_graph(pairs, descents, count)
    feet = []
    for number in np.unique(part[low]):
        members = np.flatnonzero(low & (part == number))
        if len(members) < PART_SHARE * low.sum():
            continue
        lowest = members[np.argmin(heights[members])]
        foot = members[heights[members] <= heights[lowest] + FOOT_SHARE * extent]
        middle = vertical.at_height(sample.points[foot].mean(axis=0)[None], heights[lowest])[0]
        feet.append((float(dijkstra(ways, indices=lowest).mean()), int(lowest), middle))
    if not feet:
        return [sample.points[np.argmin(heights)]]
    return [middle for _, _, middle in sorted(feet, key=lambda each: each[:2])[:CANDIDATES]]
