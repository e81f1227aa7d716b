"""Score the match of an organ of one scan with an organ of another.

The main term is the mean distance from the points of the younger organ to the older one, since a
growing organ covers its former self. The score is relative to a loss and a birth; docs/method.md,
"Tracking organs", has all its terms. The scan with the smaller organs is the younger one, so that a
series in reverse order gives the same result.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from baker.matching.descriptors import OrganDescriptors

# docs/method.md, "Tracking organs"; lengths are in sizes of the plant's organs. A loss costs more
# than a birth, since organs are seldom lost, and new ones are small.
LOSS_WEIGHT, BIRTH_WEIGHT, MATCH_BONUS = 1.8, 0.9, 1.2
TURN_PENALTY = 0.3  # per radian
ORDER_PENALTY, MAX_ORDER_CHANGE = 0.2, 2.0  # per change in the number of organs below
BASE_BONUS = 0.75  # for an organ at the plant base, where none is born
SHRINKING_PENALTY = 0.6  # per size by which the younger organ is larger
MAX_PENALTY = 1.8  # of a possible pair; above it, a loss and a birth are more likely
# Greatest distance of a possible pair: MAX_DISTANCE times the older organ's size, plus MAX_SWAY.
MAX_DISTANCE, MAX_SWAY = 2.0, 0.1
# The displacement of an organ is estimated from its nearest neighbours, with weights of at most 1,
# and from no displacement, with its own weight (docs/method.md, "Tracking organs").
NEIGHBORS, STANDSTILL_WEIGHT = 3, 0.3
MEDIAN_STEPS, MEDIAN_SOFTNESS = 10, 0.05  # of Weiszfeld's algorithm; least distance, in sizes


def match_scores(
    first: OrganDescriptors, second: OrganDescriptors, pairs: ArrayLike = ()
) -> NDArray[np.float64]:
    """(n, m) scores of pairs of organs of two scans, in sizes of the plant's organs.

    A match with a score above 0 is better than a loss and a birth; impossible ones have -inf.
    pairs: (p, 2) matched so far; other organs are moved like their neighbours.
    """
    return match_rewards(first, second) - match_penalties(first, second, pairs)


def match_rewards(first: OrganDescriptors, second: OrganDescriptors) -> NDArray[np.float64]:
    """(n, m) rewards in the scores of pairs, which depend on the organs' sizes."""
    if _is_older(first, second):
        return match_rewards(second, first).T
    sizes = LOSS_WEIGHT * first.sizes[:, None] + BIRTH_WEIGHT * second.sizes
    return np.asarray(sizes / _organ_size(first, second) + MATCH_BONUS)


def match_penalties(
    first: OrganDescriptors, second: OrganDescriptors, pairs: ArrayLike = ()
) -> NDArray[np.float64]:
    """(n, m) penalties in the scores of pairs, up to `MAX_PENALTY`; impossible pairs have inf."""
    matched = np.reshape(np.asarray(pairs, np.intp), (-1, 2))
    if _is_older(first, second):
        return match_penalties(second, first, matched[:, ::-1]).T
    size = _organ_size(first, second)
    first = first.moved(neighbor_displacements(first, second, matched, size))
    cosines = first.directions @ second.directions.T
    order_change = np.abs(first.order[:, None] - second.order)
    order_change = MAX_ORDER_CHANGE * np.tanh(order_change / MAX_ORDER_CHANGE)
    penalty = ORDER_PENALTY * order_change - BASE_BONUS * (1.0 - second.height)
    return shape_penalties(first, second, _covering_distances(first, second), cosines, penalty)


def best_pairs(scores: NDArray[np.float64]) -> tuple[NDArray[np.intp], float]:
    """Pair rows with columns so that the total score is greatest; pairs of 0 or less are not made.

    Returns the (p, 2) pairs, by row, and their total score.
    """
    from scipy.optimize import linear_sum_assignment

    gains = np.maximum(scores, 0.0)
    rows, columns = linear_sum_assignment(gains, maximize=True)
    gain = gains[rows, columns]
    return np.column_stack([rows, columns])[gain > 0.0], float(gain.sum())


def shape_penalties(
    young: OrganDescriptors,
    old: OrganDescriptors,
    distance: NDArray[np.float64],
    cosines: NDArray[np.float64],
    penalty: NDArray[np.float64] | float = 0.0,
) -> NDArray[np.float64]:
    """Penalise pairs of n and m organs by their distance, directions and sizes.

    distance, cosines: (..., n, m) distances between organs, in length units, and cosines between
    their directions. penalty: (n, m) for other differences, in sizes of the plant's organs.
    """
    size = _organ_size(young, old)
    young_size, old_size, distance = young.sizes[:, None] / size, old.sizes / size, distance / size
    # By its square root, one large distance is more likely than two of half its size.
    penalty = np.sqrt(distance) + TURN_PENALTY * np.arccos(np.clip(cosines, -1.0, 1.0)) + penalty
    penalty = penalty + SHRINKING_PENALTY * np.maximum(young_size - old_size, 0.0)
    is_possible = (penalty < MAX_PENALTY) & (distance < MAX_DISTANCE * old_size + MAX_SWAY)
    return np.where(is_possible, penalty, np.inf)


def _is_older(first: OrganDescriptors, second: OrganDescriptors) -> bool:
    """Whether the first scan has the larger organs."""
    return bool((first.sizes**2).sum() > (second.sizes**2).sum())


def _organ_size(young: OrganDescriptors, old: OrganDescriptors) -> float:
    """The size of the plant's organs, by which lengths are divided."""
    return float(np.sqrt((np.concatenate([young.sizes, old.sizes]) ** 2).mean())) or 1.0


def neighbor_displacements(
    young: OrganDescriptors, old: OrganDescriptors, pairs: NDArray[np.intp], organ_size: float
) -> NDArray[np.float64]:
    """(n, 3) displacement of each young organ, estimated from those of its neighbours.

    It is the weighted geometric median of the displacements of their attachment points, by
    Weiszfeld's algorithm, on which a wrongly matched neighbour has little influence. The organ
    itself is left out, so that a wrong match does not confirm itself.

    pairs: (p, 2) matched organs. organ_size: as `_organ_size` returns it, in length units.
    """
    from scipy.spatial.distance import cdist

    if len(pairs) < 2:
        return np.zeros((len(young), 3))
    matched = young.attachments[pairs[:, 0]]
    shifts = old.attachments[pairs[:, 1]] - matched
    distance = cdist(young.attachments, matched)
    distance[pairs[:, 0], np.arange(len(pairs))] = np.inf
    bandwidth = np.sort(distance, axis=1)[:, [min(NEIGHBORS, len(pairs) - 1) - 1]]
    weights = np.exp(-0.5 * (distance / np.maximum(bandwidth, 1e-30)) ** 2)
    total = weights.sum(axis=1, keepdims=True)
    shares = weights
    for _ in range(MEDIAN_STEPS):
        median = shares @ shifts / np.maximum(shares.sum(axis=1, keepdims=True), 1e-30)
        shares = weights / np.maximum(cdist(median, shifts), MEDIAN_SOFTNESS * organ_size)
    return np.asarray(median * total / (total + STANDSTILL_WEIGHT))


def _covering_distances(young: OrganDescriptors, old: OrganDescriptors) -> NDArray[np.float64]:
    """(n, m) mean distance of the points of each young organ to each old one; inf if far apart."""
    from scipy.spatial.distance import cdist

    distances, may_match = np.full((len(young), len(old)), np.inf), _may_match(young, old)
    for j in np.flatnonzero(may_match.any(axis=0)):
        near = np.flatnonzero(may_match[:, j])
        points = [young.samples[i] for i in near]
        counts = np.array([*map(len, points)])
        squared = cdist(old.samples[j], np.concatenate(points), "sqeuclidean").min(axis=0)
        distances[near, j] = np.add.reduceat(np.sqrt(squared), np.cumsum(counts) - counts) / counts
    return distances


def _may_match(young: OrganDescriptors, old: OrganDescriptors) -> NDArray[np.bool_]:
    """(n, m) whether pairs may be near enough to match.

    The mean distance of points to an organ is not less than that of their centroid to its bounding
    box, which is convex.
    """
    centroids = np.array([sample.mean(axis=0) for sample in young.samples])[:, None]
    low, high = (np.array([side(s, axis=0) for s in old.samples]) for side in (np.min, np.max))
    gaps = np.linalg.norm(centroids - np.clip(centroids, low, high), axis=-1)
    return gaps < MAX_DISTANCE * old.sizes + MAX_SWAY * _organ_size(young, old)
