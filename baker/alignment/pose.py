"""Poses of scans: upright, with the plant base at the origin, to be registered by a yaw."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.alignment.up_axis_search import upright
from baker.geometry.graph import branches
from baker.geometry.up_axis import Vertical

STEM_HEIGHT = 0.1  # of the parts of both stems that are registered, in heights of the lower plant
KERNEL_WIDTHS = (0.03, 0.02)  # of the weights of distances, in the same heights
MIN_MEAN_WEIGHT = 0.1  # below it, the stems are too far apart for a registration
ITERATIONS = 4
MIN_PERSISTENCE = 0.1  # of branches that count as organs, in longest geodesic distances
MIN_POINTS_OF_ORGAN = 4


class Pose(NamedTuple):
    """A scan in a frame with z up and the plant base at the origin.

    Organs are represented by their centres: while the points of an organ bend and multiply as it
    grows, its direction from the stem hardly changes.
    """

    frame: NDArray[np.float64]  # (4, 4) transform from the scan's coordinates to this frame
    pool: NDArray[np.float64]  # (M, 3) points in this frame
    height: float
    centers: NDArray[np.float64]  # (k, 3) centroids of the organs
    names: NDArray[np.int64]  # (k,) labels of the organs, arbitrary if the scan has no labels

    @property
    def base(self) -> NDArray[np.float64]:
        """(3,) plant base in the scan's coordinates."""
        return np.asarray(np.linalg.inv(self.frame)[:3, 3])


def pose_at(
    sample: EvenSample, vertical: Vertical, base: NDArray[np.float64], stem: int | None
) -> Pose:
    """The pose of a scan with a (3,) plant base. stem: the stem's label, None without labels."""
    rotation = upright(vertical)
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = rotation, -rotation @ base
    points = (sample.points - base) @ rotation.T
    organ = _find_organs(sample, points) if stem is None else sample.labels
    names, counts = np.unique(organ[organ != (-1 if stem is None else stem)], return_counts=True)
    names = names[counts >= MIN_POINTS_OF_ORGAN]
    centers = np.array([points[organ == name].mean(axis=0) for name in names]).reshape(-1, 3)
    pool = (sample.pool - base) @ rotation.T
    return Pose(frame, pool, float(np.ptp(points[:, 2])), centers, names)


def transform_onto(earlier: Pose, later: Pose, yaw: float) -> NDArray[np.float64]:
    """(4, 4) transform from the later scan to the earlier one, rotated by `yaw` degrees."""
    from scipy.spatial.transform import Rotation

    transform = np.eye(4)
    transform[:3, :3] = Rotation.from_euler("z", yaw, degrees=True).as_matrix()
    transform[:2, 3] = _stem_shift(earlier, later, transform[:3, :3])
    return np.linalg.inv(earlier.frame) @ transform @ later.frame


def _stem_shift(earlier: Pose, later: Pose, rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2,) horizontal shift that registers the lowest part of the later stem with the earlier one.

    It refines the bases, which are centroids of few points. Pairs of nearest points are weighted by
    a Gaussian of their distance, so that hanging leaves, which have no partner, don't count.
    """
    from scipy.spatial import KDTree

    height = min(earlier.height, later.height)
    source, target = (
        p[np.abs(p[:, 2]) <= STEM_HEIGHT * height] for p in (later.pool, earlier.pool)
    )
    shift = np.zeros(3)
    if height == 0.0 or not len(source) or not len(target):
        return shift[:2]
    source = source @ rotation.T
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


def _find_organs(sample: EvenSample, points: NDArray[np.float64]) -> NDArray[np.intp]:
    """(n,) branches of the merge tree of the geodesic distance from the base; -1 on the axis."""
    from scipy.sparse.csgraph import dijkstra

    if len(points) < 2:
        return np.full(len(points), -1)
    graph = surface_graph(sample.points)
    distance = dijkstra(graph, indices=int(np.argmin((points**2).sum(axis=1))))
    numbers = branches(distance, graph, MIN_PERSISTENCE * float(distance.max()))
    return numbers if numbers.max() >= 0 else np.zeros_like(numbers)  # a single organ
