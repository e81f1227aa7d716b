"""Every scan of a series split into segments and hung into a hierarchy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import repeat

import numpy as np
from numpy.typing import NDArray

from baker.geometry.contacts import Gaps
from baker.geometry.parallel import MapLike
from baker.segmentation.from_labels import (
    hierarchy_from_labels,
    touching_segments,
    under_virtual_root,
)
from baker.segmentation.from_spanning_tree import segment_thin
from baker.segmentation.hierarchy import Hierarchy, split_by_label, whole
from baker.segmentation.parents import agreed_gaps

COARSE_POINTS = 400  # of an organ, that its place in the coarse hierarchy is found by


def whole_hierarchies(clouds: Sequence[NDArray[np.floating]]) -> list[Hierarchy]:
    """No segments: each cloud is one (the paper's Figure 3)."""
    return [whole(cloud) for cloud in clouds]


def thin_hierarchies(
    clouds: Sequence[NDArray[np.floating]],
    bases: Sequence[int],
    neighbors: int,
    threshold: int | None,
    map: MapLike = map,
) -> list[Hierarchy]:
    """Segments without labels, each cloud cut at its forks (section 3.2.2)."""
    cut = partial(segment_thin, neighbors=neighbors, threshold=threshold)
    return [forks.hierarchy for forks in map(cut, clouds, bases)]


def labelled_hierarchies(
    clouds: Sequence[NDArray[np.floating]],
    labels: Sequence[NDArray[np.integer]],
    bases: Sequence[int],
    *,
    consistent: bool,
    agreeing: bool,
    virtual_root: bool,
    spacings: Sequence[float],
    touching: Sequence[Gaps] | None = None,
    map: MapLike = map,
) -> list[Hierarchy]:
    """Segments by label (section 3.2.1).

    consistent: labels name organs, so the scans elect one root between them.
    agreeing: and they agree on who grows from whom.
    virtual_root: no label is a stem; all hang under an empty root.
    spacings: each cloud's point spacing.
    touching: how far what touches is apart in each, where that is known.
    map: maps a function over scans.
    """
    if virtual_root:
        return [under_virtual_root(names) for names in labels]
    gaps = touching or list(map(touching_segments, clouds, labels, spacings))
    agreed = agreed_gaps(labels, gaps, spacings) if consistent and agreeing else None
    roots = [
        _elected_root(labels, bases, scan) if consistent else int(labels[scan][bases[scan]])
        for scan in range(len(clouds))
    ]
    hang = partial(hierarchy_from_labels, agreed=agreed)
    return list(map(hang, clouds, labels, roots, spacings, repeat(1), gaps))


def coarse_hierarchies(
    clouds: Sequence[NDArray[np.floating]],
    labels: Sequence[NDArray[np.integer]],
    bases: Sequence[int],
) -> list[Hierarchy]:
    """Hierarchies for following organs, by few points of each: a dense organ counts as a thin one.

    Parameters
    ----------
    clouds : sequence of (N, 3) float ndarray
    labels : sequence of (N,) int ndarray
        They need not be consistent.
    bases : sequence of int
        Index of the point at the base of each scan's plant.

    Returns
    -------
    list of Hierarchy
        Of all points; who grows from whom is found from `COARSE_POINTS` of each organ.
    """
    found = []
    for cloud, names, base in zip(clouds, labels, bases, strict=True):
        values, members = split_by_label(names)
        some = np.concatenate([own[:: -(-len(own) // COARSE_POINTS)] for own in members])
        coarse = hierarchy_from_labels(cloud[some], names[some], int(names[base]))
        empty = [np.empty(0, np.intp)] * (len(coarse.segments) - len(values))  # a virtual root
        found.append(replace(coarse, segments=(*members, *empty)))
    return found


def _elected_root(labels: Sequence[NDArray[np.integer]], bases: Sequence[int], scan: int) -> int:
    """The label that most scans have at their base, or the scan's own where it lacks that one.

    In a late scan a drooping leaf may hang lower than the stem's foot.
    """
    at_base = [int(names[base]) for names, base in zip(labels, bases, strict=True)]
    values, votes = np.unique(at_base, return_counts=True)
    elected = int(values[np.argmax(votes)])
    return elected if (labels[scan] == elected).any() else at_base[scan]
