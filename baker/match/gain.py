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

from baker.match.shapes import Shapes

# Worth of a match before its faults: shares of the younger and of the older organ's size, and of
# the plant's. Losing an organ is the exception, a birth is not.
LOSS, BIRTH, EITHER = 1.5, 0.8, 0.4
BEND = 0.7  # a distance counts by this power: one organ far off beats two a little off
BACK = 0.05  # of the older organ's distance from the younger
TURN = 0.35  # of the plant's size, a radian
ORDER, MOST_ORDER = 0.2, 2.0  # of the plant's size, an organ more or fewer below; at most so many
LOW = 0.45  # of the plant's size: what begins at the stem's base is no birth
SHRINK = 0.8  # of the size lost
CANDIDATES = 16  # organs of the other scan that each is compared with


def gains(first: Shapes, second: Shapes) -> NDArray[np.float64]:
    """(n, m) worth of each match, in the plant's size; -inf where the two are far apart.

    Above 0 it is worth more than a loss and a birth.
    """
    if (first.sizes**2).sum() > (second.sizes**2).sum():
        return _gains(second, first).T
    return _gains(first, second)


def _gains(young: Shapes, old: Shapes) -> NDArray[np.float64]:
    plant = float(np.sqrt((np.concatenate([young.sizes, old.sizes]) ** 2).mean()))
    plant = max(plant, np.finfo(float).tiny)
    before, after = young.sizes[:, None] / plant, old.sizes / plant
    there, back = _distances(young, old)
    turned = np.arccos(np.clip(young.directions @ old.directions.T, -1.0, 1.0))
    moved = MOST_ORDER * np.tanh(np.abs(young.below[:, None] - old.below) / MOST_ORDER)
    worth = LOSS * before + BIRTH * after + EITHER + LOW * (1.0 - old.height)
    faults = (there / plant) ** BEND + BACK * back / plant + TURN * turned + ORDER * moved
    gain: NDArray[np.float64] = worth - faults - SHRINK * np.maximum(before - after, 0.0)
    return gain


def _distances(young: Shapes, old: Shapes) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean distance of each young organ's points from each old organ, (n, m), and the way back."""
    from scipy.spatial.distance import cdist

    there = np.full((len(young.labels), len(old.labels)), np.inf)
    back = there.copy()
    for i, j in np.argwhere(_near(young, old)):
        apart = cdist(young.samples[i], old.samples[j])
        there[i, j] = apart.min(axis=1).mean()
        back[i, j] = apart.min(axis=0).mean()
    return there, back


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
