"""Two scans of an organ laid on each other by their limbs, and which limbs are the same then."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.rigid import rotations_between
from baker.transport.support import balance

Points = NDArray[np.floating]
Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

FAR = 2.0  # radii of the larger limb from which two are not the same
ALIKE = 3.0  # times a limb's share of the organ's points; what is more has been cut otherwise
STIFFNESS = 0.5  # share of the limbs' spread that holds their map back from stretching
ROUNDS = 3  # of laying an organ on itself by its limbs
FEWEST = 3  # limbs that both scans show, else an organ is but forked
GROWTH = 5.0  # times as far from the foot as it was, or as near, that a limb is at most
PROMISING = 6  # swings that are looked at closely
TRIED = 2_000_000  # pairs of limbs, in all swings together, that are looked at for these
BACK = -0.5  # cosine of a swing beyond which none is looked for


@dataclass(frozen=True)
class Limbs:
    """Of an organ's limbs in one scan middles (k, 3), radii (k,), and points (k,) out of `of`."""

    middle: Floats
    radius: Floats
    count: Floats
    of: int

    @classmethod
    def of_points(cls, points: Points, limb: Indices) -> Limbs:
        """Those of (n, 3) points, of which each lies on some limb or, at -1, on none."""
        middle, count = middles(points, limb, int(limb.max()) + 1)
        apart = ((points - middle[limb]) ** 2).sum(axis=1)
        on = limb >= 0
        return cls(middle, np.sqrt(np.bincount(limb[on], apart[on]) / count), count, len(points))


@dataclass(frozen=True)
class _Way:
    """One way of laying an organ on itself: both scans' points and limbs."""

    here: Points
    there: Points
    first: Limbs
    second: Limbs


def laid_on(
    start: Points, end: Points, feet: tuple[int, int], first: Indices, second: Indices
) -> tuple[Points, Points, Indices]:
    """Both scans of an organ laid on each other, and (p, 2) the limbs that are the same then.

    start, end: (n, 3), (m, 3); feet: the points where the organ is attached, one of either;
    first, second: (n,), (m,) the limb that each point lies on, -1 for none.

    Leaves born at its end leave a twig where it was, or carry it along with its foot; a shoot may
    stretch as a whole; or it swings and lengthens so far that no limb lies where any has been.
    What makes most limbs lie on each other, after a second look, is taken.
    """
    feet_on_feet = start - start[feet[0]] + end[feet[1]]
    plain = [(start, end), (feet_on_feet, end), balance(start, end)]
    ways = [_Way(a, b, Limbs.of_points(a, first), Limbs.of_points(b, second)) for a, b in plain]
    found = [_second_look(way) for way in ways]
    least = max(2, min(FEWEST, int(first.max()) + 1, int(second.max()) + 1))
    for way in _swings(ways[1], end[feet[1]]):
        pairs, worth = _second_look(way)
        if len(pairs) >= least:
            ways.append(way)
            found.append((pairs, worth))
    best = int(np.argmax([worth for _, worth in found]))
    return ways[best].here, ways[best].there, found[best][0]


def paired(first: Limbs, second: Limbs) -> tuple[Indices, float]:
    """(p, 2) limbs that are the same, of all choices the one of greatest worth; and what that is.

    A pair is worth the more the nearer its limbs lie and the more points they have.
    """
    from scipy.optimize import linear_sum_assignment

    worth = _worth(first.middle, first.radius, first, second)
    rows, columns = linear_sum_assignment(worth, maximize=True)
    made = worth[rows, columns] > 0
    return np.stack([rows[made], columns[made]], axis=1), float(worth[rows, columns].sum())


def middles(points: Points, limb: Indices, count: int) -> tuple[Floats, Floats]:
    """(count, 3) the middles of limbs, and (count,) how many points they have.

    points: (n, 3); limb: (n,) which each one lies on, -1 for none.
    """
    on = limb >= 0
    members = np.bincount(limb[on], minlength=count).astype(float)
    sums = [np.bincount(limb[on], axis, count) for axis in points[on].T.astype(float)]
    return np.stack(sums, axis=1) / members[:, None], members


def _worth(middle: Floats, radius: Floats, first: Limbs, second: Limbs) -> Floats:
    """(..., k, l) what pairs of limbs are worth, the first ones' middles (..., k, 3) and radii so.

    None where either has too many of its organ's points for the other.
    """
    far = np.linalg.norm(middle[..., :, None, :] - second.middle, axis=-1)
    near = FAR - far / np.maximum(np.maximum(radius[..., :, None], second.radius), 1e-300)
    growth = (second.count / second.of)[None] / (first.count / first.of)[:, None]
    points = np.sqrt(np.minimum(first.count[:, None], second.count[None]))
    points[np.maximum(growth, 1 / growth) > ALIKE] = 0
    worth: Floats = np.maximum(near, 0) ** 2 * points
    return worth


def _second_look(way: _Way) -> tuple[Indices, float]:
    """The limbs that are the same where these show how the others have moved; their worth."""
    pairs, worth = paired(way.first, way.second)
    for _ in range(ROUNDS):
        if len(pairs) < FEWEST:
            break
        moved = replace(way.first, middle=_moved(way.first, way.second, pairs))
        closer, gained = paired(moved, way.second)
        if gained <= worth:
            break
        pairs, worth = closer, gained
    return pairs, worth


def _moved(first: Limbs, second: Limbs, pairs: Indices) -> Floats:
    """(k, 3) middles moved as those of the pairs have on the whole: an affine map, held back."""
    before, after = first.middle[pairs[:, 0]], second.middle[pairs[:, 1]]
    weight = np.sqrt(np.minimum(first.count[pairs[:, 0]], second.count[pairs[:, 1]]))
    centre, way = (np.average(v, axis=0, weights=weight) for v in (before, after - before))
    apart = before - centre
    spread = (apart.T * weight) @ apart
    stiff = STIFFNESS * np.trace(spread) / 3 * np.eye(3) + np.finfo(float).tiny * np.eye(3)
    slope = np.linalg.solve(spread + stiff, (apart.T * weight) @ (after - before - way))
    moved: Floats = first.middle + way + (first.middle - centre) @ slope
    return moved


def _swings(planted: _Way, foot: Points) -> list[_Way]:
    """The most promising of the ways in which a limb may have gone where another one is now.

    planted: foot on foot, at (3,).

    The organ turns about its foot by the smallest rotation that points the one limb where the
    other is, with or without as much growth as that takes.
    """
    before, after = planted.first.middle - foot, planted.second.middle - foot
    far, later = np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1)
    tiny = 1e-12 * (later.max() + far.max()) + np.finfo(float).tiny
    grown = later[None] / np.maximum(far, tiny)[:, None]
    cosine = (before @ after.T) / np.maximum(far[:, None] * later[None], tiny**2)
    i, j = np.nonzero((grown > 1 / GROWTH) & (grown < GROWTH) & (cosine > BACK))
    # The largest limbs are found most surely.
    size = np.minimum(planted.first.count[i], planted.second.count[j])
    largest = np.argsort(-size, kind="stable")[: TRIED // (2 * grown.size)]
    i, j = i[largest], j[largest]
    turns = rotations_between(before[i] / far[i, None], after[j] / later[j, None])
    maps = np.concatenate([turns, turns * grown[i, j, None, None]])
    scales = np.concatenate([np.ones(len(i)), grown[i, j]])
    middle = np.einsum("hxy,ky->hkx", maps, before) + foot
    worth = _worth(middle, scales[:, None] * planted.first.radius, planted.first, planted.second)
    # No choice of pairs is worth more than the best of every row, or of every column.
    most = np.minimum(worth.max(axis=1).sum(axis=1), worth.max(axis=2).sum(axis=1))
    chosen = np.argsort(-most, kind="stable")[:PROMISING]
    return [
        replace(
            planted,
            here=(planted.here - foot) @ maps[h].T + foot,
            first=replace(planted.first, middle=middle[h], radius=scales[h] * planted.first.radius),
        )
        for h in chosen
    ]
