"""Build hierarchies from labelled segments by nearest neighbour searches (section 3.2.1).

The paper leaves some choices open. Here, segments are adjacent within three median point spacings,
the smallest gap is bridged first, and a segment that is adjacent to no other is joined to the
nearest one. If the root segment is more than ten spacings away from all others, none of the labels
is the stem, and all segments become children of a virtual, empty root.
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

MAX_ROOT_GAP = 10.0  # in point spacings, from the root segment to the nearest other one
COARSE_POINTS = 400  # of each organ, from which a coarse hierarchy is built


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
    """Build the hierarchy of each scan from the labels of its points.

    Parameters
    ----------
    clouds, labels, bases, neighbors : sequences
        For each scan: (N, 3) points, (N,) labels, the point at the plant base, `Neighbors`.
    consistent : bool
        Whether an organ has the same label in all scans; they then have the same root.
    agreeing : bool
        Whether an organ with consistent labels has the same parent in all scans.
    virtual_root : bool
        Whether no label is the stem: all segments become children of an empty root.
    map : map-like callable
        Maps over the scans.

    References
    ----------
    Section 3.2.1 of the paper.
    """
    if virtual_root:
        return [under_virtual_root(names) for names in labels]
    adjacency = list(map(segment_adjacency, labels, neighbors))
    mean_gaps = None
    if consistent and agreeing:
        mean_gaps = agreed_gaps(labels, adjacency, [near.spacing for near in neighbors])
    at_base = [int(names[base]) for names, base in zip(labels, bases, strict=True)]
    roots = _majority_roots(labels, at_base) if consistent else at_base
    build = partial(hierarchy_from_labels, mean_gaps=mean_gaps)
    return list(map(build, clouds, labels, roots, neighbors, adjacency))


def coarse_hierarchies(
    clouds: Sequence[Points], labels: Sequence[Labels], bases: Sequence[int]
) -> list[Hierarchy]:
    """Build hierarchies for the tracking of organs, in which all organs are sampled equally.

    Parameters
    ----------
    clouds : sequence of (N, 3) float ndarray
    labels : sequence of (N,) int ndarray
        The organ of each point; labels need not be consistent.
    bases : sequence of int
        Index of the point at the plant base, for each scan.

    Returns
    -------
    list of Hierarchy
        Of all points; the parents are found from `COARSE_POINTS` of each organ.
    """
    hierarchies = []
    for cloud, names, base in zip(clouds, labels, bases, strict=True):
        distinct, members = split_by_label(names)
        sample = np.concatenate([each[:: -(-len(each) // COARSE_POINTS)] for each in members])
        coarse = hierarchy_from_labels(cloud[sample], names[sample], int(names[base]))
        empty = [np.empty(0, np.intp)] * (len(coarse.segments) - len(distinct))  # a virtual root
        hierarchies.append(replace(coarse, segments=(*members, *empty)))
    return hierarchies


def _majority_roots(labels: Sequence[Labels], at_base: Sequence[int]) -> list[int]:
    """The label at the base of most scans; in a scan without it, the label at the scan's base.

    In a late scan, a drooping leaf may hang lower than the base of the stem.
    """
    distinct, votes = np.unique(at_base, return_counts=True)
    majority = int(distinct[np.argmax(votes)])
    return [
        majority if (names == majority).any() else lowest
        for names, lowest in zip(labels, at_base, strict=True)
    ]


def hierarchy_from_labels(
    points: NDArray[np.floating],
    labels: NDArray[np.integer],
    root_label: int,
    neighbors: Neighbors | None = None,
    gaps: Gaps | None = None,
    mean_gaps: Gaps | None = None,
) -> Hierarchy:
    """Build the hierarchy of one scan from the labels of its points, by Prim's algorithm.

    Parameters
    ----------
    points, labels : (N, 3) float, (N,) int
    root_label : int
    neighbors : Neighbors, optional
    gaps : Gaps, optional
        As `segment_adjacency` returns them.
    mean_gaps : Gaps, optional
        Those of all scans, as `agreed_gaps` returns them, to use instead of `gaps`.
    """
    names, segments = split_by_label(labels)
    neighbors = neighbors or nearest_neighbors(points)
    gaps = segment_adjacency(labels, neighbors) if gaps is None else gaps
    root = names.index(root_label)
    is_reached = np.arange(len(segments)) == root
    if len(segments) > 2 and not any(root_label in pair for pair in gaps):
        gap, *_ = _smallest_gap(points, segments, is_reached)
        if gap > MAX_ROOT_GAP * neighbors.spacing:
            return under_virtual_root(labels)
    number = {name: index for index, name in enumerate(names)}
    edges = sorted(
        (gap, number[a], number[b])
        for (a, b), gap in (mean_gaps or gaps).items()
        if a in number and b in number
    )
    lower, upper = np.array([edge[1:] for edge in edges], np.intp).reshape(-1, 2).T
    parents, notes = [NO_PARENT] * len(segments), []
    while not is_reached.all():
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
    return Hierarchy(tuple(segments), tuple(names), tuple(parents), root, tuple(notes))


def _smallest_gap(
    points: NDArray[np.floating], segments: Sequence[Indices], is_reached: NDArray[np.bool_]
) -> tuple[float, int, int]:
    """The smallest gap between unreached and reached segments, and those two segments."""
    from scipy.spatial import KDTree

    def gather(chosen: NDArray[np.bool_]) -> tuple[Indices, Indices]:
        ids = np.flatnonzero(chosen).tolist()
        owner = np.repeat(ids, [len(segments[i]) for i in ids])
        return np.concatenate([segments[i] for i in ids]), owner

    reached, reached_owner = gather(is_reached)
    unreached, unreached_owner = gather(~is_reached)
    gaps, neighbors = KDTree(points[reached]).query(points[unreached])
    best = int(np.argmin(gaps))
    return float(gaps[best]), int(unreached_owner[best]), int(reached_owner[neighbors[best]])


def under_virtual_root(labels: NDArray[np.integer]) -> Hierarchy:
    """Make all segments children of a virtual, empty root (Komatsuna in section 4 of the paper)."""
    names, segments = split_by_label(labels)
    virtual = len(segments)
    return Hierarchy(
        segments=(*segments, np.empty(0, np.intp)),
        labels=(*names, None),
        parents=(*[virtual] * virtual, NO_PARENT),
        root=virtual,
        notes=("no segment is the others' stem; all hang under a virtual, empty root",),
    )
