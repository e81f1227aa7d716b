"""Which limbs of an organ are the same in two scans, and how what lies between them has moved.

Where a branch bears leaves, new ones appear from scan to scan. Mass spread evenly over the whole
branch would make room for them, and points would leave one leaf for the next. So limbs that both
scans show go each on its own, and the stalk goes with those around it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.segment.limbs import limbs
from baker.transport.support import balance

Points = NDArray[np.floating]
Indices = NDArray[np.intp]

FAR = 2.0  # radii of the larger limb from which two are not the same
ALIKE = 3.0  # times a limb's share of the organ's points; what is more has been cut otherwise
MOSTLY = 0.5  # of a limb lies nearest to another one that it is then joined to
ROUNDS = 3  # of laying an organ on itself by its limbs
STIFFNESS = 0.5  # share of the limbs' spread that holds their map back from stretching
AROUND = 8  # limbs that carry the stalk between them along
FEWEST = 3  # limbs that both scans show, else an organ is but forked


@dataclass(frozen=True)
class Piece:
    """What is transported on its own.

    start, end: (n,), (m,) points of the organ in either scan.
    here, there: (n, 3), (m, 3) where they lie on each other, growth taken out, and of the stalk
                 how the limbs around it have moved.
    """

    start: Indices
    end: Indices
    here: Points
    there: Points


def pieces(start: Points, end: Points, feet: tuple[int, int]) -> list[Piece]:
    """An organ with limbs cut into those that both scans show, and the rest; none without limbs.

    start, end: (n, 3), (m, 3); feet: the points where the organ is attached, one of either.

    Together the pieces have every point of either side exactly once. Where too few limbs are the
    same to go by, all is one piece.
    """
    first, second = limbs(start, feet[0]), limbs(end, feet[1])
    if first.max() < 0 or second.max() < 0:
        return []
    here, there, pairs = _laid_on(start, end, feet, first, second)
    whole = [Piece(np.arange(len(start)), np.arange(len(end)), here, there)]
    if len(pairs) < FEWEST:
        return whole
    before, after = _named(first, pairs[:, 0]), _named(second, pairs[:, 1])
    carried = here + _shift(here, there, feet, before, after, len(pairs))
    before, after = _joined(before, after, here, there, first, second)
    cut = []
    for piece in range(-1, len(pairs)):
        a, b = np.flatnonzero(before == piece), np.flatnonzero(after == piece)
        if len(a) and len(b):
            lying = (carried[a], there[b]) if piece < 0 else balance(start[a], end[b])
            cut.append(Piece(a, b, *lying))
    used = sum(len(piece.start) + len(piece.end) for piece in cut)
    return cut if used == len(start) + len(end) else whole


def _laid_on(
    start: Points, end: Points, feet: tuple[int, int], first: Indices, second: Indices
) -> tuple[Points, Points, Indices]:
    """Both scans of an organ laid on each other, and (p, 2) the limbs that are the same then.

    Leaves born at its end leave a twig where it was, or carry it along with its foot; a shoot may
    stretch as a whole. What makes most limbs lie on each other is taken. How these have moved then
    tells where others are to be looked for.
    """
    ways = [(start, end), (start - start[feet[0]] + end[feet[1]], end), balance(start, end)]
    found = [_paired(_Limbs(here, first), _Limbs(there, second)) for here, there in ways]
    best = int(np.argmax([worth for _, worth in found]))
    (here, there), (pairs, worth) = ways[best], found[best]
    for _ in range(ROUNDS):
        if len(pairs) < FEWEST:
            break
        moved = _moved(here, _Limbs(here, first), _Limbs(there, second), pairs)
        closer, gained = _paired(_Limbs(moved, first), _Limbs(there, second))
        if gained <= worth:
            break
        pairs, worth = closer, gained
    return here, there, pairs


def _moved(points: Points, first: _Limbs, second: _Limbs, pairs: Indices) -> NDArray[np.float64]:
    """(n, 3) points moved as the limbs' middles have on the whole: by an affine map, held back."""
    before, after = first.middle[pairs[:, 0]], second.middle[pairs[:, 1]]
    weight = np.sqrt(np.minimum(first.count[pairs[:, 0]], second.count[pairs[:, 1]]))
    centre, way = (np.average(v, axis=0, weights=weight) for v in (before, after - before))
    apart = before - centre
    spread = (apart.T * weight) @ apart
    stiff = STIFFNESS * np.trace(spread) / 3 * np.eye(3) + np.finfo(float).tiny * np.eye(3)
    slope = np.linalg.solve(spread + stiff, (apart.T * weight) @ (after - before - way))
    moved: NDArray[np.float64] = points + way + (points - centre) @ slope
    return moved


class _Limbs:
    """Middles (k, 3), radii (k,) and points (k,) of an organ's limbs in one scan; of how many."""

    def __init__(self, points: Points, limb: Indices) -> None:
        self.of = len(points)
        self.middle, self.count = _middles(points, limb, int(limb.max()) + 1)
        apart = ((points - self.middle[limb]) ** 2).sum(axis=1)
        on = limb >= 0
        self.radius = np.sqrt(np.bincount(limb[on], apart[on]) / self.count)


def _paired(first: _Limbs, second: _Limbs) -> tuple[Indices, float]:
    """(p, 2) limbs that are the same, of all choices the one of greatest worth; and what that is.

    A pair is worth the more the nearer its limbs lie and the more points they have.
    """
    from scipy.optimize import linear_sum_assignment
    from scipy.spatial.distance import cdist

    radius = np.maximum(first.radius[:, None], second.radius[None])
    near = FAR - cdist(first.middle, second.middle) / np.maximum(radius, 1e-300)
    growth = (second.count / second.of)[None] / (first.count / first.of)[:, None]
    near[np.maximum(growth, 1 / growth) > ALIKE] = 0
    worth = np.maximum(near, 0) ** 2 * np.sqrt(np.minimum(first.count[:, None], second.count[None]))
    rows, columns = linear_sum_assignment(worth, maximize=True)
    made = worth[rows, columns] > 0
    return np.stack([rows[made], columns[made]], axis=1), float(worth[rows, columns].sum())


def _named(limb: Indices, chosen: Indices) -> Indices:
    """(n,) the pair of each point's limb, -1 of one in none and of the stalk."""
    names = np.full(int(limb.max()) + 2, -1)
    names[chosen] = np.arange(len(chosen))
    return names[limb]  # -1 takes the last


def _joined(
    first: Indices, second: Indices, here: Points, there: Points, before: Indices, after: Indices
) -> tuple[Indices, Indices]:
    """The pair of each point; limbs in none go with the pair that most of them are nearest to.

    What touches is one limb in one scan, perhaps, and two in the other.
    """
    from scipy.spatial import cKDTree

    ahead = second[cKDTree(there).query(here)[1]]
    back = first[cKDTree(here).query(there)[1]]
    return _with_most(first, before, ahead), _with_most(second, after, back)


def _with_most(named: Indices, limb: Indices, nearest: Indices) -> Indices:
    joined = named.copy()
    for lonely in np.unique(limb[(named < 0) & (limb >= 0)]):
        members = np.flatnonzero(limb == lonely)
        votes = np.bincount(nearest[members] + 1)
        votes[0] = 0
        if votes.max() >= MOSTLY * len(members):
            joined[members] = int(votes.argmax()) - 1
    return joined


def _shift(
    here: Points,
    there: Points,
    feet: tuple[int, int],
    first: Indices,
    second: Indices,
    pairs: int,
) -> NDArray[np.float64]:
    """(n, 3) the shifts of the limbs and of the foot, the nearer the more they count."""
    from scipy.spatial import cKDTree

    places = np.concatenate([_middles(here, first, pairs)[0], here[[feet[0]]]])
    shifts = np.concatenate([_middles(there, second, pairs)[0], there[[feet[1]]]]) - places
    away, around = cKDTree(places).query(here, k=min(AROUND, len(places)))
    weight = 1.0 / np.maximum(away, 1e-9 * (away.max() + 1e-300))
    weight /= weight.sum(axis=1, keepdims=True)
    shift: NDArray[np.float64] = np.einsum("nk,nkx->nx", weight, shifts[around])
    return shift


def _middles(
    points: Points, limb: Indices, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    on = limb >= 0
    members = np.bincount(limb[on], minlength=count).astype(float)
    sums = [np.bincount(limb[on], axis, count) for axis in points[on].T.astype(float)]
    return np.stack(sums, axis=1) / members[:, None], members
