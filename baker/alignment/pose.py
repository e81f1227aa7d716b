"""Scans set upright on their stem's base, and how one is turned onto another."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.alignment.up_axis_search import upright
from baker.geometry.graph import branches
from baker.geometry.up_axis import Vertical

STEM_HEIGHT = 0.1  # of the lower plant's height: the lowest part of both stems is compared
KERNEL_WIDTHS = (0.03, 0.02)  # of that height: distances of points that belong together
MIN_MEAN_WEIGHT = 0.1  # of the stem's points: below it the stems are too far apart to tell
ITERATIONS = 4
MIN_PERSISTENCE = 0.1  # of the longest geodesic distance: shorter tips are no organs of their own
MIN_POINTS_OF_ORGAN = 4


class Pose(NamedTuple):
    """A scan set upright with its stem's base at the origin.

    Points turn, bend and multiply as an organ grows; the direction in which the organ as a whole
    points from the stem is steadier.
    """

    frame: NDArray[np.float64]  # (4, 4) from the scan's coordinates to these
    pool: NDArray[np.float64]  # (M, 3) points in these
    height: float
    centers: NDArray[np.float64]  # (k, 3) middles of the organs
    names: NDArray[np.int64]  # (k,) labels of the organs; numbers that mean nothing where found

    @property
    def base(self) -> NDArray[np.float64]:
        """(3,) in the scan's own coordinates."""
        return np.asarray(np.linalg.inv(self.frame)[:3, 3])


def pose_at(
    sample: EvenSample, vertical: Vertical, base: NDArray[np.float64], stem: int | None
) -> Pose:
    """The scan of which `sample` was taken, on its (3,) base; stem: the label of its stem."""
    turn = upright(vertical)
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = turn, -turn @ base
    points = (sample.points - base) @ turn.T
    organ = _found_organs(sample, points) if stem is None else sample.labels
    names, counts = np.unique(organ[organ != (-1 if stem is None else stem)], return_counts=True)
    names = names[counts >= MIN_POINTS_OF_ORGAN]
    centers = np.array([points[organ == name].mean(axis=0) for name in names]).reshape(-1, 3)
    pool = (sample.pool - base) @ turn.T
    return Pose(frame, pool, float(np.ptp(points[:, 2])), centers, names)


def transform_onto(earlier: Pose, later: Pose, yaw: float) -> NDArray[np.float64]:
    """(4, 4) from the later scan's coordinates to the earlier's: turned by `yaw` degrees."""
    from scipy.spatial.transform import Rotation

    transform = np.eye(4)
    transform[:3, :3] = Rotation.from_euler("z", yaw, degrees=True).as_matrix()
    transform[:2, 3] = _stem_shift(earlier, later, transform[:3, :3])
    return np.linalg.inv(earlier.frame) @ transform @ later.frame


def _stem_shift(earlier: Pose, later: Pose, turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2,) how much further the later scan's stem has to be moved, level, to cover the earlier's.

    A base is the middle of a few points at the ground. The stem just above it hardly changes: its
    points are moved onto their nearest ones, by Gaussian weights of their distances, so that those
    of leaves that hang there, far from any partner, don't pull.
    """
    from scipy.spatial import KDTree

    height = min(earlier.height, later.height)
    source, target = (
        p[np.abs(p[:, 2]) <= STEM_HEIGHT * height] for p in (later.pool, earlier.pool)
    )
    shift = np.zeros(3)
    if height == 0.0 or not len(source) or not len(target):
        return shift[:2]
    source = source @ turn.T
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


def _found_organs(sample: EvenSample, points: NDArray[np.float64]) -> NDArray[np.intp]:
    """(n,) branches of the merge tree of the geodesic distance from the base; -1 on the axis."""
    from scipy.sparse.csgraph import dijkstra

    if len(points) < 2:
        return np.full(len(points), -1)
    graph = surface_graph(sample.points)
    distance = dijkstra(graph, indices=int(np.argmin((points**2).sum(axis=1))))
    numbers = branches(distance, graph, MIN_PERSISTENCE * float(distance.max()))
    return numbers if numbers.max() >= 0 else np.zeros_like(numbers)  # one organ meets no other
