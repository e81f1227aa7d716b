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

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from baker.compiled import compiled

LEAST = 8  # points in a small ball
WIDELY = 4  # of so many instants one at which more than the nearest movers count

Floats = NDArray[np.floating]  # float64
Ints = NDArray[np.integer]  # int64
Place = tuple[float, float, float]
Number = TypeVar("Number", np.int64, np.float64)


@compiled
def parted(
    mine: Floats,
    theirs: Floats,
    my_balls: Floats,
    their_balls: Floats,
    weights: Floats,
    their_weights: Floats,
    allowed: float,
) -> bool:
    """Whether two organs are farther apart on the way than at the first and the last instant.

    By more than is allowed; other arguments as those of `beside`. All pairs count, but where two
    movers that were near a while ago are near enough still, nobody else has to be looked at.
    """
    last = len(weights) - 1
    gap, first, second = _closest_at(
        mine, theirs, my_balls, their_balls, weights[last], their_weights[last], 0, 0, 0.0
    )
    begun = False
    for k in range(last - 1, 0, -1):
        away, first, second = _closest_at(
            mine, theirs, my_balls, their_balls,
            weights[k], their_weights[k], first, second, gap + allowed,
        )  # fmt: skip
        if away <= gap + allowed:
            continue
        if not begun:
            at_first = _closest_at(
                mine, theirs, my_balls, their_balls,
                weights[0], their_weights[0], first, second, 0.0,
            )  # fmt: skip
            gap, begun = max(gap, at_first[0]), True
        if away > gap + allowed:
            return True
    return False


@compiled
def beside(
    mine: Floats,
    theirs: Floats,
    my_balls: Floats,
    their_balls: Floats,
    weights: Floats,
    their_weights: Floats,
    margin: float,
    most: int,
) -> tuple[Floats, Ints, Ints]:
    """(I,) the gaps between two organs, and which movers of either are near the other.

    mine, theirs: (degree + 1, a, 3) and (degree + 1, b, 3) control points; my_balls, their_balls:
             (degree + 1, B, 4) around both; weights, their_weights: (I, degree + 1) at any instant.
    margin:  how far beyond an instant's gap is near.
    most:    movers of either side at an instant that count, the nearest ones. At most instants the
             nearest alone counts: the gap, as it is, is known by that.
    """
    instants = len(weights)
    gaps = np.empty(instants)
    room = instants * (most + 1)
    near, nearby = np.empty(room, np.int64), np.empty(room, np.int64)
    count, other, first, second = 0, 0, 0, 0
    for k in range(instants):
        own_weights, other_weights = weights[k], their_weights[k]
        here, there = moved(my_balls, own_weights), moved(their_balls, other_weights)
        gap, first, second = _closest(
            mine, theirs, here, there, own_weights, other_weights, first, second, 0.0
        )
        gaps[k] = gap
        near[count], nearby[other] = first, second
        count, other = count + 1, other + 1
        if k % WIDELY > 0:
            continue
        reach = (1.0 + 1e-9) * gap + margin
        found = _some(
            *within(mine, theirs, here, there, own_weights, other_weights, reach, most, first),
            most,
        )
        own = mine[:, found]
        here = moved(balls(own), own_weights)
        met = _some(
            *within(theirs, own, there, here, other_weights, own_weights, reach, most, second),
            most,
        )
        near[count : count + len(found)] = found
        nearby[other : other + len(met)] = met
        count, other = count + len(found), other + len(met)
    return gaps, np.unique(near[:count]), np.unique(nearby[:other])


@compiled
def _some(found: Ints, away: Floats, most: int) -> Ints:
    """Of those found the `most` nearest where they are more; of ties an even share.

    Movers that start from one point of a bud are all as far off there.
    """
    if len(found) <= most:
        return found
    farthest = _rank(away, most)
    tied = found[away == farthest]
    chosen = np.empty(most, np.int64)
    size = 0
    for i in range(len(found)):
        if away[i] < farthest:
            chosen[size] = found[i]
            size += 1
    left = most - size
    for k in range(left):
        chosen[size + k] = tied[k * len(tied) // left]
    return chosen


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
    mine: Floats, theirs: Floats, my_balls: Floats, their_balls: Floats, weights: Floats
) -> tuple[Floats, Ints, Ints]:
    """(I,) distances and indices of the pair nearest to each other at each of I instants.

    mine, theirs: (K, a, 3) and (K, b, 3) control points; my_balls, their_balls: of both, as `balls`
                  finds them; weights: (I, K).

    All pairs count.
    """
    instants = len(weights)
    gap = np.empty(instants)
    first, second = np.zeros(instants, np.int64), np.zeros(instants, np.int64)
    p, q = 0, 0
    for k in range(instants):
        gap[k], p, q = _closest_at(
            mine, theirs, my_balls, their_balls, weights[k], weights[k], p, q, 0.0
        )
        first[k], second[k] = p, q
    return gap, first, second


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
def within(
    mine: Floats,
    theirs: Floats,
    my_balls: Floats,
    their_balls: Floats,
    weights: Floats,
    their_weights: Floats,
    reach: float,
    most: int,
    near_by: int,
) -> tuple[Ints, Floats]:
    """Which movers are within reach of theirs, and (w,) their distances to the nearest of them.

    mine, theirs: (K, a, 3) and (K, b, 3) control points; my_balls, their_balls: (A, 4) and (B, 4)
             at the instant; weights, their_weights: (K,) there.
    most:    of more movers only those that are as near as the one of this rank.
    near_by: one that is near, with others around it.

    In their order, but for those around `near_by`, which come first. Most movers are far off, and
    nothing is written down for them.
    """
    count_mine, other = mine.shape[1], _large(theirs.shape[1])
    size = _size(count_mine)
    found, away = np.empty(size, np.int64), np.empty(size)
    near = np.empty(other, np.int64)
    count, full = 0, 2 * most
    begin, partner = near_by // size, 0
    for step in range(_large(count_mine)):
        # What is nearest is looked at first: then the rest is too far off.
        a = begin if step == 0 else step - (step <= begin)
        count_near = 0
        for b in range(other):
            if not _clear(my_balls, a, their_balls, b, reach):
                near[count_near] = b
                count_near += 1
        if count_near == 0:
            continue
        if count + size > len(found):
            found, away = _longer(found, 2 * (count + size)), _longer(away, 2 * (count + size))
        nearest, before = np.inf, (np.inf, np.inf, np.inf)
        for i in range(a * size, min((a + 1) * size, count_mine)):
            place = place_of(mine, i, weights)
            # Movers that start from one point of a bud are in one place there.
            if place != before:
                nearest, partner = _nearest(
                    place, theirs, their_balls, their_weights, near[:count_near], reach, partner
                )
                before = place
            if nearest <= reach:
                found[count], away[count] = i, nearest
                count += 1
        if count >= full:
            # Rounding must not leave out movers that are as near.
            reach = _rank(away[:count], most) * (1.0 + 1e-9)
            count = _kept(found, away, count, reach)
            full = max(2 * most, 2 * count)
    if count > most:
        count = _kept(found, away, count, _rank(away[:count], most))
    return found[:count].copy(), away[:count].copy()


@compiled
def _nearest(
    place: Place,
    theirs: Floats,
    their_balls: Floats,
    weights: Floats,
    near: Ints,
    reach: float,
    partner: int,
) -> tuple[float, int]:
    """The distance to the nearest of the movers in some of their large balls; inf beyond reach.

    partner: one that may be near, as that of a neighbour is. Also gives the nearest one.
    """
    large = _large(theirs.shape[1])
    bound = _apart(place, place_of(theirs, partner, weights))
    found = bound <= reach
    bound = min(bound, reach)
    least = bound * bound
    for b in near:
        if _beyond(place, their_balls, b, bound):
            continue
        for small in _within(b, theirs.shape[1]):
            if _beyond(place, their_balls, small, bound):
                continue
            first = (small - large) * LEAST
            for j in range(first, min(first + LEAST, theirs.shape[1])):
                x, y, z = place_of(theirs, j, weights)
                x, y, z = x - place[0], y - place[1], z - place[2]
                squared = x * x + y * y + z * z
                if squared < least or (squared == least and not found):
                    least, bound, found, partner = squared, np.sqrt(squared), True, j
    return (bound if found else np.inf), partner


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
def _rank(values: Floats, rank: int) -> float:
    """The value of this rank, 1 being the least."""
    return np.sort(values)[rank - 1]


@compiled
def _kept(found: Ints, away: Floats, count: int, reach: float) -> int:
    """How many of those found are within reach; they move up to the front, in their order."""
    kept = 0
    for i in range(count):
        if away[i] <= reach:
            found[kept], away[kept] = found[i], away[i]
            kept += 1
    return kept


@compiled
def _longer(values: NDArray[Number], count: int) -> NDArray[Number]:
    longer = np.empty(count, values.dtype)
    longer[: len(values)] = values
    return longer


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
