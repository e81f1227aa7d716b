"""Segment adjacency: which segments of a labelled cloud touch, and across what gap."""

from collections.abc import Mapping, Sequence

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
    labels, neighbors : (N,) int, Neighbors
        The segment of each point, and what is around it.

    Returns
    -------
    Gaps, in length units, of all nearer than three point spacings.
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


def agreed_gaps(
    labels: Sequence[NDArray[np.integer]], adjacency: Sequence[Gaps], spacings: Sequence[float]
) -> Gaps:
    """Mean gaps between an organ and what it may grow from, over all scans that show both.

    In a dense crown leaves touch branches that they don't grow from, and in a single scan they may
    be nearer to those than a branch is to its parent. An organ's parent touches it in every scan.

    Parameters
    ----------
    labels, adjacency, spacings : sequences of (N,) int, Gaps and float
        Of each scan the organ of each point, which has the same label in all scans, its
        `segment_adjacency` and its point spacing.

    Returns
    -------
    Gaps from (organ, possible parent), in point spacings, of all that touch in some scan. Where
    they don't touch they count as far apart as what barely does. Nothing grows from what is
    younger.
    """
    shown = [set(np.unique(names).tolist()) for names in labels]
    first = {label: scan for scan in reversed(range(len(shown))) for label in shown[scan]}
    pairs = sorted({pair for gaps in adjacency for pair in gaps})
    agreed = {}
    for pair in (pair for pair in pairs if first[pair[1]] <= first[pair[0]]):
        seen = (k for k, present in enumerate(shown) if present.issuperset(pair))
        gaps = [adjacency[k].get(pair, MAX_GAP * spacings[k]) / spacings[k] for k in seen]
        agreed[pair] = float(np.mean(gaps))
    return agreed
