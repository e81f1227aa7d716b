"""How far two organs are from each other as they move; compiled by numba: import this module late.

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

from baker.geometry.compiled import compiled

LEAST = 8  # points in a small ball

Floats = NDArray[np.floating]
Ints = NDArray[np.integer]
Flags = NDArray[np.bool_]
Place = tuple[float, float, float]

# Movers: their (degree + 1, n, 3) control points, the `balls` around these, and the
# (I, degree + 1) weights of control points at each instant.
Moving = tuple[Floats, Floats, Floats]


@compiled
def gaps_of(mine: Moving, theirs: Moving, allowed: float) -> tuple[Floats, Ints, Ints]:
    """(I,) the gaps between two organs, and which of their movers are that far apart.

    allowed: by how much they may be farther apart on the way than at the first and last instant.

    All pairs count, but the search ends with one that is near enough, as one that was near a while
    ago often is. What is exact is the gap at the first and the last instant, and the largest one on
    the way if they may not be as far apart.
    """
    last = len(mine[2]) - 1
    gaps, known = np.zeros(last + 1), np.zeros(last + 1, np.bool_)
    gaps[last], p, q = _closest(mine, theirs, last, -1, -1, 0.0)
    first, second = np.full(last + 1, p), np.full(last + 1, q)
    gaps[0], first[0], second[0] = _closest(mine, theirs, 0, p, q, 0.0)
    known[0] = known[last] = True
    _refine(mine, theirs, gaps, first, second, known, max(gaps[0], gaps[last]) + allowed)
    return gaps, first, second


@compiled
def widest(
    mine: Moving, theirs: Moving, first: Ints, second: Ints, enough: float
) -> tuple[Floats, Ints, Ints]:
    """(I,) gaps, of which the largest is exact, and which movers are that far apart.

    first, second: (I,) a pair at each instant that may be the closest.
    enough:        any pair will do that is as near.
    """
    gaps, first, second = np.zeros(len(first)), first.copy(), second.copy()
    _refine(mine, theirs, gaps, first, second, np.zeros(len(first), np.bool_), enough)
    return gaps, first, second


@compiled
def _refine(
    mine: Moving,
    theirs: Moving,
    gaps: Floats,
    first: Ints,
    second: Ints,
    known: Flags,
    enough: float,
) -> None:
    """Puts (I,) gaps in place, so that the largest one is exact if it is more than enough.

    first, second: a pair at each instant that may be the closest; the closest that was found.
    known:         where the gap is known.
    """
    for k in range(len(gaps)):
        if not known[k]:
            gaps[k] = _between(mine, theirs, k, first[k], second[k])
    while True:
        widest = -1
        for k in range(len(gaps)):
            if not known[k] and gaps[k] > enough and (widest < 0 or gaps[k] > gaps[widest]):
                widest = k
        if widest < 0:
            return
        gaps[widest], p, q = _closest(mine, theirs, widest, first[widest], second[widest], enough)
        first[widest], second[widest], known[widest] = p, q, True
        # What is no wider than this one does not matter.
        enough = max(enough, gaps[widest])
        for k in range(len(gaps)):
            if not known[k]:
                away = _between(mine, theirs, k, p, q)
                if away < gaps[k]:
                    gaps[k], first[k], second[k] = away, p, q


@compiled
def _closest(
    mine: Moving, theirs: Moving, k: int, first: int, second: int, enough: float
) -> tuple[float, int, int]:
    """How far the pair nearest to each other at instant k is apart, and which it is.

    first, second: a pair that may be the closest, as that of another instant: what is farther
             apart is passed over. Negative where none is known.
    enough:  how near a pair has to be, at least, for the search to end with it.
    """
    count, others = mine[0].shape[1], theirs[0].shape[1]
    large, other = _large(count), _large(others)
    here, there = np.empty(mine[1].shape[1:]), np.empty(theirs[1].shape[1:])
    begun, met = np.zeros(large, np.bool_), np.zeros(other, np.bool_)
    _move(mine, k, range(large), here)
    _move(theirs, k, range(other), there)
    likely, likely_met = _middles(here, range(large), there, range(other))
    reach = np.inf if first < 0 else _between(mine, theirs, k, first, second)
    for step in range(large + 1):
        # Two balls that are close to each other come first: most others are farther off then.
        a = likely if step == 0 else step - 1
        for b in range(likely_met if step == 0 else 0, likely_met + 1 if step == 0 else other):
            if reach <= enough:
                return reach, first, second
            if _clear(here, a, there, b, reach):
                continue
            if not begun[a]:
                _move(mine, k, _within(a, count), here)
                begun[a] = True
            if not met[b]:
                _move(theirs, k, _within(b, others), there)
                met[b] = True
            reach, first, second = _closer(mine, theirs, k, a, b, here, there, first, second, reach)
    return reach, first, second


@compiled
def _closer(
    mine: Moving,
    theirs: Moving,
    k: int,
    a: int,
    b: int,
    my_balls: Floats,
    their_balls: Floats,
    first: int,
    second: int,
    reach: float,
) -> tuple[float, int, int]:
    """As `_closest`, of the movers in two large balls; my_balls, their_balls: (B, 4) at instant k.

    first, second, reach: the closest pair so far, and how far it is apart.
    """
    large, other = _large(mine[0].shape[1]), _large(theirs[0].shape[1])
    here, there = np.empty((LEAST, 3)), np.empty((LEAST, 3))
    for small in _within(a, mine[0].shape[1]):
        if _clear(my_balls, small, their_balls, b, reach):
            continue
        size = _places(mine, k, small - large, here)
        for least in _within(b, theirs[0].shape[1]):
            if _clear(my_balls, small, their_balls, least, reach):
                continue
            partners = 0
            for i in range(size):
                if _beyond(here[i], their_balls, least, reach):
                    continue
                if partners == 0:
                    partners = _places(theirs, k, least - other, there)
                for j in range(partners):
                    squared = _squared(here, i, there, j)
                    if squared < reach * reach:
                        reach = np.sqrt(squared)
                        first = (small - large) * LEAST + i
                        second = (least - other) * LEAST + j
    return reach, first, second


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
def _move(moving: Moving, k: int, chosen: range, found: Floats) -> None:
    """Puts the chosen balls in place, (B, 4), as they are at instant k."""
    balls, weights = moving[1], moving[2]
    for ball in chosen:
        for value in range(4):
            total = 0.0
            for point in range(len(balls)):
                total += weights[k, point] * balls[point, ball, value]
            found[ball, value] = total


@compiled
def place_of(moving: Moving, k: int, i: int) -> Place:
    """Where a mover is at instant k."""
    curve, weights = moving[0], moving[2]
    x, y, z = 0.0, 0.0, 0.0
    for point in range(len(curve)):
        weight = weights[k, point]
        x += weight * curve[point, i, 0]
        y += weight * curve[point, i, 1]
        z += weight * curve[point, i, 2]
    return x, y, z


@compiled
def _places(moving: Moving, k: int, ball: int, places: Floats) -> int:
    """Where the movers of a small ball are, and how many these are."""
    first = ball * LEAST
    count = min(LEAST, moving[0].shape[1] - first)
    for i in range(count):
        places[i, 0], places[i, 1], places[i, 2] = place_of(moving, k, first + i)
    return count


@compiled
def _between(mine: Moving, theirs: Moving, k: int, i: int, j: int) -> float:
    """How far two movers are apart at instant k."""
    a, b = place_of(mine, k, i), place_of(theirs, k, j)
    x, y, z = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return np.sqrt(x * x + y * y + z * z)


@compiled
def _middles(a: Floats, some: range, b: Floats, others: range) -> tuple[int, int]:
    """Those of some balls whose middles are closest."""
    least, first, second = np.inf, 0, 0
    for i in some:
        for j in others:
            squared = _squared(a, i, b, j)
            if squared < least:
                least, first, second = squared, i, j
    return first, second


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
def _beyond(place: Floats, ball: Floats, i: int, reach: float) -> bool:
    """Whether a ball is farther from a place than some reach."""
    x, y, z = place[0] - ball[i, 0], place[1] - ball[i, 1], place[2] - ball[i, 2]
    beyond = reach + ball[i, 3]
    return x * x + y * y + z * z > beyond * beyond


@compiled
def _squared(a: Floats, i: int, b: Floats, j: int) -> float:
    x, y, z = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
    return x * x + y * y + z * z
