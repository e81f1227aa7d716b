"""Which leaflets of an organ are the same in two scans.

Where a branch bears leaves, new ones appear from scan to scan. Mass spread evenly over the whole
branch would make room for them, and points would leave one leaf for the next. So leaflets that both
scans show are transported each on its own, and the stalk is registered to go with those around it.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from baker.geometry.rigid import rotations_between
from baker.segmentation.leaflets import segment_leaflets

Points = NDArray[np.floating]
Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

# docs/method.md, "Leaflets".
MAX_DISTANCE = 2.0  # of two leaflets that are the same, in radii of the larger one
MAX_RATIO = 3.0  # of their shares of the organ's points; beyond that they were cut differently
MIN_PAIRS = 3  # that an organ is divided by: a fork is too little to go by
MAX_GROWTH = 5.0  # ratio of a leaflet's distances from the attachment point
MIN_COSINE = -0.5  # of the rotations that are tried
ROTATIONS_REFINED = 6
MAX_REFINEMENTS = 3
RIDGE = 0.5  # share of the leaflets' spread that holds their affine map back from stretching
MAX_SCORES = 2_000_000  # of pairs of leaflets, in all rotations that are tried
MAJORITY = 0.5  # of an unmatched leaflet, that lies nearest to a leaflet that it is joined to
STALK_NEIGHBORS = 8  # leaflets that move a point of the stalk


@dataclass(frozen=True)
class LeafletPair:
    """A part of an organ that is transported on its own."""

    start: Indices  # (n,) and (m,) its points in the two scans, counted within the organ
    end: Indices
    registered: tuple[Points, Points] | None = None  # positions to compare; None: as they are


def match_leaflets(start: Points, end: Points, attachments: tuple[int, int]) -> list[LeafletPair]:
    """Divide an organ into the leaflets that both scans show, and the rest.

    Parameters
    ----------
    start, end : (n, 3) and (m, 3) float ndarray
        The organ in two successive scans.
    attachments : (int, int)
        Indices of the points where it is attached.

    Returns
    -------
    list of LeafletPair
        Together they have every point of either scan exactly once. Empty where an organ has no
        leaflets in one of the scans, as most; one for the whole organ where too few are the same.
    """
    sides: list[Indices] = [np.empty(0, np.intp)] * 2
    for side in sorted((0, 1), key=lambda side: len((start, end)[side])):
        sides[side] = segment_leaflets((start, end)[side], attachments[side])
        if sides[side].max() < 0:
            return []
    first, second = sides
    source, pairs = register_leaflets(start, end, attachments, first, second)
    whole = [LeafletPair(np.arange(len(start)), np.arange(len(end)), (source, end))]
    if len(pairs) < MIN_PAIRS:
        return whole
    before, after = _renumbered(first, pairs[:, 0]), _renumbered(second, pairs[:, 1])
    carried = source + _displacements(source, end, attachments, before, after, len(pairs))
    before, after = _joined(first, before, source, second, after, end)
    parts = []
    for part in range(-1, len(pairs)):
        i, j = np.flatnonzero(before == part), np.flatnonzero(after == part)
        if len(i) and len(j):
            parts.append(LeafletPair(i, j, (carried[i], end[j]) if part < 0 else None))
    used = sum(len(part.start) + len(part.end) for part in parts)
    return parts if used == len(start) + len(end) else whole


@dataclass(frozen=True)
class _Leaflets:
    """Centroids (k, 3), radii (k,), points (k,) and shares of the organ's points (k,)."""

    centroid: Floats
    radius: Floats
    count: Floats
    share: Floats

    @classmethod
    def of(cls, points: Points, leaflet: Indices) -> Self:
        centroid, count = _centroids(points, leaflet, int(leaflet.max()) + 1)
        on = leaflet >= 0
        squared = ((points[on] - centroid[leaflet[on]]) ** 2).sum(axis=1)
        radius = np.sqrt(np.bincount(leaflet[on], squared) / count)
        return cls(centroid, radius, count, count / len(points))


def register_leaflets(
    start: Points, end: Points, attachments: tuple[int, int], first: Indices, second: Indices
) -> tuple[Floats, Indices]:
    """Register an organ to its later scan by its leaflets, (n,) and (m,), -1 on the stalk.

    As it is, attachment point on attachment point, or rotated about the attachment point so that
    some leaflet comes to lie in the direction of some other, with or without as much growth as that
    takes: whichever brings most leaflets onto others. Returns the start's registered points (n, 3)
    and the leaflets that are the same, (p, 2).
    """
    source, target = _Leaflets.of(start, first), _Leaflets.of(end, second)
    origin, base = start[attachments[0]].astype(float), end[attachments[1]].astype(float)
    maps, scales = _rotations(source, target, origin, base)
    moved = np.einsum("hxy,ky->hkx", maps, source.centroid - origin) + base
    radii = scales[:, None] * source.radius
    scores = _scores(moved, radii, source, target)
    # No choice of pairs scores more than the best of every row, or of every column.
    bound = np.minimum(scores.max(axis=1).sum(axis=1), scores.max(axis=2).sum(axis=1))
    chosen = np.argsort(-bound, kind="stable")[:ROTATIONS_REFINED]
    least = max(2, min(MIN_PAIRS, len(source.count), len(target.count)))
    best_pairs, best_score = _refined(source.centroid, source.radius, source, target)
    best = start.astype(float)
    for h in (0, *chosen.tolist()):
        pairs, score = _refined(moved[h], radii[h], source, target)
        if score > best_score and (h == 0 or len(pairs) >= least):
            best_pairs, best_score = pairs, score
            best = (start - origin) @ maps[h].T + base
    return best, best_pairs


def _rotations(
    source: _Leaflets, target: _Leaflets, origin: Floats, base: Floats
) -> tuple[Floats, Floats]:
    """(H, 3, 3) maps about the attachment point, the identity first, and (H,) their scales."""
    before, after = source.centroid - origin, target.centroid - base
    far, later = np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1)
    tiny = 1e-12 * (later.max() + far.max()) + np.finfo(float).tiny
    growth = later[None] / np.maximum(far, tiny)[:, None]
    cosine = (before @ after.T) / np.maximum(far[:, None] * later[None], tiny**2)
    i, j = np.nonzero((growth > 1 / MAX_GROWTH) & (growth < MAX_GROWTH) & (cosine > MIN_COSINE))
    # The largest leaflets are found most surely.
    size = np.minimum(source.count[i], target.count[j])
    largest = np.argsort(-size, kind="stable")[: MAX_SCORES // (2 * growth.size)]
    i, j = i[largest], j[largest]
    turns = rotations_between(before[i] / far[i, None], after[j] / later[j, None])
    maps = np.concatenate([np.eye(3)[None], turns, turns * growth[i, j, None, None]])
    return maps, np.concatenate([np.ones(1 + len(i)), growth[i, j]])


def _scores(centroid: Floats, radius: Floats, source: _Leaflets, target: _Leaflets) -> Floats:
    """(..., k, l) score of each pair, the source's leaflets at (..., k, 3) with radii (..., k).

    The nearer and the larger, the higher; 0 where one was cut differently.
    """
    distance = np.linalg.norm(centroid[..., :, None, :] - target.centroid, axis=-1)
    larger = np.maximum(np.maximum(radius[..., :, None], target.radius), 1e-300)
    nearness = np.maximum(MAX_DISTANCE - distance / larger, 0)
    ratio = target.share[None] / source.share[:, None]
    points = np.sqrt(np.minimum(source.count[:, None], target.count[None]))
    points[np.maximum(ratio, 1 / ratio) > MAX_RATIO] = 0
    return np.asarray(nearness**2 * points)


def _assigned(scores: Floats) -> tuple[Indices, float]:
    """(p, 2) the pairs of the largest total score, and that score."""
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(scores, maximize=True)
    made = scores[rows, columns] > 0
    return np.stack([rows[made], columns[made]], axis=1), float(scores[rows, columns].sum())


def _refined(
    centroid: Floats, radius: Floats, source: _Leaflets, target: _Leaflets
) -> tuple[Indices, float]:
    """The best pairs, once more after the affine map of those found so far has moved the others."""
    pairs, score = _assigned(_scores(centroid, radius, source, target))
    for _ in range(MAX_REFINEMENTS):
        if len(pairs) < MIN_PAIRS:
            break
        before, after = centroid[pairs[:, 0]], target.centroid[pairs[:, 1]]
        weight = np.sqrt(np.minimum(source.count[pairs[:, 0]], target.count[pairs[:, 1]]))
        middle, shift = (np.average(v, axis=0, weights=weight) for v in (before, after - before))
        offset = before - middle
        spread = (offset.T * weight) @ offset
        ridge = (RIDGE * np.trace(spread) / 3 + np.finfo(float).tiny) * np.eye(3)
        slope = np.linalg.solve(spread + ridge, (offset.T * weight) @ (after - before - shift))
        moved = centroid + shift + (centroid - middle) @ slope
        closer, higher = _assigned(_scores(moved, radius, source, target))
        if higher <= score:
            break
        pairs, score = closer, higher
    return pairs, score


def _centroids(points: Points, leaflet: Indices, count: int) -> tuple[Floats, Floats]:
    """(count, 3) the centroids of leaflets, and (count,) how many points they have."""
    on = leaflet >= 0
    members = np.bincount(leaflet[on], minlength=count).astype(float)
    sums = [np.bincount(leaflet[on], axis, count) for axis in points[on].T.astype(float)]
    return np.stack(sums, axis=1) / members[:, None], members


def _renumbered(leaflet: Indices, chosen: Indices) -> Indices:
    """(n,) the pair of each point's leaflet, -1 of one in none and of the stalk."""
    pair = np.full(int(leaflet.max()) + 2, -1)
    pair[chosen] = np.arange(len(chosen))
    return pair[leaflet]  # -1 takes the last


def _joined(
    first: Indices, before: Indices, source: Points, second: Indices, after: Indices, target: Points
) -> tuple[Indices, Indices]:
    """The pair of each point; an unmatched leaflet joins the pair that most of it lies nearest to.

    What touches may be one leaflet in one scan and two in the other.
    """
    from scipy.spatial import KDTree

    joined = before.copy(), after.copy()
    sides = (first, before, source, after, target), (second, after, target, before, source)
    for pair, (leaflet, own, points, other, others) in zip(joined, sides, strict=True):
        nearest = other[KDTree(others).query(points)[1]]
        for unmatched in np.unique(leaflet[(own < 0) & (leaflet >= 0)]):
            members = np.flatnonzero(leaflet == unmatched)
            votes = np.bincount(nearest[members] + 1)
            votes[0] = 0
            if votes.max() >= MAJORITY * len(members):
                pair[members] = int(votes.argmax()) - 1
    return joined


def _displacements(
    source: Points,
    target: Points,
    attachments: tuple[int, int],
    first: Indices,
    second: Indices,
    pairs: int,
) -> Floats:
    """(n, 3) mean displacement of the leaflets and the attachment point around each point.

    The nearer they are, the more they weigh.
    """
    from scipy.spatial import KDTree

    places = np.concatenate([_centroids(source, first, pairs)[0], source[[attachments[0]]]])
    moved = np.concatenate([_centroids(target, second, pairs)[0], target[[attachments[1]]]])
    distance, near = KDTree(places).query(source, k=min(STALK_NEIGHBORS, len(places)))
    weight = 1.0 / np.maximum(distance, 1e-9 * (distance.max() + 1e-300))
    weight /= weight.sum(axis=1, keepdims=True)
    return np.asarray(np.einsum("nk,nkx->nx", weight, (moved - places)[near]))
