"""A cloud's points by the cubes that they lie in: all their neighbours, found cube by cube.

Faster than a tree where a search is for the neighbours of all points: those of a cube share what is
around it, and cubes that follow one another look at nearly the same. What lies too thin or too
thick for cubes of one size is left to a tree. Compiled by numba: import this module late.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled
from baker.workers import Crew

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

SAMPLED = 16  # points whose neighbours tell how large cubes should be
WIDE = 1.3  # times as far as the usual point's neighbours reach: most have all in the 27 about it
FARTHEST = 2.0**19  # cubes from the middle; what is farther off counts as being there
SIDE = 2**20 + 4  # cubes along an axis, and empty ones around
MOST = 512  # points around a cube, beyond which they are better looked up in a tree
ENOUGH = 32  # nearest points within reach that are told

# Of the columns of three cubes about one, that of its own first: most of what is near is there.
COLUMNS = ((0, 0), (-1, 0), (0, -1), (0, 1), (1, 0), (-1, -1), (-1, 1), (1, -1), (1, 1))

TOGETHER = 4096  # points, whose neighbours stay in the processor's cache

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Pairs = tuple[Ints, Ints, Floats]  # points, others, and how far they are apart


@dataclass(frozen=True)
class Cubes:
    """N points in C cubes.

    order:  (N,) the points' numbers in the cloud, cube by cube.
    points: (N, 3) the points in that order.
    names:  (C,) ascending; those of cubes along the third axis follow one another.
    first:  (C + 1,) where each one's points begin.
    middle, edge: cubes are so long, and one has a corner there.
    """

    order: NDArray[np.intp]
    points: Floats
    names: Ints
    first: Ints
    middle: Floats
    edge: float

    @classmethod
    def of(cls, points: NDArray[np.floating], count: int, edge: float = 0.0) -> Cubes:
        """Cubes of (N, 3) points, made to look for the `count` nearest of each.

        edge: that they have to be longer than.
        """
        sample = np.linspace(0, len(points) - 1, min(len(points), SAMPLED)).astype(np.intp)
        some = points[sample].astype(np.float64)
        usual = np.median(_reaches(some, points, min(count, len(points))))
        edge = max(WIDE * float(usual), 1.001 * edge, np.finfo(float).tiny)
        middle = np.median(some, axis=0)
        with np.errstate(over="ignore"):
            away = (points - middle) / edge
        places = np.clip(np.floor(away, out=away), -FARTHEST, FARTHEST, out=away) + SIDE // 2
        x, y, z = places.T.astype(np.int64)
        names = (x * SIDE + y) * SIDE + z
        order = np.argsort(names, kind="stable")
        ordered = names.take(order)
        first = np.flatnonzero(np.diff(ordered, prepend=-1))
        placed = points.take(order, axis=0).astype(np.float64)
        return cls(order, placed, ordered[first], np.append(first, len(points)), middle, edge)

    def batches(self) -> list[slice]:
        """All cubes, by their places, some thousand points in each batch."""
        stops = np.searchsorted(self.first, np.arange(TOGETHER, len(self.points), TOGETHER))
        ends = [0, *np.unique(stops).tolist(), len(self.names)]
        return [slice(a, b) for a, b in pairwise(ends) if b > a]

    def nearest(self, batch: slice, count: int) -> tuple[Ints, Floats]:
        """For the points of some cubes the `count` nearest of all, nearest first, and how far.

        (n, count) each. The point itself is among them.
        """
        about = self.names, self.first, self.points
        near, apart = _nearest(*about, self.middle, self.edge, batch.start, batch.stop, count)
        left = np.flatnonzero(near[:, 0] < 0)
        if len(left):
            own = self.points.take(left + self.first[batch.start], axis=0)
            apart[left], near[left] = self._tree.query(own, np.arange(1, count + 1))
        return near, apart

    def pairs(self, owner: NDArray[np.intp], reach: float, workers: int = 1) -> Pairs:
        """Points that may be near another owner's, and what of the cloud is within reach of them.

        owner: (N,) of each of `points`; reach: shorter than a cube; workers: threads.

        Of each point are told the nearest, up to `ENOUGH`; none of those around which 27 cubes have
        one owner.
        """
        low, high = (side.reduceat(owner, self.first[:-1]) for side in (np.minimum, np.maximum))

        def look(batch: slice) -> Pairs:
            cubes = self.names, self.first, self.points
            *found, crowded = _pairs(*cubes, low, high, reach, batch.start, batch.stop)
            more = self._asked(crowded, reach) if len(crowded) else []
            one, other, apart = (np.concatenate(part) for part in zip(found, *more, strict=True))
            return self.order.take(one), self.order.take(other), apart

        found = Crew(workers).map(look, self.batches())
        one, other, apart = (np.concatenate(part) for part in zip(*found, strict=True))
        return one, other, apart

    def _asked(self, places: Ints, reach: float) -> list[Pairs]:
        """The pairs of some points that have many around."""
        own = self.points.take(places, axis=0)
        apart, other = self._tree.query(own, ENOUGH + 1, distance_upper_bound=reach)
        there = np.isfinite(apart) & (other != places[:, None])
        one = np.broadcast_to(places[:, None], there.shape)
        return [(one[there], other[there], apart[there])]

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(self.points, balanced_tree=False)


@compiled
def _squared(some: Floats, i: int, others: NDArray[np.floating], j: int) -> float:
    """The square of how far two points are apart."""
    x, y, z = some[i, 0] - others[j, 0], some[i, 1] - others[j, 1], some[i, 2] - others[j, 2]
    return x * x + y * y + z * z


@compiled
def _inserted(far: Floats, who: Ints, held: int, away: float, index: int) -> int:
    """Puts one more among the nearest so far, of which as many are held as there is room for."""
    at = held
    if held == len(far):
        at -= 1
    else:
        held += 1
    while at > 0 and far[at - 1] > away:
        far[at], who[at] = far[at - 1], who[at - 1]
        at -= 1
    far[at], who[at] = away, index
    return held


@compiled
def _reaches(some: Floats, points: NDArray[np.floating], count: int) -> Floats:
    """(n,) how far the `count` nearest of all points are from some of them."""
    reaches, far, who = np.empty(len(some)), np.empty(count), np.empty(count, np.int64)
    for i in range(len(some)):
        held = 0
        for j in range(len(points)):
            away = _squared(some, i, points, j)
            if held < count or away < far[count - 1]:
                held = _inserted(far, who, held, away, j)
        reaches[i] = np.sqrt(far[count - 1])
    return reaches


@compiled
def _columns(names: Ints, cube: int) -> Ints:
    """Where the 9 columns of 3 cubes about one begin, as far as there are any."""
    places = np.empty(len(COLUMNS), np.int64)
    for column, (x, y) in enumerate(COLUMNS):
        places[column] = np.searchsorted(names, names[cube] + (x * SIDE + y) * SIDE - 1)
    return places


@compiled
def _run(names: Ints, cube: int, column: int, places: Ints) -> tuple[int, int]:
    """The cubes of a column about one; `places` of one before are moved on from."""
    x, y = COLUMNS[column]
    lowest = names[cube] + (x * SIDE + y) * SIDE - 1
    begin = places[column]
    while begin < len(names) and names[begin] < lowest:
        begin += 1
    places[column] = end = begin
    while end < len(names) and names[end] <= lowest + 2:
        end += 1
    return begin, end


@compiled
def _nearest(
    names: Ints,
    first: Ints,
    points: Floats,
    middle: Floats,
    edge: float,
    start: int,
    stop: int,
    count: int,
) -> tuple[Ints, Floats]:
    """As `Cubes.nearest`; near is -1 where 27 cubes may not hold them."""
    total = first[stop] - first[start]
    near, apart = np.full((total, count), -1), np.empty((total, count))
    places = _columns(names, start)
    around, members = np.empty((3, MOST)), np.empty(MOST, np.int64)
    away, inside = np.empty(MOST), np.empty(MOST, np.int64)
    far = np.empty(count)
    before, reached = -1, 0.0
    for cube in range(start, stop):
        size = 0
        for column in range(len(COLUMNS)):
            begin, end = _run(names, cube, column, places)
            for j in range(first[begin], min(first[end], first[begin] + MOST - size)):
                for axis in range(3):
                    around[axis, size] = points[j, axis]
                members[size] = j
                size += 1
        if size == MOST:
            continue
        for i in range(first[cube], first[cube + 1]):
            x, y, z = points[i, 0], points[i, 1], points[i, 2]
            for j in range(size):
                dx, dy, dz = x - around[0, j], y - around[1, j], z - around[2, j]
                away[j] = dx * dx + dy * dy + dz * dz
            # The 27 cubes hold all that is as near as their faces.
            reach = np.inf
            for axis in range(3):
                place = (points[i, axis] - middle[axis]) / edge
                place -= np.floor(place)
                reach = min(reach, 1.0 + place, 2.0 - place)
            reach *= edge
            if before >= 0:
                # What the point before has around it is no farther from this one than so much more.
                step = np.sqrt(_squared(points, i, points, before))
                reach = min(reach, 1.000001 * (reached + step))
            reach *= reach
            within = 0
            for j in range(size):
                inside[within] = j
                within += away[j] <= reach
            if within < count:
                continue
            held, row = 0, i - first[start]
            for k in range(within):
                j = inside[k]
                if held < count or away[j] < far[count - 1]:
                    held = _inserted(far, near[row], held, away[j], members[j])
            apart[row] = np.sqrt(far)
            before, reached = i, np.sqrt(far[count - 1])
    return near, apart


@compiled
def _pairs(
    names: Ints,
    first: Ints,
    points: Floats,
    lowest: Ints,
    highest: Ints,
    reach: float,
    start: int,
    stop: int,
) -> tuple[Ints, Ints, Floats, Ints]:
    """As `Cubes.pairs`, by their places; and points that have too many around.

    lowest, highest: (C,) owners in each cube.
    """
    places, starts, ends = _columns(names, start), np.empty(9, np.int64), np.empty(9, np.int64)
    far, who = np.empty(ENOUGH), np.empty(ENOUGH, np.int64)
    one, other, apart = np.empty(1024, np.int64), np.empty(1024, np.int64), np.empty(1024)
    crowded = np.zeros(first[stop] - first[start], np.bool_)
    found, allowed = 0, max(reach * reach, 5e-324)
    for cube in range(start, stop):
        least, most = lowest[cube], highest[cube]
        size = 0
        for column in range(9):
            starts[column], ends[column] = _run(names, cube, column, places)
            size += first[ends[column]] - first[starts[column]]
            for beside in range(starts[column], ends[column]):
                least, most = min(least, lowest[beside]), max(most, highest[beside])
        if least == most:
            continue
        if size > MOST:
            crowded[first[cube] - first[start] : first[cube + 1] - first[start]] = True
            continue
        for i in range(first[cube], first[cube + 1]):
            held = 0
            for column in range(9):
                for j in range(first[starts[column]], first[ends[column]]):
                    away = _squared(points, i, points, j)
                    if away < allowed and j != i and (held < ENOUGH or away < far[ENOUGH - 1]):
                        held = _inserted(far, who, held, away, j)
            if found + held > len(one):
                one, other, apart = _longer(one), _longer(other), _longer(apart)
            for k in range(held):
                one[found], other[found], apart[found] = i, who[k], np.sqrt(far[k])
                found += 1
    left = np.flatnonzero(crowded) + first[start]
    return one[:found], other[:found], apart[:found], left


@compiled
def _longer(values: NDArray[Any]) -> NDArray[Any]:
    """With room for as many more."""
    more = np.empty(2 * len(values), values.dtype)
    more[: len(values)] = values
    return more
