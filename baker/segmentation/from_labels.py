"""A hierarchy on a given segmentation, by successive nearest neighbour searches (section 3.2.1).

Where the paper is silent: the threshold is three times the median spacing, the nearest gap is
bridged first, a segment never reached joins at its smallest gap, and where the root segment is far
from all others (ten spacings) no label is the stem: all hang under a virtual, empty root.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.adjacency import Gaps, segment_adjacency
from baker.geometry.neighbors import Neighbors, nearest_neighbors
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy, split_by_label

Indices = NDArray[np.intp]

MAX_ROOT_GAP = 10.0  # in point spacings: the lowest segment, if farther, is no stem of the others


def hierarchy_from_labels(
    points: NDArray[np.floating],
    labels: NDArray[np.integer],
    root_label: int,
    neighbors: Neighbors | None = None,
    agreed: Gaps | None = None,
) -> Hierarchy:
    """Hang the labelled segments of a cloud into a tree under the one of `root_label`.

    points, labels: (N, 3) and (N,). neighbors: of the points, where they are known. agreed:
    `agreed_gaps` of all scans, which decide instead of this scan's which segment grows from which.
    """
    names, segments = split_by_label(labels)
    neighbors = neighbors or nearest_neighbors(points)
    gaps = segment_adjacency(labels, neighbors)
    first = names.index(root_label)
    others = set(range(len(segments))) - {first}
    if len(others) > 1 and not any(root_label in pair for pair in gaps):
        gap, *_ = _smallest_gap(points, segments, {first}, others)
        if gap > MAX_ROOT_GAP * neighbors.spacing:
            return under_virtual_root(labels)
    number = {name: index for index, name in enumerate(names)}
    numbered_gaps = {
        (number[a], number[b]): gap
        for (a, b), gap in (agreed or gaps).items()
        if a in number and b in number
    }
    parents, notes = [NO_PARENT] * len(segments), []
    reached, unreached = {first}, others
    while unreached:  # Prim's algorithm; whatever stays apart is bridged at its smallest gap
        touching = [
            (gap, child, parent)
            for (child, parent), gap in numbered_gaps.items()
            if parent in reached and child in unreached
        ]
        if touching:
            _, child, parent = min(touching)
        else:
            gap, child, parent = _smallest_gap(points, segments, reached, unreached)
            notes.append(
                f"segment {names[child]} touches no other one; it was hung on segment "
                f"{names[parent]} across a gap of {gap:.3g}"
            )
        parents[child] = parent
        reached.add(child)
        unreached.remove(child)
    return Hierarchy(tuple(segments), tuple(names), tuple(parents), first, tuple(notes))


def _smallest_gap(
    points: NDArray[np.floating],
    segments: Sequence[Indices],
    reached: set[int],
    unreached: set[int],
) -> tuple[float, int, int]:
    """The gap, the unreached segment and the reached segment that are nearest to each other."""
    from scipy.spatial import KDTree

    def gather(which: set[int]) -> tuple[Indices, Indices]:
        ids = sorted(which)
        owner = np.repeat(ids, [len(segments[i]) for i in ids])
        return np.concatenate([segments[i] for i in ids]), owner

    near, near_owner = gather(reached)
    far, far_owner = gather(unreached)
    distances, neighbors = KDTree(points[near]).query(points[far])
    best = int(np.argmin(distances))
    return float(distances[best]), int(far_owner[best]), int(near_owner[neighbors[best]])


def under_virtual_root(labels: NDArray[np.integer]) -> Hierarchy:
    """All labelled segments as children of a virtual, empty root (the paper's Figure 5)."""
    names, segments = split_by_label(labels)
    virtual = len(segments)
    return Hierarchy(
        segments=(*segments, np.empty(0, np.intp)),
        labels=(*names, None),
        parents=(*[virtual] * virtual, NO_PARENT),
        root=virtual,
        notes=("no segment is the others' stem; all hang under a virtual, empty root",),
    )
