"""Deform the points of an organ in one scan onto its points in the next scan.

The organ is first moved from one spine to the other. Then it is registered non-rigidly by iterated
closest points with blended affine maps, whose kernel narrows from iteration to iteration. The
attachment points of children in both scans are landmarks.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.sampling import farthest_point_sample
from baker.interpolation.roll import elongations, roll, spine_frames
from baker.interpolation.spine import NODE_POSITIONS, Points, Spine, interpolate_nodes, unit

# docs/method.md, "Motion of organs".
MAX_OFFSET = 1.5  # of a landmark from the spine, in median offsets of the organ's points
MIN_NODE_DISTANCE = 0.02  # between landmarks along a spine, as a share of its length
MAX_WIDENING = 3.0  # greatest factor by which cross-sections widen or narrow
CENTERS = 60  # number of local affine maps
KERNEL_WIDTHS = 0.8, 0.5, 0.33, 0.22, 0.15  # in root mean square radii of the organ
STIFFNESS = 0.1  # regularisation of the maps, in squared widths of the kernel
OUTLIER_SCALE = 3.0  # distance, in median distances, at which a pair has half the weight
LANDMARK_SHARE = 0.1  # weight of a landmark, as a share of all points, for a kernel of width 1

Floats = NDArray[np.float64]
Landmarks = tuple[NDArray[np.intp], NDArray[np.intp]]
"""Indices of points of the source, and of the points of the target that they correspond to."""
NO_POINTS = np.empty((0, 3))
NO_LANDMARKS: Landmarks = np.empty(0, np.intp), np.empty(0, np.intp)


def spine_deformation(
    source: Points, target: Points, before: Spine, after: Spine, landmarks: Landmarks = NO_LANDMARKS
) -> Points:
    """Move the (n, 3) points of an organ from one spine to the other, with their offsets from it.

    The order of points, and of landmarks near the spine, is kept along it. The offsets are scaled
    like the radius of the (m, 3) target, and rotated from the frames of one spine to those of the
    other. An organ that others grow on, such as a stem, does not roll about its spine.
    """
    offsets = source - interpolate_nodes(before.nodes, before.along)
    target_offsets = target - interpolate_nodes(after.nodes, after.along)
    distances = [np.linalg.norm(side, axis=1) for side in (offsets, target_offsets)]
    # Children at the ends of petioles are beside the spine, whose length they say nothing about.
    is_near = [d[k] <= MAX_OFFSET * np.median(d) for d, k in zip(distances, landmarks, strict=True)]
    i, j = (side[is_near[0] & is_near[1]] for side in landmarks)
    knots = _landmark_levels(before.along[i], after.along[j])
    levels = np.interp(NODE_POSITIONS, *knots)
    centers = interpolate_nodes(after.nodes, np.interp(before.along, *knots))
    tangents = unit(interpolate_nodes(after.tangents, levels))
    frames, end_frames = spine_frames(before.tangents, tangents)
    if not len(landmarks[0]):
        first = elongations(frames, NODE_POSITIONS, offsets, before.along)
        end_frames @= roll(first, elongations(end_frames, levels, target_offsets, after.along))
    rotations = interpolate_nodes(end_frames @ frames.transpose(0, 2, 1), before.along)
    radii = [np.sqrt((distance**2).mean()) for distance in distances]
    width = np.clip(radii[1] / max(radii[0], 1e-30), 1 / MAX_WIDENING, MAX_WIDENING)
    return centers + width * np.einsum("nij,nj->ni", rotations, offsets)


def _landmark_levels(before: Floats, after: Floats) -> tuple[list[float], list[float]]:
    """Positions along both spines, (n,) each, of the landmarks in the same order, and of the ends.

    A landmark is left out if it is too near to the one before it, or to an end, in either scan.
    """
    knots = [(0.0, 0.0)]
    for knot in sorted(zip(before.tolist(), after.tolist(), strict=True)):
        step = min(knot[0] - knots[-1][0], knot[1] - knots[-1][1])
        if step > MIN_NODE_DISTANCE and max(knot) < 1.0 - MIN_NODE_DISTANCE:
            knots.append(knot)
    first, second = zip(*knots, (1.0, 1.0), strict=True)
    return list(first), list(second)


def register_nonrigid(
    moving: Points,
    target: Points,
    landmarks: Landmarks = NO_LANDMARKS,
    optional: Points = NO_POINTS,
) -> Points:
    """Register (n, 3) points non-rigidly with an (m, 3) target by iterated closest points.

    In every iteration, each point of both clouds is paired with the closest point of the other, and
    each landmark with its target. Around `CENTERS` points, affine maps are fitted to the
    displacements of the pairs by weighted least squares, and the maps are blended.

    optional: (k, 3) more points of the target, which are not paired unless they are the closest.
    """
    from scipy.spatial import cKDTree
    from scipy.spatial.distance import cdist

    center = moving.mean(axis=0)
    size = float(np.sqrt(((moving - center) ** 2).sum(axis=1).mean())) or 1.0
    source, target = (moving - center) / size, (np.concatenate([target, optional]) - center) / size
    i, j = landmarks
    tree, count = cKDTree(target), len(target) - len(optional)
    centers = farthest_point_sample(source, CENTERS, first=0)
    squared = cdist(source[centers], source, "sqeuclidean")
    homogeneous = np.c_[source, np.ones(len(source))]
    products = (homogeneous[:, :, None] * homogeneous[:, None]).reshape(-1, 16)
    deformed = source
    for width in KERNEL_WIDTHS:
        weights = np.exp(-0.5 * squared / width**2) + 1e-12
        blend = weights / weights.sum(axis=0)
        ridge = STIFFNESS * width**2 * np.diag([1.0, 1.0, 1.0, 0.0])
        trust, shift = _closest_pairs(source, target, deformed, tree, count)
        weight = LANDMARK_SHARE * width * len(source)
        np.add.at(trust, i, weight)
        np.add.at(shift, i, weight * (target[j] - source[i]))
        sums = (weights @ (trust[:, None] * products)).reshape(-1, 4, 4)
        moments = (homogeneous[:, :, None] * shift[:, None]).reshape(-1, 12)
        targets = (weights @ moments).reshape(-1, 4, 3)
        # The normal equations of all maps, (CENTERS, 4, 3); then the blended map of each point.
        maps = np.linalg.solve(sums + ridge * sums[:, 3:, 3:], targets)
        local = (blend.T @ maps.reshape(-1, 12)).reshape(-1, 4, 3)
        deformed = source + np.einsum("ni,nij->nj", homogeneous, local)
    return deformed * size + center


def _closest_pairs(
    source: Points, target: Points, deformed: Points, tree: Any, count: int
) -> tuple[NDArray[np.float64], Points]:
    """The (n,) total weight of the pairs of each point, and the (n, 3) sum of their displacements.

    Pairs are found from the deformed points, displacements are measured from the source.
    tree: the KD-tree of the target. count: number of points of the target that are all paired.
    """
    from scipy.spatial import cKDTree

    to_target, partners = tree.query(deformed)
    to_deformed, points = cKDTree(deformed, balanced_tree=False).query(target[:count])
    distance = np.concatenate([to_target, to_deformed])
    first = np.concatenate([np.arange(len(source)), points])
    second = np.concatenate([partners, np.arange(count)])
    scale = OUTLIER_SCALE * float(np.median(distance)) or 1.0
    weight = 1.0 / (1.0 + (distance / scale) ** 2)
    displacement = weight[:, None] * (target[second] - source[first])
    sums = [np.bincount(first, values, len(source)) for values in (weight, *displacement.T)]
    return sums[0].astype(np.float64), np.stack(sums[1:], axis=1, dtype=np.float64)
