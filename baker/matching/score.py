"""Score of matching an organ of one scan to an organ of another.

An organ that grows *covers* what it was: each point of the younger organ lies near the older one,
however much longer that has become. So the mean distance from the younger to the older organ counts
most. Besides, an organ keeps its direction and its place in the order along the stem, where new
organs come on top, and it does not shrink. All of it is weighed against a loss and a birth.
docs/method.md has the figures.

A plant that leans, or a leaf that sinks with all its leaflets, takes neighboring organs the same
way. So once some pairs are known, every other organ is looked for where its neighbors have gone.

Of two scans the one with the smaller organs is the younger, so a series read backwards gives the
same organs.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.matching.descriptors import OrganDescriptors

# Weights of docs/method.md, "Labels numbered anew in every scan"; lengths are in plant sizes.
# An organ is seldom lost; small organs are born, large ones were there before.
LOSS_WEIGHT, BIRTH_WEIGHT, MATCH_BONUS = 1.8, 0.9, 1.2
TURN_PENALTY = 0.3  # per radian
ORDER_PENALTY, MAX_ORDER_CHANGE = 0.2, 2.0  # per organ more or fewer below
BASE_BONUS = 0.75  # what begins at the stem's base is no birth
SHRINKING_PENALTY = 0.6  # per size lost
MAX_PENALTY = 1.8  # from which on a loss and a birth are likelier
MAX_DISTANCE, MAX_SWAY = 2.0, 0.1  # from the later organ, in its sizes; plus a share of the plant's
CANDIDATES = 16  # organs of the other scan that each is compared with
# Where an organ has moved is estimated from its nearest neighbors, which weigh 1 at most, and
# shrunk towards no displacement, which has a weight, too (docs/method.md, "Tracking organs").
NEIGHBORS, STANDSTILL_WEIGHT = 3, 0.3
MEDIAN_STEPS, MEDIAN_SOFTNESS = 10, 0.05  # of the median of displacements; in plant sizes


def match_scores(
    first: OrganDescriptors, second: OrganDescriptors, pairs: Sequence[tuple[int, int]] = ()
) -> NDArray[np.float64]:
    """Score each pair of organs of two scans.

    Parameters
    ----------
    first, second : OrganDescriptors
        Of n and m organs.
    pairs : sequence of (int, int)
        Organs of both that match, as far as is known: each tells where others may have moved.

    Returns
    -------
    (n, m) float64 ndarray
        In units of the plant's size. Above 0 a match is better than a loss and a birth; it is -inf
        where a match is out of the question.
    """
    known = np.reshape(np.asarray(pairs, np.intp), (-1, 2))
    if (first.sizes**2).sum() > (second.sizes**2).sum():
        return _scores(second, first, known[:, ::-1]).T
    return _scores(first, second, known)


def _scores(
    young: OrganDescriptors, old: OrganDescriptors, pairs: NDArray[np.intp]
) -> NDArray[np.float64]:
    plant = float(np.sqrt((np.concatenate([young.sizes, old.sizes]) ** 2).mean())) or 1.0
    young = young.moved(neighbor_displacements(young, old, pairs, plant))
    before, after = young.sizes[:, None] / plant, old.sizes / plant
    distance = _covering_distances(young, old) / plant
    turn = np.arccos(np.clip(young.directions @ old.directions.T, -1.0, 1.0))
    reordered = np.abs(young.order[:, None] - old.order)
    reordered = MAX_ORDER_CHANGE * np.tanh(reordered / MAX_ORDER_CHANGE)
    shrunk = np.maximum(before - after, 0.0)
    # The square root: one organ far off is likelier than two a little off, for old organs stand.
    penalty = np.sqrt(distance) + TURN_PENALTY * turn
    penalty += ORDER_PENALTY * reordered + SHRINKING_PENALTY * shrunk
    penalty -= BASE_BONUS * (1.0 - old.height)
    reward = LOSS_WEIGHT * before + BIRTH_WEIGHT * after + MATCH_BONUS
    possible = (penalty < MAX_PENALTY) & (distance < MAX_DISTANCE * after + MAX_SWAY)
    return np.where(possible, reward - penalty, -np.inf)


def neighbor_displacements(
    young: OrganDescriptors, old: OrganDescriptors, pairs: NDArray[np.intp], plant: float
) -> NDArray[np.float64]:
    """(n, 3) displacement that each organ shares with its neighbors among the (p, 2) pairs.

    That is the weighted geometric median of the displacements of their attachment points, found by
    Weiszfeld's iteration: a neighbor that is matched wrongly hardly moves it. No organ counts for
    itself, or a wrong match would confirm itself.
    """
    from scipy.spatial.distance import cdist

    if len(pairs) < 2:
        return np.zeros((len(young), 3))
    places = young.attachments[pairs[:, 0]]
    shifts = old.attachments[pairs[:, 1]] - places
    distance = cdist(young.attachments, places)
    distance[pairs[:, 0], np.arange(len(pairs))] = np.inf
    bandwidth = np.sort(distance, axis=1)[:, [min(NEIGHBORS, len(pairs) - 1) - 1]]
    weights = np.exp(-0.5 * (distance / np.maximum(bandwidth, 1e-30)) ** 2)
    total = weights.sum(axis=1, keepdims=True)
    shares = weights
    for _ in range(MEDIAN_STEPS):
        median = shares @ shifts / np.maximum(shares.sum(axis=1, keepdims=True), 1e-30)
        shares = weights / np.maximum(cdist(median, shifts), MEDIAN_SOFTNESS * plant)
    return np.asarray(median * total / (total + STANDSTILL_WEIGHT))


def _covering_distances(young: OrganDescriptors, old: OrganDescriptors) -> NDArray[np.float64]:
    """(n, m) mean distance of each young organ's points from each old one; inf if not compared."""
    from scipy.spatial import KDTree

    distances = np.full((len(young), len(old)), np.inf)
    trees = [KDTree(sample) for sample in old.samples]
    for i, j in np.argwhere(_candidates(young, old)):
        distances[i, j] = trees[j].query(young.samples[i])[0].mean()
    return distances


def _candidates(young: OrganDescriptors, old: OrganDescriptors) -> NDArray[np.bool_]:
    """(n, m) whether either is among the nearest of the other, by attachment point or centroid."""
    from scipy.spatial.distance import cdist

    centroids = (np.array([s.mean(axis=0) for s in organs.samples]) for organs in (young, old))
    distance = np.minimum(cdist(young.attachments, old.attachments), cdist(*centroids))
    near = np.zeros(distance.shape, bool)
    rows = np.argsort(distance, axis=1, kind="stable")[:, :CANDIDATES]
    columns = np.argsort(distance, axis=0, kind="stable")[:CANDIDATES]
    np.put_along_axis(near, rows, True, axis=1)
    np.put_along_axis(near, columns, True, axis=0)
    return near
