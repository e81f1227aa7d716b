"""Poses of scans: upright, with the plant base at the origin, to be registered by a yaw."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.geometry.graph import branches
from baker.geometry.up_axis import Vertical

MIN_PERSISTENCE = 0.1  # of branches that count as organs, in longest geodesic distances
MIN_POINTS_OF_ORGAN = 4  # of the even sample; smaller organs have no reliable direction


class Pose(NamedTuple):
    """A scan in a frame with z up and the plant base at the origin.

    Organs are represented by their centres: while the points of an organ bend and multiply as it
    grows, its direction from the stem hardly changes.
    """

    frame: NDArray[np.float64]  # (4, 4) transform from the scan's coordinates to this frame
    height: float
    centers: NDArray[np.float64]  # (k, 3) centroids of the organs
    names: NDArray[np.int64]  # (k,) labels of the organs, arbitrary if the scan has no labels


def pose_at(
    sample: EvenSample, base: NDArray[np.float64], stem: int | None, vertical: Vertical
) -> Pose:
    """The pose of a scan with a (3,) plant base, and the label of its stem, None without labels."""
    rotation = vertical.to_z
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = rotation, -rotation @ base
    points = (sample.points - base) @ rotation.T
    organ, axis = (_find_organs(points), -1) if stem is None else (sample.labels, stem)
    labels, counts = np.unique(organ[organ != axis], return_counts=True)
    labels = labels[counts >= MIN_POINTS_OF_ORGAN]
    centers = np.array([points[organ == name].mean(axis=0) for name in labels]).reshape(-1, 3)
    return Pose(frame, float(np.ptp(points[:, 2])), centers, labels)


def transform_onto(earlier: Pose, later: Pose, yaw: float) -> NDArray[np.float64]:
    """(4, 4) transform from the later scan to the earlier one, base on base, rotated by `yaw`."""
    from scipy.spatial.transform import Rotation

    transform = np.eye(4)
    transform[:3, :3] = Rotation.from_euler("z", yaw, degrees=True).as_matrix()
    return np.linalg.inv(earlier.frame) @ transform @ later.frame


def _find_organs(points: NDArray[np.float64]) -> NDArray[np.intp]:
    """(n,) branches of the merge tree of the geodesic distance from the base; -1 on the axis."""
    from scipy.sparse.csgraph import dijkstra

    graph = surface_graph(points)
    distance = dijkstra(graph, indices=int(np.argmin((points**2).sum(axis=1))))
    numbers = branches(distance, graph, MIN_PERSISTENCE * float(distance.max()))
    return numbers if numbers.max() >= 0 else np.zeros_like(numbers)  # a single organ
