"""Scans set upright on their stem's base, and how one is turned onto another."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import NEIGHBORS_ON_SURFACE, EvenSample, distance_graph, touching_pairs
from baker.alignment.stem_base import base_candidates
from baker.alignment.up_axis_search import upright
from baker.geometry.merge_tree import branches
from baker.geometry.up_axis import Vertical

STEM_HEIGHT = 0.1  # of the lower plant's height: the lowest part of both stems is compared
KERNEL_WIDTHS = (0.03, 0.02)  # of that height: distances of points that belong together
MIN_MEAN_WEIGHT = 0.1  # of the stem's points: below it the stems are too far apart to tell
ITERATIONS = 4
MIN_PERSISTENCE = 0.1  # of the longest geodesic distance: shorter tips are no organs of their own
MIN_POINTS_OF_ORGAN = 4
AXIS = -1


class Organs(NamedTuple):
    """What stands out of a plant, in coordinates with z up and the stem's base at the origin.

    Points turn, bend and multiply as an organ grows; the direction in which the organ as a whole
    points from the stem is steadier. No labels are needed, and no exact borders.
    """

    numbers: NDArray[np.intp]  # (n,) organ of each sampled point; `AXIS` on what bears the organs
    centers: NDArray[np.float64]  # (k, 3) middles of the organs that have four points or more


class Pose(NamedTuple):
    """A scan set upright with its stem's base at the origin."""

    frame: NDArray[np.float64]  # (4, 4) from the scan's coordinates to these
    sample: EvenSample  # in these
    organs: Organs  # of the sample

    @property
    def base(self) -> NDArray[np.float64]:
        """(3,) in the scan's own coordinates."""
        return np.asarray(np.linalg.inv(self.frame)[:3, 3])

    @property
    def height(self) -> float:
        return float(np.ptp(self.sample.points[:, 2]))


def candidate_poses(
    sample: EvenSample, vertical: Vertical, root: NDArray[np.floating] | None = None
) -> list[Pose]:
    """The scan of which `sample` was taken, on each base it may have, or on its (3,) root."""
    pairs = touching_pairs(sample, NEIGHBORS_ON_SURFACE)
    bases = base_candidates(sample, vertical, pairs) if root is None else [np.asarray(root, float)]
    return [_pose_at(sample, vertical, base, pairs) for base in bases]


def transform_onto(earlier: Pose, later: Pose, yaw: float) -> NDArray[np.float64]:
    """(4, 4) from the later scan's coordinates to the earlier's: turned by `yaw`, base on base."""
    transform = about_z(yaw)
    transform[:2, 3] = _stem_shift(earlier, later, transform)
    return np.linalg.inv(earlier.frame) @ transform @ later.frame


def about_z(yaw: float) -> NDArray[np.float64]:
    """(4, 4) rotation by degrees about +z, right-handed."""
    from scipy.spatial.transform import Rotation

    turn = np.eye(4)
    turn[:3, :3] = Rotation.from_euler("z", yaw, degrees=True).as_matrix()
    return turn


def _stem_shift(earlier: Pose, later: Pose, transform: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2,) how much further the later scan's stem has to be moved, level, to cover the earlier's.

    A base is the middle of a few points at the ground. The stem just above it hardly changes: its
    points are moved onto their nearest ones, by Gaussian weights of their distances, so that those
    of leaves that hang there, far from any partner, don't pull.
    """
    from scipy.spatial import KDTree

    height = min(earlier.height, later.height)
    source, target = (pose.sample.pool for pose in (later, earlier))
    source, target = (p[p[:, 2] <= STEM_HEIGHT * height] for p in (source, target))
    shift = np.zeros(3)
    if height == 0.0 or not len(source) or not len(target):
        return shift[:2]
    source = source @ transform[:3, :3].T
    tree = KDTree(source)
    for width in KERNEL_WIDTHS:
        for _ in range(ITERATIONS):
            distances, nearest = tree.query(target - shift)
            weights = np.exp(-0.5 * (distances / (width * height)) ** 2)
            if weights.mean() < MIN_MEAN_WEIGHT:
                return np.zeros(2)
            offsets = target - shift - source[nearest]
            shift[:2] += (weights[:, None] * offsets[:, :2]).sum(axis=0) / weights.sum()
    return shift[:2]


def _pose_at(
    sample: EvenSample, vertical: Vertical, base: NDArray[np.float64], pairs: NDArray[np.intp]
) -> Pose:
    turn = upright(vertical)
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = turn, -turn @ base
    moved = EvenSample((sample.pool - base) @ turn.T, (sample.points - base) @ turn.T, sample.radii)
    return Pose(frame, moved, _find_organs(moved, pairs))


def _find_organs(sample: EvenSample, pairs: NDArray[np.intp]) -> Organs:
    """Branches of the merge tree of the geodesic distance from the base."""
    from scipy.sparse.csgraph import dijkstra

    points = sample.points
    if len(points) < 2:
        return Organs(np.full(len(points), AXIS), np.zeros((0, 3)))
    graph = distance_graph(points, pairs)
    distance = dijkstra(graph, indices=int(np.argmin((points**2).sum(axis=1))))
    numbers = branches(distance, graph, MIN_PERSISTENCE * float(distance.max()))
    if numbers.max() < 0:
        numbers[:] = 0  # a single organ, which meets no other one
    members = (np.flatnonzero(numbers == number) for number in range(numbers.max() + 1))
    centers = [points[of].mean(axis=0) for of in members if len(of) >= MIN_POINTS_OF_ORGAN]
    return Organs(numbers, np.array(centers).reshape(-1, 3))
