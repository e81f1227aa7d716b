"""Which limbs of an organ are the same in two scans, and how what lies between them has moved.

Where a branch bears leaves, new ones appear from scan to scan. Mass spread evenly over the whole
branch would make room for them, and points would leave one leaf for the next. So limbs that both
scans show go each on its own, and the stalk goes with those around it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.matching.leaflet_registration import FEWEST, laid_on, middles
from baker.segmentation.leaflets import limbs
from baker.transport.support import balance

Points = NDArray[np.floating]
Indices = NDArray[np.intp]

MOSTLY = 0.5  # of a limb lies nearest to another one that it is then joined to
AROUND = 8  # limbs that carry the stalk between them along


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


def pieces(start: Points, end: Points, foot: tuple[int, int]) -> list[Piece]:
    """An organ with limbs cut into those that both scans show, and the rest; none without limbs.

    start, end: (n, 3), (m, 3); foot: the points where the organ is attached, one of either.

    Together the pieces have every point of either side exactly once. Where too few limbs are the
    same to go by, all is one piece.
    """
    both = _limbs_of_both((start, end), foot)
    if both is None:
        return []
    first, second = both
    feet = foot[0], foot[1]
    here, there, pairs = laid_on(start, end, feet, first, second)
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


def _limbs_of_both(
    sides: tuple[Points, Points], foot: tuple[int, int]
) -> tuple[Indices, Indices] | None:
    """The limbs of either side; None where one has none, as most have: the smaller is asked."""
    found: dict[int, Indices] = {}
    for side in sorted((0, 1), key=lambda side: len(sides[side])):
        found[side] = limbs(sides[side], foot[side])
        if found[side].max() < 0:
            return None
    return found[0], found[1]


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

    places = np.concatenate([middles(here, first, pairs)[0], here[[feet[0]]]])
    shifts = np.concatenate([middles(there, second, pairs)[0], there[[feet[1]]]]) - places
    away, around = cKDTree(places).query(here, k=min(AROUND, len(places)))
    weight = 1.0 / np.maximum(away, 1e-9 * (away.max() + 1e-300))
    weight /= weight.sum(axis=1, keepdims=True)
    shift: NDArray[np.float64] = np.einsum("nk,nkx->nx", weight, shifts[around])
    return shift
