"""Segment adjacency: which segments of a labelled cloud touch, and across what gap."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors

MAX_GAP = 3.0  # between segments that touch, in point spacings

Gaps = Mapping[tuple[int, int], float]
"""Gaps by the labels of two segments, in either order."""


def segment_adjacency(labels: NDArray[np.integer], neighbors: Neighbors) -> Gaps:
    """Find the segments that touch, and the smallest distance between points of theirs.

    Parameters
    ----------
    labels : (N,) int
    neighbors : Neighbors
        Of the N points.

    Returns
    -------
    dict
        From a pair of labels, in either order, to the gap, of pairs nearer than 3 point spacings.
    """
    names, segment = np.unique(labels, return_inverse=True)
    touching = segment[neighbors.indices] != segment[:, None]
    touching &= neighbors.distances <= MAX_GAP * neighbors.spacing
    i, column = np.nonzero(touching)
    ends = np.sort(segment[np.stack([i, neighbors.indices[i, column]])], axis=0)
    pairs, number = np.unique(ends[0] * len(names) + ends[1], return_inverse=True)
    gaps = np.full(len(pairs), np.inf)
    np.minimum.at(gaps, number, neighbors.distances[i, column])
    first, second = (names[side].tolist() for side in np.divmod(pairs, len(names)))
    found = dict(zip(zip(first, second, strict=True), gaps.tolist(), strict=True))
    return found | {(b, a): gap for (a, b), gap in found.items()}
