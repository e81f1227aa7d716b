"""Match the leaflets of an organ in two scans.

A branch may get new leaves from scan to scan. With uniform mass over the whole branch, points of
old leaves would be transported to new ones. So leaflets that exist in both scans are transported
separately, and the stalk is registered with the leaflets around it.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Points, interpolate
from baker.geometry.rigid import rotations_between
from baker.matching.score import best_pairs
from baker.segmentation.leaflets import segment_leaflets

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

# docs/method.md, "Leaflets".
MAX_DISTANCE = 2.0  # between matched leaflets after registration, in radii of the larger one
MAX_RATIO = 3.0  # of the shares of the organ's points that matched leaflets have
MIN_PAIRS = 3  # of matched leaflets; with fewer, the organ is transported as a whole
MAX_GROWTH = 5.0  # ratio of a leaflet's distances from the attachment point
MIN_COSINE = -0.5  # of the angle of candidate rotations
ROTATIONS_REFINED = 6  # number of candidate rotations whose pairs are refined by an affine map
MAX_REFINEMENTS = 3  # number of affine maps that are fitted in turn
RIDGE = 0.5  # regularisation of the affine map, as a share of the leaflets' variance
MAX_SCORES = 2_000_000  # of pairs of leaflets, for all candidate rotations
MAJORITY = 0.5  # share of the points of an unmatched leaflet that decides which pair it joins
STALK_NEIGHBORS = 8  # number of leaflets from which the displacement of the stalk is interpolated


@dataclass(frozen=True)
class LeafletPair:
    """A part of an organ that is transported separately."""

    start: Indices  # (n,) indices of its points in the first scan, within the organ
    end: Indices  # (m,) likewise in the second scan
    registered: tuple[Points, Points] | None = None  # positions from which costs are computed


def match_leaflets(start: Points, end: Points, attachments: tuple[int, int]) -> list[LeafletPair]:
    """Divide an organ into its stalk, which comes first, and pairs of matched leaflets.

    start, end: (n, 3) and (m, 3), the organ in two successive scans. attachments: indices of the
    attachment points. Returns a partition of the points of both scans; it is empty if the organ has
    no leaflets in one of the scans, or too few of them match.
    """
    first = segment_leaflets(start, attachments[0])
    second = segment_leaflets(end, attachments[1]) if first.max() >= 0 else first
    if second.max() < 0:
        return []
    source, pairs = register_leaflets(start, end, attachments, first, second)
    if len(pairs) < MIN_PAIRS:
        return []
    start_pair, end_pair = _pair_of(first, pairs[:, 0]), _pair_of(second, pairs[:, 1])
    moved = source + _displacements(source, end, attachments, start_pair, end_pair)
    start_pair, end_pair = (
        _with_unmatched(first, start_pair, source, end_pair, end),
        _with_unmatched(second, end_pair, end, start_pair, source),
    )
    parts = []
    for part in range(-1, len(pairs)):
        i, j = np.flatnonzero(start_pair == part), np.flatnonzero(end_pair == part)
        if len(i) and len(j):
            parts.append(LeafletPair(i, j, (moved[i], end[j]) if part < 0 else None))
    used = sum(len(part.start) + len(part.end) for part in parts)
    return parts if used == len(start) + len(end) else []


@dataclass(frozen=True)
class _Leaflets:
    """The k leaflets of an organ in one scan."""

    centroid: Floats  # (k, 3)
    radius: Floats  # (k,) root mean square distance of the points from the centroid
    count: Floats  # (k,) number of points
    share: Floats  # (k,) of the organ's points

    @classmethod
    def of(cls, points: Points, leaflet: Indices) -> Self:
        """Measure the leaflets of (n, 3) points, with the (n,) leaflet of each one."""
        parts = [points[leaflet == k].astype(float) for k in range(int(leaflet.max()) + 1)]
        centroid = np.array([part.mean(axis=0) for part in parts])
        radius = np.array([np.sqrt(part.var(axis=0).sum()) for part in parts])
        count = np.array([float(len(part)) for part in parts])
        return cls(centroid, radius, count, count / len(points))


def register_leaflets(
    start: Points, end: Points, attachments: tuple[int, int], first: Indices, second: Indices
) -> tuple[Floats, Indices]:
    """Register an organ with its points in the next scan by its leaflets.

    The candidates are: no motion; a translation of the attachment point; and rotations about it
    that align the direction of one leaflet with that of another, with or without scaling. Of those
    with at least `MIN_PAIRS` pairs of leaflets, the one with the largest total score is chosen.

    first, second: (n,) and (m,) the leaflet of each point, -1 on the stalk. Returns the registered
    points of `start` and the (p, 2) matched leaflets.
    """
    source, target = _Leaflets.of(start, first), _Leaflets.of(end, second)
    origin, base = start[attachments[0]].astype(float), end[attachments[1]].astype(float)
    maps, scales = _rotations(source, target, origin, base)
    shifts = base - maps @ origin
    shifts[0] = 0.0  # no motion
    moved = np.einsum("hxy,ky->hkx", maps, source.centroid) + shifts[:, None]
    radii = scales[:, None] * source.radius
    scores = _scores(moved, radii, source, target)
    # An upper bound of the score of any assignment: the sum of the maxima of rows, or of columns.
    bound = np.minimum(scores.max(axis=1).sum(axis=1), scores.max(axis=2).sum(axis=1))
    best, chosen, best_score = start.astype(float), np.empty((0, 2), np.intp), 0.0
    for h in (0, 1, *np.argsort(-bound, kind="stable")[:ROTATIONS_REFINED].tolist()):
        pairs, score = _refine_pairs(moved[h], radii[h], source, target)
        if score > best_score and len(pairs) >= MIN_PAIRS:
            best, chosen, best_score = start @ maps[h].T + shifts[h], pairs, score
    return best, chosen


def _rotations(
    source: _Leaflets, target: _Leaflets, origin: Floats, base: Floats
) -> tuple[Floats, Floats]:
    """(H, 3, 3) candidate maps, the identity first, twice, and their (H,) scales."""
    start, end = source.centroid - origin, target.centroid - base
    start_length, end_length = np.linalg.norm(start, axis=1), np.linalg.norm(end, axis=1)
    tiny = 1e-12 * (end_length.max() + start_length.max()) + np.finfo(float).tiny
    growth = end_length[None] / np.maximum(start_length, tiny)[:, None]
    cosine = (start @ end.T) / np.maximum(start_length[:, None] * end_length[None], tiny**2)
    i, j = np.nonzero((growth > 1 / MAX_GROWTH) & (growth < MAX_GROWTH) & (cosine > MIN_COSINE))
    # Large leaflets are segmented more reliably.
    size = np.minimum(source.count[i], target.count[j])
    largest = np.argsort(-size, kind="stable")[: MAX_SCORES // (2 * growth.size)]
    i, j = i[largest], j[largest]
    rotations = rotations_between(start[i] / start_length[i, None], end[j] / end_length[j, None])
    scales = np.concatenate([np.ones(2 + len(i)), growth[i, j]])
    maps = np.concatenate([np.eye(3)[None], np.eye(3)[None], rotations, rotations])
    return maps * scales[:, None, None], scales


def _scores(centroid: Floats, radius: Floats, source: _Leaflets, target: _Leaflets) -> Floats:
    """(..., k, l) score of each pair, higher for near and large leaflets, 0 for unequal ones.

    centroid, radius: (..., k, 3) and (..., k), of the source's leaflets after registration.
    """
    distance = np.linalg.norm(centroid[..., :, None, :] - target.centroid, axis=-1)
    larger = np.maximum(np.maximum(radius[..., :, None], target.radius), 1e-300)
    nearness = np.maximum(MAX_DISTANCE - distance / larger, 0)
    ratio = target.share[None] / source.share[:, None]
    points = np.sqrt(np.minimum(source.count[:, None], target.count[None]))
    points[np.maximum(ratio, 1 / ratio) > MAX_RATIO] = 0
    return np.asarray(nearness**2 * points)


def _refine_pairs(
    centroid: Floats, radius: Floats, source: _Leaflets, target: _Leaflets
) -> tuple[Indices, float]:
    """The best pairs and their score, refined by fitting an affine map to the pairs so far."""
    pairs, score = best_pairs(_scores(centroid, radius, source, target))
    for _ in range(MAX_REFINEMENTS):
        if len(pairs) < MIN_PAIRS:
            break
        start, end = centroid[pairs[:, 0]], target.centroid[pairs[:, 1]]
        weight = np.sqrt(np.minimum(source.count[pairs[:, 0]], target.count[pairs[:, 1]]))
        center, shift = (np.average(v, axis=0, weights=weight) for v in (start, end - start))
        offset = start - center
        spread = (offset.T * weight) @ offset
        ridge = (RIDGE * np.trace(spread) / 3 + np.finfo(float).tiny) * np.eye(3)
        slope = np.linalg.solve(spread + ridge, (offset.T * weight) @ (end - start - shift))
        moved = centroid + shift + (centroid - center) @ slope
        new_pairs, new_score = best_pairs(_scores(moved, radius, source, target))
        if new_score <= score:
            break
        pairs, score = new_pairs, new_score
    return pairs, score


def _pair_of(leaflet: Indices, matched: Indices) -> Indices:
    """(n,) index of the pair of each point's leaflet, -1 if it is unmatched or the stalk."""
    pair = np.full(int(leaflet.max()) + 2, -1)
    pair[matched] = np.arange(len(matched))
    return pair[leaflet]  # the leaflet -1 indexes the last element


def _with_unmatched(
    leaflet: Indices, pair: Indices, points: Points, other_pair: Indices, other_points: Points
) -> Indices:
    """Join each unmatched leaflet to the pair that most of its points are nearest to.

    Leaflets that touch may be segmented as one leaflet in one scan and as two in the other.
    """
    from scipy.spatial import cKDTree

    joined, unmatched = pair.copy(), np.flatnonzero((pair < 0) & (leaflet >= 0))
    nearest = other_pair[cKDTree(other_points).query(points[unmatched])[1]]
    for part in np.unique(leaflet[unmatched]):
        is_member = leaflet[unmatched] == part
        votes = np.bincount(nearest[is_member] + 1, minlength=2)[1:]
        if votes.max() >= MAJORITY * is_member.sum():
            joined[unmatched[is_member]] = votes.argmax()
    return joined


def _displacements(
    source: Points, target: Points, attachments: tuple[int, int], first: Indices, second: Indices
) -> Floats:
    """(n, 3) displacement of each point, interpolated from those of the leaflets around it.

    The attachment point is included; weights are inverse distances. first, second: the pair of
    leaflets of each point, -1 if it is in none.
    """
    nodes = np.concatenate([_Leaflets.of(source, first).centroid, source[[attachments[0]]]])
    moved = np.concatenate([_Leaflets.of(target, second).centroid, target[[attachments[1]]]])
    return interpolate(source, nodes, moved - nodes, STALK_NEIGHBORS)
