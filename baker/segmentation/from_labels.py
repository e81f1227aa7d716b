"""Hierarchies on given segmentations, by successive nearest neighbour searches (section 3.2.1).

Where the paper is silent: the threshold is three times the median spacing, the nearest gap is
bridged first, a segment never reached joins at its smallest gap, and where the root segment is far
from all others (ten spacings) no label is the stem: all hang under a virtual, empty root.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import (
    Gaps,
    Neighbors,
    agreed_gaps,
    nearest_neighbors,
    segment_adjacency,
)
from baker.geometry.parallel import MapLike
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy, split_by_label

Points = NDArray[np.floating]
Labels = NDArray[np.integer]
Indices = NDArray[np.intp]

MAX_ROOT_GAP = 10.0  # in point spacings: the lowest segment, if farther, is no stem of the others
COARSE_POINTS = 400  # of an organ, that its place in the coarse hierarchy is found by


def labelled_hierarchies(
    clouds: Sequence[Points],
    labels: Sequence[Labels],
    bases: Sequence[int],
    neighbors: Sequence[Neighbors],
    *,
    consistent: bool,
    agreeing: bool,
    virtual_root: bool,
    map: MapLike = map,
) -> list[Hierarchy]:
    """Segments by label (section 3.2.1).

    Parameters
    ----------
    clouds, labels, bases, neighbors : sequences
        Of each scan: (N, 3) points, (N,) labels, the point at the plant base, `Neighbors`.
    consistent : bool
        Labels name organs, so the scans elect one root between them.
    agreeing : bool
        And they agree on who grows from whom.
    virtual_root : bool
        No label is a stem; all hang under an empty root.
    map : MapLike
        Maps a function over scans.
    """
    if virtual_root:
        return [under_virtual_root(names) for names in labels]
    adjacency = [segment_adjacency(*scan) for scan in zip(labels, neighbors, strict=True)]
    agreed = None
    if consistent and agreeing:
        agreed = agreed_gaps(labels, adjacency, [near.spacing for near in neighbors])
    at_base = [int(names[base]) for names, base in zip(labels, bases, strict=True)]
    roots = _elected_roots(labels, at_base) if consistent else at_base
    hang = partial(hierarchy_from_labels, agreed=agreed)
    return list(map(hang, clouds, labels, roots, neighbors, adjacency))


def coarse_hierarchies(
    clouds: Sequence[Points], labels: Sequence[Labels], bases: Sequence[int]
) -> list[Hierarchy]:
    """Hierarchies for following organs, by few points of each: a dense organ counts as a thin one.

    Parameters
    ----------
    clouds : sequence of (N, 3) float ndarray
    labels : sequence of (N,) int ndarray
        The organ of each point; they need not be consistent.
    bases : sequence of int
        Point of each scan at the plant base.

    Returns
    -------
    list of Hierarchy
        Of all points; who grows from whom is found from `COARSE_POINTS` of each organ.
    """
    hierarchies = []
    for cloud, names, base in zip(clouds, labels, bases, strict=True):
        values, members = split_by_label(names)
        some = np.concatenate([own[:: -(-len(own) // COARSE_POINTS)] for own in members])
        coarse = hierarchy_from_labels(cloud[some], names[some], int(names[base]))
        empty = [np.empty(0, np.intp)] * (len(coarse.segments) - len(values))  # a virtual root
        hierarchies.append(replace(coarse, segments=(*members, *empty)))
    return hierarchies


def _elected_roots(labels: Sequence[Labels], at_base: Sequence[int]) -> list[int]:
    """The label that most scans have at their base; of scans that lack it, their own.

    In a late scan a drooping leaf may hang lower than the stem's base.
    """
    values, votes = np.unique(at_base, return_counts=True)
    elected = int(values[np.argmax(votes)])
    return [
        elected if (names == elected).any() else own
        for names, own in zip(labels, at_base, strict=True)
    ]


def hierarchy_from_labels(
    points: NDArray[np.floating],
    labels: NDArray[np.integer],
    root_label: int,
    neighbors: Neighbors | None = None,
    gaps: Gaps | None = None,
    agreed: Gaps | None = None,
) -> Hierarchy:
    """Hang the labelled segments of a cloud into a tree under the one of `root_label`.

    points, labels: (N, 3) and (N,). neighbors, gaps: of the points and of the labels, where they
    are known. agreed: `agreed_gaps` of all scans, which decide instead of this scan's which segment
    grows from which.
    """
    names, segments = split_by_label(labels)
    neighbors = neighbors or nearest_neighbors(points)
    gaps = segment_adjacency(labels, neighbors) if gaps is None else gaps
    first = names.index(root_label)
    is_reached = np.arange(len(segments)) == first
    if len(segments) > 2 and not any(root_label in pair for pair in gaps):
        gap, *_ = _smallest_gap(points, segments, is_reached)
        if gap > MAX_ROOT_GAP * neighbors.spacing:
            return under_virtual_root(labels)
    number = {name: index for index, name in enumerate(names)}
    edges = sorted(
        (gap, number[a], number[b])
        for (a, b), gap in (agreed or gaps).items()
        if a in number and b in number
    )
    lower, upper = np.array([edge[1:] for edge in edges], np.intp).reshape(-1, 2).T
    parents, notes = [NO_PARENT] * len(segments), []
    while not is_reached.all():  # Prim's algorithm; what stays apart is bridged at its smallest gap
        touching = np.flatnonzero(is_reached[upper] & ~is_reached[lower])
        if len(touching):
            _, child, parent = edges[touching[0]]
        else:
            gap, child, parent = _smallest_gap(points, segments, is_reached)
            notes.append(
                f"segment {names[child]} touches no other one; it was hung on segment "
                f"{names[parent]} across a gap of {gap:.3g}"
            )
        parents[child] = parent
        is_reached[child] = True
    return Hierarchy(tuple(segments), tuple(names), tuple(parents), first, tuple(notes))


def _smallest_gap(
    points: NDArray[np.floating], segments: Sequence[Indices], is_reached: NDArray[np.bool_]
) -> tuple[float, int, int]:
    """The gap, the unreached segment and the reached segment that are nearest to each other."""
    from scipy.spatial import KDTree

    def gather(which: NDArray[np.bool_]) -> tuple[Indices, Indices]:
        ids = np.flatnonzero(which).tolist()
        owner = np.repeat(ids, [len(segments[i]) for i in ids])
        return np.concatenate([segments[i] for i in ids]), owner

    near, near_owner = gather(is_reached)
    far, far_owner = gather(~is_reached)
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
