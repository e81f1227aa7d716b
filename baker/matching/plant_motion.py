"""Estimate how a plant as a whole has moved from one scan to another: rotated about its base.

A soft stem may lean to another side in every scan, with all organs on it. An organ is then far from
its former position, and often near the former position of another organ. But all organs rotate
together, so the directions of two of them determine the rotation.
"""

from collections.abc import Iterable, Sequence
from itertools import combinations, count, permutations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import best_path
from baker.matching.descriptors import OrganDescriptors
from baker.matching.score import best_pairs, match_rewards, match_scores, shape_penalties

Floats = NDArray[np.float64]

# docs/method.md, "Tracking organs". Penalties are subtracted from the score of each organ: that of
# any rotation, and ANGLE_WEIGHT / (ANGLE_OFFSET + mean angle in other intervals) for each radian.
ROTATION_PENALTY, ANGLE_WEIGHT, ANGLE_OFFSET = 0.05, 0.1, 0.25
FIRST_MEAN_ANGLE = 0.15  # in radians, of the first round; later the angle of one more interval
ROUNDS = 2  # number of times that rotations are chosen, with the mean angles of those before
ANGLE_PENALTY = 0.1  # per radian, to choose candidates: that of a plant that is rotated a lot
INDIRECT_WEIGHT = 0.4  # of the score of scans two apart
ORGANS_IN_PAIRS = 7  # number of the largest organs, of which each pair determines a rotation
MIN_SINE, MAX_ANGLE_CHANGE = 0.25, 0.5  # of a pair's angle; of its change, in radians
MAX_MATCHED, MAX_CANDIDATES = 16, 6  # rotations for which organs are matched; best ones of these
MIN_DIFFERENCE = 0.2  # between these rotations, in radians


def plant_motions(organs: Sequence[OrganDescriptors]) -> list[Floats]:
    """(4, 4) rigid motions of a plant from each scan to the next one.

    Candidates are no motion, and motions that register the plant bases and the directions from
    there to two organs. Those with the largest total score of matched organs are chosen, with that
    of scans two apart, which two motions in turn register, at a lower weight. Rotations are
    penalised, since a plant may look alike from several sides, but less where it rotates often in
    other intervals: a wrong rotation does not make itself likely.
    """
    organs = [scan.largest() for scan in organs]
    steps = list(map(candidate_motions, organs, organs[1:]))
    if not steps:
        return []

    def indirect_scores(first: OrganDescriptors, third: OrganDescriptors, k: int) -> Floats:
        (before, _), (after, _) = steps[k - 1], steps[k]  # motions before and after scan k
        scores = [[_score(first.transformed(b @ a), third) for b in after] for a in before]
        return INDIRECT_WEIGHT * np.array(scores)

    indirect = [np.zeros((1, 1)), *map(indirect_scores, organs, organs[2:], count(1))]
    mean_angles = np.full(len(steps), FIRST_MEAN_ANGLE)
    for _ in range(ROUNDS):
        weighted_steps = zip(steps, ANGLE_WEIGHT / (ANGLE_OFFSET + mean_angles), strict=True)
        direct = [scores - w * rotation_angles(motions) for (motions, scores), w in weighted_steps]
        _, *path = best_path([pairs + own for pairs, own in zip(indirect, direct, strict=True)])
        chosen = np.array([motions[k] for (motions, _), k in zip(steps, path, strict=True)])
        angles = rotation_angles(chosen)
        mean_angles = (FIRST_MEAN_ANGLE + angles.sum() - angles) / len(angles)
    return [*chosen]


def candidate_motions(first: OrganDescriptors, second: OrganDescriptors) -> tuple[Floats, Floats]:
    """No motion and other likely ones, (n, 4, 4), and (n,) scores without the angles' penalties."""
    rotations = np.reshape(_candidate_rotations(first, second), (-1, 3, 3))
    motions = np.tile(np.eye(4), (1 + len(rotations), 1, 1))
    motions[1:, :3, :3], motions[1:, :3, 3] = rotations, second.base - rotations @ first.base
    scores = np.array([_score(first.transformed(m), second, neighbors=True) for m in motions])
    scores[1:] -= ROTATION_PENALTY
    rank = ANGLE_PENALTY * rotation_angles(motions) - scores
    best = [0, *(1 + np.argsort(rank[1:], kind="stable")[:MAX_CANDIDATES])]
    return motions[best], scores[best]


def rotation_angles(motions: Floats) -> Floats:
    """(n,) angles of (n, 3, 3) rotations or (n, 4, 4) motions, in radians."""
    cosine = (np.trace(motions[:, :3, :3], axis1=1, axis2=2) - 1.0) / 2.0
    return np.arccos(np.clip(cosine, -1.0, 1.0))


def _score(first: OrganDescriptors, second: OrganDescriptors, neighbors: bool = False) -> float:
    """The score of the best matching, for each organ of the scan with fewer.

    neighbors: whether organs may be moved like their neighbours, if that scores better.
    """
    pairs, total = best_pairs(match_scores(first, second))
    if neighbors:
        total = max(total, best_pairs(match_scores(first, second, pairs))[1])
    return total / min(len(first), len(second))


def _candidate_rotations(first: OrganDescriptors, second: OrganDescriptors) -> list[Floats]:
    """(3, 3) rotations by which the organs, sorted by size, come nearest to those of the second."""
    sides = first, second
    offsets = [np.array([s.mean(axis=0) for s in side.samples]) - side.base for side in sides]
    largest = [range(len(side))[:ORGANS_IN_PAIRS] for side in sides]
    source, angle = _frames(offsets[0], combinations(largest[0], 2))
    target, target_angle = _frames(offsets[1], permutations(largest[1], 2))
    i, j = np.nonzero(np.abs(angle[:, None] - target_angle) < MAX_ANGLE_CHANGE)
    rotations = target[j] @ source[i].transpose(0, 2, 1)
    # Both plants are compared in the geometric mean of their sizes.
    sizes = [float(np.sqrt((offset**2).sum(axis=1).mean())) for offset in offsets]
    growth = np.sqrt(sizes[1] / sizes[0]) if min(sizes) > 0.0 else 1.0
    moved = np.einsum("hxy,ky->hkx", rotations, offsets[0] * growth)
    distance = np.linalg.norm(moved[:, :, None] - offsets[1] / growth, axis=-1)
    cosines = np.einsum("hxy,ky,lx->hkl", rotations, first.directions, second.directions)
    # For rotation h and organs k and l: cosines[h, k, l] = rotations[h] @ first[k] @ second[l].
    penalties = shape_penalties(first, second, distance, cosines)
    scores = np.maximum(match_rewards(first, second) - penalties, 0.0)
    # An upper bound of the mean score of any matching: the maxima of rows, or those of columns.
    bound = np.minimum(scores.max(axis=2).sum(axis=1), scores.max(axis=1).sum(axis=1))
    bound = bound / min(map(len, sides)) - ANGLE_PENALTY * rotation_angles(rotations)
    chosen: list[Floats] = []
    for rotation in rotations[np.argsort(-bound, kind="stable")]:
        cosine = [(np.sum(rotation * previous) - 1.0) / 2.0 for previous in chosen]
        if max(cosine, default=-1.0) < np.cos(MIN_DIFFERENCE):
            chosen.append(rotation)
        if len(chosen) == MAX_MATCHED:
            break
    return chosen


def _frames(offsets: Floats, pairs: Iterable[tuple[int, int]]) -> tuple[Floats, Floats]:
    """(p, 3, 3) frames of the directions of pairs of (n, 3) offsets, as columns, and (p,) angles.

    The first axis bisects the angle, the second one points to the second offset. Pairs in nearly
    the same or in opposite directions are left out.
    """
    length = np.linalg.norm(offsets, axis=1, keepdims=True)
    directions = offsets / np.maximum(length, np.finfo(float).tiny)
    first, second = directions[np.array([*pairs], np.intp).reshape(-1, 2)].transpose(1, 0, 2)
    middle, normal = first + second, np.cross(first, second)
    sine = np.linalg.norm(normal, axis=1)
    angle = np.arctan2(sine, (first * second).sum(axis=1))
    is_oblique = sine > MIN_SINE
    middle, normal = middle[is_oblique], normal[is_oblique] / sine[is_oblique, None]
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    return np.stack([middle, np.cross(normal, middle), normal], axis=2), angle[is_oblique]
