"""Score of matching an organ of one scan to an organ of another.

An organ that grows *covers* what it was: each point of the younger organ lies near the older one,
however much longer that has become. So the mean distance from the younger to the older organ counts
most. Besides, an organ keeps its direction and its place in the order along the stem, where new
organs come on top, and it does not shrink. All of it is weighed against a loss and a birth.
docs/method.md has the figures.

Of two scans the one with the smaller organs is the younger, so a series read backwards gives the
same organs.
"""

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


def match_scores(first: OrganDescriptors, second: OrganDescriptors) -> NDArray[np.float64]:
    """Score each pair of organs of two scans.

    Parameters
    ----------
    first, second : OrganDescriptors
        Of n and m organs.

    Returns
    -------
    (n, m) float64 ndarray
        In units of the plant's size. Above 0 a match is better than a loss and a birth; it is -inf
        where a match is out of the question.
    """
    if (first.sizes**2).sum() > (second.sizes**2).sum():
        return _scores(second, first).T
    return _scores(first, second)


def _scores(young: OrganDescriptors, old: OrganDescriptors) -> NDArray[np.float64]:
    plant = float(np.sqrt((np.concatenate([young.sizes, old.sizes]) ** 2).mean())) or 1.0
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
