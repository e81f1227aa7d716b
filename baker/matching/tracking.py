"""Organs followed through a whole series at once, the labels numbered anew in every scan.

Each organ has at most one successor, in the next scan or, where it was hidden there, in one of the
two after that; each is the successor of at most one. Of all such choices over the whole series the
one of greatest worth is taken: a minimum weight path cover, solved as one sparse assignment.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.matching.descriptors import shapes_of
from baker.matching.score import gains

# Worth of a successor in the next scan, and in those after it, where the organ hides in between.
TRUST = (1.0, 0.9, 0.8)


def track_organs(
    clouds: Sequence[NDArray[np.floating]],
    labels: Sequence[NDArray[np.integer]],
    root_points: Sequence[int],
    stem: bool = False,
) -> list[NDArray[np.int64]]:
    """Number organs the same in all scans, whatever each scan calls them.

    clouds: aligned scans, (N, 3) each; labels: (N,) each; root_points: each scan's stem base.
    stem: whether the organ at the base is known to be the stem of all others.
    Returns (N,) organ numbers for each scan, from 0 in order of first appearance. In a scan,
    different labels have different numbers.
    """
    scans = zip(clouds, labels, root_points, strict=True)
    shapes = [shapes_of(*scan, stem=stem) for scan in scans]
    worth = {
        (k, k + gap): trust * gains(shapes[k], shapes[k + gap])
        for k in range(len(shapes))
        for gap, trust in enumerate(TRUST, start=1)
        if k + gap < len(shapes)
    }
    numbers = follow([len(scan.labels) for scan in shapes], worth)
    return [
        number[np.searchsorted(scan.labels, names)]
        for number, scan, names in zip(numbers, shapes, labels, strict=True)
    ]


def follow(
    counts: Sequence[int], worth: Mapping[tuple[int, int], NDArray[np.float64]]
) -> list[NDArray[np.int64]]:
    """Chain organs into tracks of the greatest worth together.

    counts: organs of each scan. worth: for an earlier and a later scan (n, m), what it is worth to
        make one organ the next sight of another; what isn't above 0 is never done.
    Returns each scan's (n,) track numbers, from 0 in order of first appearance.
    """
    starts = np.concatenate([[0], np.cumsum(counts)])
    before = _predecessors(starts, worth)
    tracks = np.empty(starts[-1], np.int64)
    born = 0
    for organ in range(starts[-1]):
        if before[organ] >= 0:
            tracks[organ] = tracks[before[organ]]
        else:
            tracks[organ] = born
            born += 1
    return np.split(tracks, starts[1:-1])


def _predecessors(
    starts: NDArray[np.intp], worth: Mapping[tuple[int, int], NDArray[np.float64]]
) -> NDArray[np.intp]:
    """For each organ of the series, scan after scan, which one it was before; -1 for none."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import min_weight_full_bipartite_matching

    total = int(starts[-1])
    alone = np.arange(total)
    rows, columns, value = [alone], [total + alone], [np.zeros(total)]
    for (k, later), matrix in worth.items():
        i, j = np.nonzero(matrix > 0)
        rows.append(starts[k] + i)
        columns.append(starts[later] + j)
        value.append(matrix[i, j])
    values = np.concatenate(value)
    # A full matching: who has no successor is matched to nobody. Zeros would be no edges.
    costs = coo_array(
        (1.0 + values.max() - values, (np.concatenate(rows), np.concatenate(columns))),
        shape=(total, 2 * total),
    ).tocsr()
    first, second = min_weight_full_bipartite_matching(costs)
    found = second < total
    before = np.full(total, -1, np.intp)
    before[second[found]] = first[found]
    return before
