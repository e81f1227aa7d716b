"""Track organs through the whole series, where their labels are not consistent.

Each organ has at most one successor and one predecessor: the links of largest total score are a
minimum weight path cover, which is solved as one sparse assignment. Scores and tracks are computed
again with what the tracks predict (docs/method.md, "Tracking organs").
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import chain_ends
from baker.matching.corrections import PointCorrection
from baker.matching.descriptors import describe_organs
from baker.matching.plant_motion import plant_motions
from baker.matching.score import MAX_PENALTY, match_penalties, match_rewards

PairMatrices = Mapping[tuple[int, int], NDArray[np.float64]]
"""(earlier scan, later scan) -> (n, m) scores or penalties of the pairs of their organs"""

# docs/method.md, "Tracking organs".
MAX_GAP = 3  # greatest number of scans from an organ to its successor
HIDDEN_PENALTY = 0.8  # of a pair, for each scan between its organs
INDIRECT_WEIGHT = 0.3  # of the penalties of pairs that tracks connect, relative to a pair's own
ROUNDS = 4  # number of times that pairs are scored and tracks are found
CORRECTION_SCORE = 1e6  # of a pair that a correction links, greater than all other scores together


def track_organs(
    clouds: Sequence[NDArray[np.floating]],
    labels: Sequence[NDArray[np.integer]],
    root_points: Sequence[int],
    corrections: Sequence[PointCorrection] = (),
) -> list[NDArray[np.int64]]:
    """Track the organs of a series by their shapes.

    clouds, labels, root_points: (N, 3) aligned points of each scan, their (N,) organs, and the
    index of the point at the plant base. corrections: those of kind "same" between successive
    scans, and of kind "different", are constraints.

    Returns the (N,) track number of each point. Tracks are numbered by first appearance, those that
    appear in the same scan by their distance from the plant base.
    """
    organs = [*map(describe_organs, clouds, labels, root_points)]
    organ_of = [np.unique(scan_labels, return_inverse=True)[1] for scan_labels in labels]
    distances = [np.linalg.norm(scan.attachments - scan.base, axis=1) for scan in organs]
    moved, motions = {}, plant_motions(organs)
    organs = [scan.about_stem() for scan in organs]
    for k, scan in enumerate(organs):
        for later, motion in enumerate(motions[k : k + MAX_GAP], start=k + 1):
            moved[k, later] = scan = scan.transformed(motion)
    numbers = [np.arange(0)] * len(organs)
    for _ in range(ROUNDS):
        own = {
            (k, later): match_penalties(first, organs[later], _linked(numbers, k, later))
            for (k, later), first in moved.items()
        }
        scores = {}
        for (k, later), penalties in averaged_penalties(own, numbers).items():
            penalties += HIDDEN_PENALTY * (later - k - 1)
            scores[k, later] = match_rewards(moved[k, later], organs[later]) - penalties
        for correction in corrections:
            same, (k, later) = correction.kind == "same", correction.scans
            if (k, later) in scores and (later == k + 1 or not same):
                pair = tuple(organ_of[scan][point] for scan, point in correction.places)
                scores[k, later][pair] = CORRECTION_SCORE if same else -np.inf
        numbers = chain_organs(distances, scores)
    return [tracks[organ] for tracks, organ in zip(numbers, organ_of, strict=True)]


def averaged_penalties(
    penalties: PairMatrices, numbers: Sequence[NDArray[np.int64]]
) -> dict[tuple[int, int], NDArray[np.float64]]:
    """Average the penalties of each pair (a, b) with those of two pairs that the tracks suggest.

    These are (a, successor of b) and (predecessor of a, b), in the tracks so far; impossible pairs
    count as `MAX_PENALTY`.
    """
    averages, capped = {}, {pair: np.minimum(p, MAX_PENALTY) for pair, p in penalties.items()}
    for (k, later), own in penalties.items():
        total, weight = own.copy(), np.ones_like(own)
        if (k, later + 1) in capped:
            organ, successor = _linked(numbers, later, later + 1).T
            total[:, organ] += INDIRECT_WEIGHT * capped[k, later + 1][:, successor]
            weight[:, organ] += INDIRECT_WEIGHT
        if (k - 1, later) in capped:
            predecessor, organ = _linked(numbers, k - 1, k).T
            total[organ] += INDIRECT_WEIGHT * capped[k - 1, later][predecessor]
            weight[organ] += INDIRECT_WEIGHT
        averages[k, later] = total / weight
    return averages


def _linked(numbers: Sequence[NDArray[np.int64]], k: int, later: int) -> NDArray[np.intp]:
    """(p, 2) the pairs of organs of two scans that have the same track number."""
    _, first, second = np.intersect1d(numbers[k], numbers[later], return_indices=True)
    return np.column_stack([first, second])


def chain_organs(
    distances: Sequence[NDArray[np.floating]], scores: PairMatrices
) -> list[NDArray[np.int64]]:
    """Chain organs into tracks of the largest total score.

    distances: (n,) of the organs of each scan, from the plant base. scores: (n, m) of each pair of
    organs of an earlier and a later scan; only pairs with a positive score are linked. Returns the
    (n,) track numbers of the organs of each scan, by first appearance, then by distance.
    """
    starts = np.cumsum([0, *map(len, distances)])
    scan = np.repeat(np.arange(len(distances)), np.diff(starts))
    rank = np.argsort(np.lexsort((np.concatenate(distances), scan)))
    first = chain_ends(_predecessors(starts, scores))
    tracks = np.unique(rank[first], return_inverse=True)[1]
    return np.split(tracks, starts[1:-1])


def _predecessors(starts: NDArray[np.intp], scores: PairMatrices) -> NDArray[np.intp]:
    """The predecessor of each organ, numbered over all scans; itself if it has none."""
    from scipy.sparse import csr_array
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
    # The matching is full: an organ without a successor is matched to a dummy. Costs are positive,
    # since a sparse array does not store zeros.
    pairs = np.concatenate(rows), np.concatenate(columns)
    costs = csr_array((1.0 + values.max() - values, pairs), (total, 2 * total))
    first, second = min_weight_full_bipartite_matching(costs)
    is_linked = second < total
    predecessors = np.arange(total)
    predecessors[second[is_linked]] = first[is_linked]
    return predecessors
