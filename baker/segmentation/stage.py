"""Every scan of a series split into segments and hung into a hierarchy."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import repeat

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors, agreed_gaps, segment_adjacency
from baker.geometry.parallel import MapLike
from baker.segmentation.from_labels import hierarchy_from_labels, under_virtual_root
from baker.segmentation.from_spanning_tree import hierarchy_from_spanning_tree
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy, split_by_label

Points = NDArray[np.floating]
Labels = NDArray[np.integer]

COARSE_POINTS = 400  # of an organ, that its place in the coarse hierarchy is found by


def whole_hierarchies(clouds: Sequence[Points]) -> list[Hierarchy]:
    """No segments: each cloud is one (the paper's Figure 3)."""
    return [Hierarchy((np.arange(len(cloud)),), (0,), (NO_PARENT,), 0) for cloud in clouds]


def thin_hierarchies(
    clouds: Sequence[Points],
    bases: Sequence[int],
    neighbors: Sequence[Neighbors],
    k: int,
    threshold: int | None,
    map: MapLike = map,
) -> list[Hierarchy]:
    """Segments without labels, each cloud cut at its bifurcations.

    Parameters
    ----------
    clouds : sequence of (N, 3) float ndarray
    bases : sequence of int
        Point of each scan at the plant base.
    neighbors : sequence of Neighbors
    k : int
        Neighbours in the kNN graph.
    threshold : int or None
        Edges from which on a branch makes a bifurcation; None takes the paper's.
    map : map-like callable

    Returns
    -------
    list of Hierarchy

    References
    ----------
    Section 3.2.2 of the paper.
    """
    ks, thresholds = repeat(k), repeat(threshold)
    return list(map(hierarchy_from_spanning_tree, clouds, bases, ks, thresholds, neighbors))


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
