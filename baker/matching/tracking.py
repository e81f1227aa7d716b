"""Organs followed through a whole series at once, where their labels are not consistent.

Each organ has at most one successor, in the next scan or, where it was hidden there, in one of the
two after that; each is the successor of at most one. Of all such choices over the whole series the
one of the largest total score is taken: a minimum weight path cover, solved as one sparse
assignment. Neighboring organs move alike, so the tracks say where each organ is to be looked for,
and all is scored and solved again.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import chain_ends
from baker.matching.corrections import PointCorrection
from baker.matching.descriptors import describe_organs
from baker.matching.score import match_scores
from baker.segmentation.hierarchy import Hierarchy

# Factor of the score of a successor in the next scan, and in the two after it.
GAP_FACTORS = (1.0, 0.9, 0.8)
ROUNDS = 4  # of scoring and solving (docs/method.md)
CERTAIN = 1e6  # score of organs that are said to be the same: more than all others together


def track_organs(
    clouds: Sequence[NDArray[np.floating]],
    hierarchies: Sequence[Hierarchy],
    root_points: Sequence[int],
    stem: bool = False,
    corrections: Sequence[PointCorrection] = (),
) -> list[NDArray[np.int64]]:
    """Number the organs of a series the same in all scans, whatever their labels.

    clouds: (N, 3) aligned scans. hierarchies: their organs. root_points: the point of each scan at
    the plant base. stem: whether the organ there is known to be the stem of all others.
    corrections: where they are of successive scans, and what isn't the same, are kept to. Returns
    each point's track number, (N,), from 0 by first appearance, those of one scan from the plant
    base on; each organ of a scan has its own.
    """
    scans = zip(clouds, hierarchies, root_points, strict=True)
    organs = [describe_organs(*scan, stem=stem) for scan in scans]
    bases = [cloud[base] for cloud, base in zip(clouds, root_points, strict=True)]
    places = [
        np.linalg.norm(own.attachments - base, axis=1)
        for own, base in zip(organs, bases, strict=True)
    ]
    gaps = enumerate(GAP_FACTORS, start=1)
    factors = {(k, k + gap): f for gap, f in gaps for k in range(len(organs) - gap)}
    numbers = [np.arange(0)] * len(organs)
    for _ in range(ROUNDS):
        scores = {
            (k, later): factor * match_scores(organs[k], organs[later], _shared(numbers, k, later))
            for (k, later), factor in factors.items()
        }
        for one in corrections:
            same, (k, later) = one.kind == "same", one.scans
            if (k, later) in scores and (later == k + 1 or not same):
                pair = tuple(_organ_of(hierarchies[scan], point) for scan, point in one.places)
                scores[k, later][pair] = CERTAIN if same else -np.inf
        numbers = follow(places, scores)
    tracks = []
    for own, hierarchy in zip(numbers, hierarchies, strict=True):
        sizes = [len(segment) for segment in hierarchy.segments if len(segment)]
        track = np.empty(sum(sizes), np.int64)
        track[np.concatenate(hierarchy.segments)] = np.repeat(own, sizes)
        tracks.append(track)
    return tracks


def _shared(numbers: Sequence[NDArray[np.int64]], k: int, later: int) -> list[tuple[int, int]]:
    """The organs of two scans that have the same number."""
    _, first, second = np.intersect1d(numbers[k], numbers[later], return_indices=True)
    return list(zip(first.tolist(), second.tolist(), strict=True))


def _organ_of(hierarchy: Hierarchy, point: int) -> int:
    """Which of the organs that have points holds one."""
    return next(i for i, own in enumerate(filter(len, hierarchy.segments)) if point in own)


def follow(
    places: Sequence[NDArray[np.floating]], scores: Mapping[tuple[int, int], NDArray[np.float64]]
) -> list[NDArray[np.int64]]:
    """Chain organs into tracks of the largest total score.

    places: (n,) of each scan's organs, along the plant. scores: (n, m) of each pair of organs of an
    earlier and a later scan, chained only above 0. Returns each organ's track number, from 0 by
    first appearance, then by place.
    """
    starts = np.cumsum([0, *map(len, places)])
    scan = np.repeat(np.arange(len(places)), np.diff(starts))
    rank = np.argsort(np.lexsort((np.concatenate(places), scan)))
    first = chain_ends(_predecessors(starts, scores))
    tracks = np.unique(rank[first], return_inverse=True)[1]
    return np.split(tracks, starts[1:-1])


def _predecessors(
    starts: NDArray[np.intp], scores: Mapping[tuple[int, int], NDArray[np.float64]]
) -> NDArray[np.intp]:
    """For each organ of the series, scan after scan, which organ it was before; or itself."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import min_weight_full_bipartite_matching

    total = int(starts[-1])
    organs = np.arange(total)
    rows, columns, value = [organs], [total + organs], [np.zeros(total)]
    for (k, later), matrix in scores.items():
        i, j = np.nonzero(matrix > 0)
        rows.append(starts[k] + i)
        columns.append(starts[later] + j)
        value.append(matrix[i, j])
    values = np.concatenate(value)
    # The matching is full: an organ without successor is matched to a dummy. Zeros would not be
    # stored as edges.
    costs = coo_array(
        (1.0 + values.max() - values, (np.concatenate(rows), np.concatenate(columns))),
        shape=(total, 2 * total),
    ).tocsr()
    first, second = min_weight_full_bipartite_matching(costs)
    found = second < total
    predecessors = np.arange(total)
    predecessors[second[found]] = first[found]
    return predecessors
