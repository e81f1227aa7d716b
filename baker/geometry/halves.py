"""All neighbours of a cloud's points; compiled by numba: import this module late.

A cloud in an order that keeps together what lies together is a search tree by its halves. Asked for
the neighbours of all points, it answers leaf by leaf: what lies together has nearly the same ones.
That takes a third to a half of what libraries' trees take, which are asked point by point.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled
from baker.geometry.parallel import thread_map

LEAF = 12  # points at most that are looked at together
ENOUGH = 32  # nearest points within reach that are told
TOGETHER = 4096  # points, whose neighbours stay in the processor's cache

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Pairs = tuple[NDArray[np.intp], NDArray[np.intp], Floats]  # points, others, how far apart


@dataclass(frozen=True)
class Halves:
    """A cloud of N points and its halves, their halves, and so on: part p is 2 p and 2 p + 1.

    order:  (N,) the points' numbers in the cloud.
    points: (N, 3) float64, in that order.
    first:  (leaves + 1,) where each leaf begins; leaf k is part leaves + k.
    box:    (2 leaves, 6) lows and highs of each part.
    """

    order: NDArray[np.intp]
    points: Floats
    first: Ints
    box: Floats

    @classmethod
    def of(cls, points: NDArray[np.floating]) -> Halves:
        """Those of (N, 3) finite points, N > 0, halved across their longest extent."""
        from baker.transport.space_partition import halve

        depth = _depth(len(points))
        placed = points.astype(np.float64)
        order = halve(placed, depth, np.zeros(2**depth, np.int64), False)
        return cls.along(placed.take(order, axis=0), order)

    @classmethod
    def along(cls, points: Floats, order: NDArray[np.intp] | None = None) -> Halves:
        """Those of points that are in such an order: others make it slow. order: their numbers."""
        leaves = 2 ** _depth(len(points))
        first = -(-np.arange(leaves + 1) * len(points) // leaves)
        order = np.arange(len(points)) if order is None else order
        return cls(order, points, first, _boxes(points, first))

    def batches(self) -> list[slice]:
        """All leaves, some thousand points in each batch."""
        leaves = len(self.first) - 1
        some = max(1, leaves * TOGETHER // len(self.points))
        return [slice(at, min(at + some, leaves)) for at in range(0, leaves, some)]

    def nearest(self, count: int, batch: slice | None = None) -> tuple[Floats, NDArray[np.int32]]:
        """(n, count) squared distances to the nearest other points, and which, nearest first.

        count: at least 1; a point with fewer others has itself, at an infinite distance.
        batch: leaves whose points are meant; points are told by their places.
        """
        leaves = batch or slice(0, len(self.first) - 1)
        return _nearest(self.points, self.first, self.box, leaves.start, leaves.stop, count)

    def pairs(self, owner: Ints, reach: float, workers: int = 1) -> Pairs:
        """Points that may be within reach of another owner's; what is within reach; how far.

        owner:   (N,) of the points by their places, not negative; workers: threads.

        Of each point are told the nearest others, up to `ENOUGH`; of most points none, for all that
        is near them has their own owner. All about one point follow one another, nearest first.
        """
        owners = _boxes(owner[:, None].astype(np.float64), self.first)
        tree = self.points, self.first, self.box, owners

        def look(batch: slice) -> Pairs:
            return _pairs(*tree, reach, batch.start, batch.stop)

        with thread_map(workers) as map:
            found = list(map(look, self.batches()))
        one, other, apart = zip(*found, strict=True)
        places = np.concatenate(one), np.concatenate(other)
        return self.order.take(places[0]), self.order.take(places[1]), np.concatenate(apart)


def _depth(count: int) -> int:
    depth = 0
    while count >> depth > LEAF:
        depth += 1
    return depth


@compiled
def _boxes(values: Floats, first: Ints) -> Floats:
    """(2 leaves, 2 d) lows and highs of each part's values, of (N, d)."""
    leaves, d = len(first) - 1, values.shape[1]
    box = np.empty((2 * leaves, 2 * d))
    for leaf in range(leaves):
        for axis in range(d):
            low, high = np.inf, -np.inf
            for i in range(first[leaf], first[leaf + 1]):
                low, high = min(low, values[i, axis]), max(high, values[i, axis])
            box[leaves + leaf, axis], box[leaves + leaf, d + axis] = low, high
    for part in range(leaves - 1, 0, -1):
        for axis in range(d):
            box[part, axis] = min(box[2 * part, axis], box[2 * part + 1, axis])
            box[part, d + axis] = max(box[2 * part, d + axis], box[2 * part + 1, d + axis])
    return box


@compiled
def _nearest(
    points: Floats, first: Ints, box: Floats, start: int, stop: int, count: int
) -> tuple[Floats, NDArray[np.int32]]:
    """As `Halves.nearest`, of the points of some leaves."""
    leaves, offset = len(first) - 1, first[start]
    total = first[stop] - offset
    away, near = np.full((total, count), np.inf), np.empty((total, count), np.int32)
    for i in range(total):
        near[i] = offset + i
    waiting = np.empty(64, np.int64)
    for leaf in range(start, stop):
        # Itself first, then what is beside it, then what is beside both, and so on.
        part, beside, bound = leaves + leaf, leaves + leaf, np.inf
        own = box[part]
        while part > 0:
            waiting[0], left = beside, 1
            while left > 0:
                left -= 1
                other = waiting[left]
                if _apart(box[other], own[0], own[1], own[2], own[3], own[4], own[5]) > bound:
                    continue
                if other < leaves:
                    waiting[left], waiting[left + 1] = 2 * other, 2 * other + 1
                    left += 2
                    continue
                bound = 0.0
                begin, end = first[other - leaves], first[other - leaves + 1]
                for i in range(first[leaf], first[leaf + 1]):
                    x, y, z = points[i, 0], points[i, 1], points[i, 2]
                    farthest = away[i - offset, -1]
                    if _apart(box[other], x, y, z, x, y, z) < farthest:
                        _look(points, i, begin, end, away[i - offset], near[i - offset])
                    bound = max(bound, away[i - offset, -1])
            part, beside = part >> 1, part ^ 1
    return away, near


@compiled
def _pairs(
    points: Floats, first: Ints, box: Floats, owners: Floats, reach: float, start: int, stop: int
) -> Pairs:
    """As `Halves.pairs`, by their places, of some leaves' points; owners: their `_boxes`."""
    allowed, found = max(reach * reach, 5e-324), 0
    leaves, waiting = len(first) - 1, np.empty(64, np.int64)
    foreign, around = np.empty(leaves, np.int64), np.empty(leaves, np.int64)
    away, near = np.empty(ENOUGH), np.empty(ENOUGH, np.int32)
    one, other, apart = np.empty(1024, np.int64), np.empty(1024, np.int64), np.empty(1024)
    for leaf in range(start, stop):
        foreigners = _around(leaf, box, owners, allowed, True, foreign, waiting)
        if foreigners == 0:
            continue
        size = _around(leaf, box, owners, allowed, False, around, waiting)
        for i in range(first[leaf], first[leaf + 1]):
            x, y, z = points[i, 0], points[i, 1], points[i, 2]
            alone = True
            for part in foreign[:foreigners]:
                alone = alone and _apart(box[part], x, y, z, x, y, z) > allowed
            if alone:
                continue
            away[:] = allowed
            for part in around[:size]:
                if _apart(box[part], x, y, z, x, y, z) < away[-1]:
                    _look(points, i, first[part - leaves], first[part - leaves + 1], away, near)
            while found + ENOUGH > len(one):
                one, other, apart = _longer(one), _longer(other), _longer(apart)
            for k in range(ENOUGH):
                if away[k] == allowed:
                    break
                one[found], other[found], apart[found] = i, near[k], np.sqrt(away[k])
                found += 1
    return one[:found], other[:found], apart[:found]


@compiled
def _around(
    leaf: int,
    box: Floats,
    owners: Floats,
    allowed: float,
    foreign: bool,
    found: Ints,
    waiting: Ints,
) -> int:
    """How many leaves come so near to one, and which; where asked, only those of other owners."""
    leaves, size = len(box) // 2, 0
    own, lowest, highest = box[leaves + leaf], owners[leaves + leaf, 0], owners[leaves + leaf, 1]
    waiting[0], left = 1, 1
    while left > 0:
        left -= 1
        part = waiting[left]
        if foreign and owners[part, 0] == highest and owners[part, 1] == lowest:
            continue
        if _apart(box[part], own[0], own[1], own[2], own[3], own[4], own[5]) > allowed:
            continue
        if part < leaves:
            waiting[left], waiting[left + 1] = 2 * part, 2 * part + 1
            left += 2
        else:
            found[size] = part
            size += 1
    return size


@compiled
def _look(points: Floats, i: int, begin: int, end: int, away: Floats, near: Ints) -> None:
    """Puts those of the points from `begin` to `end` that are nearer to i among its neighbours."""
    x, y, z = points[i, 0], points[i, 1], points[i, 2]
    farthest = away[-1]
    for j in range(begin, end):
        u, v, w = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
        squared = u * u + v * v + w * w
        if squared < farthest and j != i:
            place = len(away) - 1
            while place > 0 and away[place - 1] > squared:
                away[place], near[place] = away[place - 1], near[place - 1]
                place -= 1
            away[place], near[place] = squared, j
            farthest = away[-1]


@compiled
def _apart(
    box: Floats, left: float, front: float, low: float, right: float, back: float, high: float
) -> float:
    """The squared gap between a box and another one."""
    u = max(0.0, max(box[0] - right, left - box[3]))
    v = max(0.0, max(box[1] - back, front - box[4]))
    w = max(0.0, max(box[2] - high, low - box[5]))
    return u * u + v * v + w * w


@compiled
def _longer(values: NDArray[Any]) -> NDArray[Any]:
    """With room for as many more."""
    more = np.empty(2 * len(values), values.dtype)
    more[: len(values)] = values
    return more
