"""What it is worth to take an organ of one scan and an organ of another for the same one.

An organ that grows *covers* what it was: each point of the younger organ lies near the older one,
however much longer that has become. So the mean distance from the younger to the older organ counts
most. Besides, an organ keeps its direction and its place in the order along the stem, where new
organs come on top, and it does not shrink. All of it is measured against what it takes to fold one
organ back and to unfold the other. docs/method.md has the figures.

Of two scans the one with the smaller organs is the younger, so a series read backwards gives the
same organs.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.matching.descriptors import Shapes

# Worth of a match before its faults: shares of the younger and of the older organ's size, and of
# the plant's. An organ is seldom lost; small ones are born, large ones have been there.
LOSS, BIRTH, EITHER = 1.8, 0.9, 1.2
TURN = 0.3  # a radian, of the plant's size
ORDER, MOST_ORDER = 0.2, 2.0  # an organ more or fewer below, of the plant's size; at most so many
LOW = 0.75  # worth, of the plant's size: what begins at the stem's base is no birth
SHRINK = 0.6  # of the size lost
HOPELESS = 1.8  # faults, in the plant's size, from which on a loss and a birth are likelier
# Nothing leaves its place by more than so many of its later sizes, and this share of the plant's.
AWAY, SWAY = 2.0, 0.1
CANDIDATES = 16  # organs of the other scan that each is compared with


def gains(first: Shapes, second: Shapes) -> NDArray[np.float64]:
    """(n, m) worth of each match, in the plant's size; -inf where that is out of the question.

    Above 0 it is worth more than a loss and a birth.
    """
    if (first.sizes**2).sum() > (second.sizes**2).sum():
        return _gains(second, first).T
    return _gains(first, second)


def _gains(young: Shapes, old: Shapes) -> NDArray[np.float64]:
    plant = float(np.sqrt((np.concatenate([young.sizes, old.sizes]) ** 2).mean())) or 1.0
    before, after = young.sizes[:, None] / plant, old.sizes / plant
    apart = _distances(young, old) / plant
    turned = np.arccos(np.clip(young.directions @ old.directions.T, -1.0, 1.0))
    moved = MOST_ORDER * np.tanh(np.abs(young.below[:, None] - old.below) / MOST_ORDER)
    shrunk = np.maximum(before - after, 0.0)
    # The root: one organ far off is likelier than two a little off, for the old ones stand still.
    faults = np.sqrt(apart) + TURN * turned + ORDER * moved + SHRINK * shrunk
    faults -= LOW * (1.0 - old.height)
    worth = LOSS * before + BIRTH * after + EITHER
    likely = (faults < HOPELESS) & (apart < AWAY * after + SWAY)
    return np.where(likely, worth - faults, -np.inf)


def _distances(young: Shapes, old: Shapes) -> NDArray[np.float64]:
    """(n, m) mean distance of each young organ's points from each old one; inf for the farthest."""
    from scipy.spatial import cKDTree

    distances = np.full((len(young.labels), len(old.labels)), np.inf)
    trees = [cKDTree(sample) for sample in old.samples]
    for i, j in np.argwhere(_near(young, old)):
        distances[i, j] = trees[j].query(young.samples[i])[0].mean()
    return distances


def _near(young: Shapes, old: Shapes) -> NDArray[np.bool_]:
    """(n, m) the organs nearest to each, by their bases or their middles, whichever is nearer."""
    from scipy.spatial.distance import cdist

    apart = np.minimum(cdist(young.bases, old.bases), cdist(_middles(young), _middles(old)))
    near = np.zeros(apart.shape, bool)
    rows = np.argsort(apart, axis=1, kind="stable")[:, :CANDIDATES]
    columns = np.argsort(apart, axis=0, kind="stable")[:CANDIDATES]
    np.put_along_axis(near, rows, True, axis=1)
    np.put_along_axis(near, columns, True, axis=0)
    return near


def _middles(shapes: Shapes) -> NDArray[np.float64]:
    return np.array([sample.mean(axis=0) for sample in shapes.samples])
