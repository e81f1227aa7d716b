"""Where two organs are near each other; compiled by numba: import this module late.

What is near at an instant is found by balls. Movers that follow one another are passed over
together where the ball around them is too far off: large balls, about as many as each has movers,
and the small ones in each, so that the work grows with the movers and not with their pairs. It is
fast where neighbours lie side by side, as along a Morton curve. Balls move as movers do: one with
all of some movers' first control points, one with their second ones, and so on, weighted as the
points are, make one that holds the movers.

All this is one file: numba, which keeps machine code by file, does not see that another changes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

LEAST = 8  # points in a small ball

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]  # int64
Place = tuple[float, float, float]


@compiled
def gaps_of(
    mine: Floats,
    theirs: Floats,
    my_balls: Floats,
    their_balls: Floats,
    weights: Floats,
    their_weights: Floats,
    allowed: float,
) -> tuple[Floats, Ints, Ints]:
    """(I,) the gaps between two organs, and which of their movers are that far apart.

    mine, theirs: (degree + 1, a, 3) and (degree + 1, b, 3) control points; my_balls, their_balls:
             (degree + 1, B, 4) around both; weights, their_weights: (I, degree + 1) at any instant.
    allowed: by how much they may be farther apart on the way than at the first and last instant.

    All pairs count, but where two movers are near enough, as those that were a while ago mostly
    are, nobody else is looked at. If they are at every instant, the first gap is left at 0.
    """
    last = len(weights) - 1
    gaps, first, second = (
        np.zeros(last + 1),
        np.zeros(last + 1, np.int64),
        np.zeros(last + 1, np.int64),
    )
    p, q, limit, begun = 0, 0, 0.0, False
    for k in range(last, 0, -1):
        gaps[k], p, q = _closest_at(
            mine, theirs, my_balls, their_balls, weights[k], their_weights[k], p, q, limit
        )
        first[k], second[k] = p, q
        if k == last:
            limit = gaps[k] + allowed
        elif gaps[k] > limit and not begun:
            begun = True
            gaps[0], first[0], second[0] = _closest_at(
                mine, theirs, my_balls, their_balls, weights[0], their_weights[0], p, q, 0.0
            )
            limit = max(gaps[0] + allowed, limit)
    return gaps, first, second


@compiled
def balls(points: Floats) -> Floats:
    """(K, B, 4) balls around successive points of (K, n, 3) clouds: their centres and radii.

    The large ones come first, then the small ones, `LEAST` points in each.
    """
    clouds, count = points.shape[0], points.shape[1]
    large = _large(count)
    found = np.empty((clouds, large + -(-count // LEAST), 4))
    for k in range(clouds):
        for ball in range(found.shape[1]):
            size = _size(count) if ball < large else LEAST
            first = (ball if ball < large else ball - large) * size
            last = min(first + size, count)
            x, y, z = 0.0, 0.0, 0.0
            for i in range(first, last):
                x, y, z = x + points[k, i, 0], y + points[k, i, 1], z + points[k, i, 2]
            x, y, z = x / (last - first), y / (last - first), z / (last - first)
            found[k, ball, 0], found[k, ball, 1], found[k, ball, 2] = x, y, z
            widest = 0.0
            for i in range(first, last):
                widest = max(widest, _squared(points[k], i, found[k], ball))
            # Rounding must not leave a point outside.
            found[k, ball, 3] = np.sqrt(widest) * (1.0 + 1e-9)
    return found


@compiled
def moved(balls: Floats, weights: Floats) -> Floats:
    """(B, 4) balls at an instant, of (K, B, 4) around control points with (K,) weights."""
    found = np.zeros(balls.shape[1:])
    for point in range(len(balls)):
        for ball in range(balls.shape[1]):
            for value in range(4):
                found[ball, value] += weights[point] * balls[point, ball, value]
    return found


@compiled
def closest(
    mine: Floats,
    theirs: Floats,
    my_balls: Floats,
    their_balls: Floats,
    weights: Floats,
    their_weights: Floats,
    first: Ints,
    second: Ints,
    enough: float,
) -> tuple[Floats, Ints, Ints]:
    """(I,) distances and indices of the pair nearest to each other at each of I instants.

    mine, theirs, my_balls, their_balls, weights, their_weights: as those of `gaps_of`.
    first, second: (I,) a pair at each instant that may be the closest.
    enough:        any pair will do that is as near.
    """
    gaps = np.empty(len(weights))
    first, second = first.copy(), second.copy()
    for k in range(len(weights)):
        gaps[k], first[k], second[k] = _closest_at(
            mine, theirs, my_balls, their_balls,
            weights[k], their_weights[k], first[k], second[k], enough,
        )  # fmt: skip
    return gaps, first, second


@compiled
def _closest_at(
    mine: Floats,
    theirs: Floats,
    my_balls: Floats,
    their_balls: Floats,
    weights: Floats,
    their_weights: Floats,
    first: int,
    second: int,
    enough: float,
) -> tuple[float, int, int]:
    """As `_closest`, of balls (degree + 1, B, 4) that have still to be moved."""
    away = _apart(place_of(mine, first, weights), place_of(theirs, second, their_weights))
    if away <= enough:
        return away, first, second
    here, there = moved(my_balls, weights), moved(their_balls, their_weights)
    return _closest(mine, theirs, here, there, weights, their_weights, first, second, enough)


@compiled
def _closest(
    mine: Floats,
    theirs: Floats,
    my_balls: Floats,
    their_balls: Floats,
    weights: Floats,
    their_weights: Floats,
    first: int,
    second: int,
    enough: float,
) -> tuple[float, int, int]:
    """As `closest` at one instant; my_balls, their_balls: (A, 4) and (B, 4) there.

    first, second: a pair that may be the closest, as that of an instant before: what is farther
             apart is passed over.
    enough:  how near a pair has to be, at least, for the search to end with it.
    """
    large, other = _large(mine.shape[1]), _large(theirs.shape[1])
    here, there = np.empty((LEAST, 3)), np.empty((LEAST, 3))
    reach = _apart(place_of(mine, first, weights), place_of(theirs, second, their_weights))
    for a in range(large):
        for b in range(other):
            if reach <= enough:
                return reach, first, second
            if _clear(my_balls, a, their_balls, b, reach):
                continue
            for small in _within(a, mine.shape[1]):
                if _clear(my_balls, small, their_balls, b, reach):
                    continue
                count = _places(mine, small - large, weights, here)
                for least in _within(b, theirs.shape[1]):
                    if _clear(my_balls, small, their_balls, least, reach):
                        continue
                    others = 0
                    for i in range(count):
                        if _beyond(here[i], their_balls, least, reach):
                            continue
                        if others == 0:
                            others = _places(theirs, least - other, their_weights, there)
                        for j in range(others):
                            squared = _squared(here, i, there, j)
                            if squared < reach * reach:
                                reach = np.sqrt(squared)
                                first = (small - large) * LEAST + i
                                second = (least - other) * LEAST + j
    return reach, first, second


@compiled
def place_of(curve: Floats, i: int, weights: Floats) -> Place:
    """Where a mover is."""
    x, y, z = 0.0, 0.0, 0.0
    for point in range(len(weights)):
        weight = weights[point]
        x += weight * curve[point, i, 0]
        y += weight * curve[point, i, 1]
        z += weight * curve[point, i, 2]
    return x, y, z


@compiled
def _places(curve: Floats, ball: int, weights: Floats, places: Floats) -> int:
    """Where the movers of a small ball are, and how many these are."""
    first = ball * LEAST
    count = min(LEAST, curve.shape[1] - first)
    for i in range(count):
        places[i, 0], places[i, 1], places[i, 2] = place_of(curve, first + i, weights)
    return count


@compiled
def _size(count: int) -> int:
    """Points in a large ball: as many as there are such balls, whole small ones."""
    return LEAST * max(1, int(np.sqrt(count)) // LEAST)


@compiled
def _large(count: int) -> int:
    """How many large balls there are."""
    return -(-count // _size(count))


@compiled
def _within(ball: int, count: int) -> range:
    """The small balls within a large one."""
    inside, large = _size(count) // LEAST, _large(count)
    return range(
        large + ball * inside, min(large + (ball + 1) * inside, large + -(-count // LEAST))
    )


@compiled
def _clear(a: Floats, i: int, b: Floats, j: int, reach: float) -> bool:
    """Whether two balls are farther apart than some reach."""
    beyond = reach + a[i, 3] + b[j, 3]
    return _squared(a, i, b, j) > beyond * beyond


@compiled
def _beyond(place: Place, ball: Floats, i: int, reach: float) -> bool:
    """Whether a ball is farther from a place than some reach."""
    x, y, z = place[0] - ball[i, 0], place[1] - ball[i, 1], place[2] - ball[i, 2]
    beyond = reach + ball[i, 3]
    return x * x + y * y + z * z > beyond * beyond


@compiled
def _apart(a: Place, b: Place) -> float:
    x, y, z = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return np.sqrt(x * x + y * y + z * z)


@compiled
def _squared(a: Floats, i: int, b: Floats, j: int) -> float:
    x, y, z = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
    return x * x + y * y + z * z
