"""An even sample of a scan, in which every point stands for the same area, and its graph.

Scanners see some organs densely and others hardly; an even sample weighs organs by area.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph
from baker.geometry.neighbors import NEIGHBORS_FOR_REACH, Gaps, nearest_neighbors, segment_adjacency
from baker.geometry.sampling import farthest_point_sample

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

POOL_SIZE, SAMPLE_SIZE, SEED = 6_000, 1_500, 0
NEIGHBORS_ON_SURFACE = 8  # of a point of an even sample


@dataclass(frozen=True)
class EvenSample:
    """Points of a cloud in farthest-point order: any first n of them cover the cloud evenly."""

    pool: NDArray[np.float64]  # (M, 3) without outliers, thinned at random if it is large
    points: NDArray[np.float64]  # (n, 3) the sample of it
    pool_labels: NDArray[np.integer]  # (M,) organ of each point; -1 where the scan has no labels
    labels: NDArray[np.integer]  # (n,) those of the sample
    gaps: Gaps  # between the labelled organs that touch
    name: str  # of the scan
    offset: NDArray[np.float64]  # (3,) of the scan's coordinates from those of the first one


def even_sample(
    cloud: NDArray[np.floating],
    labels: NDArray[np.integer] | None = None,
    name: str = "",
    offset: Sequence[float] = (0.0, 0.0, 0.0),
) -> EvenSample:
    """At most 1,500 points of an (N, 3) cloud with (N,) labels, by farthest-point sampling."""
    labels = np.full(len(cloud), -1) if labels is None else labels
    if len(cloud) > POOL_SIZE:
        kept = np.random.default_rng(SEED).choice(len(cloud), POOL_SIZE, replace=False)
        cloud, labels = cloud[kept], labels[kept]
    pool = np.asarray(cloud, np.float64)
    neighbors = nearest_neighbors(pool, NEIGHBORS_FOR_REACH)
    gaps = segment_adjacency(labels, neighbors)
    pool, labels = pool[neighbors.inliers], labels[neighbors.inliers]
    indices = farthest_point_sample(pool, SAMPLE_SIZE)
    points, sampled = pool[indices], labels[indices]
    return EvenSample(pool, points, labels, sampled, gaps, name, np.asarray(offset, float))


def surface_graph(points: NDArray[np.float64]) -> "csr_matrix":
    """The connected kNN graph of (n, 3) points of an even sample, symmetric."""
    graph = connected_knn_graph(points, NEIGHBORS_ON_SURFACE)[0]
    return graph.maximum(graph.T)
