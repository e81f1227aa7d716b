"""Deform an organ's points at the start of an interval onto its points at the end.

First the organ is carried from one spine onto the other, then non-rigidly registered with the
points of the end: iterated closest points, with affine maps blended by a kernel that narrows, so
that the whole moves before its parts. Where children are attached in both scans are landmarks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.rigid import rotations_between
from baker.geometry.sampling import farthest_point_sample
from baker.interpolation.spine import Points, Spine, at_levels, levels, unit

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

MIN_NODE_DISTANCE = 0.02  # along a spine, between landmarks and from its ends
MAX_WIDENING = 3.0  # factor by which cross-sections may widen or narrow

CENTERS = 60  # of local affine maps
KERNEL_WIDTHS = 0.8, 0.5, 0.33, 0.22, 0.15  # root mean square radii of the cloud
STIFFNESS = 0.1  # of the maps against stretching, as a share of the kernel's width squared
OUTLIER_SCALE = 3.0  # median distances at which a pair of closest points counts half
LANDMARK_SHARE = 0.1  # of all points' weight, that a landmark has where the kernel is as wide as 1

Floats = NDArray[np.float64]
Landmarks = tuple[NDArray[np.intp], NDArray[np.intp]]
"""Points of the source, and those of the target where these come to lie: attached children."""
NO_LANDMARKS: Landmarks = np.empty(0, np.intp), np.empty(0, np.intp)


def spine_deformation(
    source: Points, target: Points, before: Spine, after: Spine, landmarks: Landmarks = NO_LANDMARKS
) -> Points:
    """Carry points, (n, 3), from one spine onto the other, each at its place along.

    What lies between two landmarks stays between them. Each level turns by the smallest rotation
    between its tangents, and all levels roll about these by one angle, as the landmarks do, as far
    as they lie aside of the spine and agree. target: the organ's points at the end, (m, 3).
    """
    i, j = landmarks
    ends = _common_places(before.along[i], after.along[j])
    tangents = unit(at_levels(after.tangents, np.interp(levels(), *ends)))
    centers = at_levels(after.nodes, np.interp(before.along, *ends))
    turns = rotations_between(before.tangents, tangents)
    offset = source - at_levels(before.nodes, before.along)
    across = target - at_levels(after.nodes, after.along)
    radii = [np.sqrt((x**2).sum(axis=1).mean()) for x in (offset, across)]
    width = np.clip(radii[1] / max(radii[0], 1e-30), 1 / MAX_WIDENING, MAX_WIDENING)
    turned = np.einsum("nij,nj->ni", at_levels(turns, before.along), offset)
    axes = unit(at_levels(tangents, before.along))
    around = np.cross(axes, turned)
    aside = np.cross(around, axes)
    # To landmarks as far aside as the other points, as many are added that don't roll.
    still = len(i) * radii[0] * radii[1]
    roll = np.arctan2((around[i] * across[j]).sum(), (aside[i] * across[j]).sum() + still)
    turned += (np.cos(roll) - 1.0) * aside + np.sin(roll) * around
    return centers + width * turned


def _common_places(before: Floats, after: Floats) -> tuple[list[float], list[float]]:
    """Where landmarks are along both spines, with their ends: ascending in both."""
    places = [(0.0, 0.0)]
    for place in sorted(zip(before.tolist(), after.tolist(), strict=True)):
        step = min(place[0] - places[-1][0], place[1] - places[-1][1])
        if step > MIN_NODE_DISTANCE and max(place) < 1.0 - MIN_NODE_DISTANCE:
            places.append(place)
    first, second = zip(*places, (1.0, 1.0), strict=True)
    return list(first), list(second)


def register_nonrigid(
    moving: Points, target: Points, landmarks: Landmarks = NO_LANDMARKS
) -> Points:
    """(n, 3) where points come to lie that are registered non-rigidly with a target, (m, 3).

    In every iteration each point is paired with the closest one on the other side, both ways, and
    landmarks with theirs. Around each of some centres an affine map is fitted to the pairs' shifts
    by weighted least squares, and the maps are blended. The kernel that weighs narrows from
    iteration to iteration.
    """
    from scipy.spatial import cKDTree
    from scipy.spatial.distance import cdist

    middle = moving.mean(axis=0)
    size = float(np.sqrt(((moving - middle) ** 2).sum(axis=1).mean())) or 1.0
    source, target = (moving - middle) / size, (target - middle) / size
    i, j = landmarks
    tree = cKDTree(target)
    centers = farthest_point_sample(source, CENTERS, first=0)
    squared = cdist(source[centers], source, "sqeuclidean")
    homogeneous = np.c_[source, np.ones(len(source))]
    products = (homogeneous[:, :, None] * homogeneous[:, None]).reshape(-1, 16)
    deformed = source
    for width in KERNEL_WIDTHS:
        weights = np.exp(-0.5 * squared / width**2) + 1e-12
        blend = weights / weights.sum(axis=0)
        ridge = STIFFNESS * width**2 * np.diag([1.0, 1.0, 1.0, 0.0])
        trust, shift = _closest_pairs(source, target, deformed, tree)
        weight = LANDMARK_SHARE * width * len(source)
        np.add.at(trust, i, weight)
        np.add.at(shift, i, weight * (target[j] - source[i]))
        sums = (weights @ (trust[:, None] * products)).reshape(-1, 4, 4)
        moments = (homogeneous[:, :, None] * shift[:, None]).reshape(-1, 12)
        targets = (weights @ moments).reshape(-1, 4, 3)
        maps = np.linalg.solve(sums + ridge * sums[:, 3:, 3:], targets)
        local = (blend.T @ maps.reshape(-1, 12)).reshape(-1, 4, 3)
        deformed = source + np.einsum("ni,nij->nj", homogeneous, local)
    return deformed * size + middle


def _closest_pairs(
    source: Points, target: Points, deformed: Points, tree: cKDTree
) -> tuple[NDArray[np.float64], Points]:
    """(n,) how much the pairs of each point count, and (n, 3) the weighted sum of their shifts.

    Shifts are from where points are at the source.
    """
    from scipy.spatial import cKDTree

    ahead, partners = tree.query(deformed)
    back, points = cKDTree(deformed, balanced_tree=False).query(target)
    distance = np.concatenate([ahead, back])
    first = np.concatenate([np.arange(len(source)), points])
    second = np.concatenate([partners, np.arange(len(target))])
    scale = OUTLIER_SCALE * float(np.median(distance)) or 1.0
    trust = 1.0 / (1.0 + (distance / scale) ** 2)
    pull = trust[:, None] * (target[second] - source[first])
    count = len(source)
    sums = [np.bincount(first, values, count) for values in (trust, *pull.T)]
    found = np.stack(sums, axis=1).astype(np.float64)
    return found[:, 0], found[:, 1:]
