"""Even samples of scans, in which organs count by their area, however densely they were scanned."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph
from baker.geometry.neighbors import NEIGHBORS_FOR_RADIUS, nearest_neighbors
from baker.geometry.sampling import farthest_point_sample

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

POOL_SIZE = 6_000  # most points of a scan from which the sample is drawn
SAMPLE_SIZE, SEED = 1_500, 0  # most points of the sample; seed of the random pool
NEIGHBORS_ON_SURFACE = 8  # of a point of an even sample in its kNN graph


@dataclass(frozen=True)
class EvenSample:
    """A farthest-point sample of a scan; any prefix of it is an even sample, too."""

    pool: NDArray[np.float64]  # (M, 3) points of the scan without outliers, or a random sample
    points: NDArray[np.float64]  # (n, 3) farthest-point sample of the pool
    pool_labels: NDArray[np.integer]  # (M,) organ of each point; -1 where the scan has no labels
    labels: NDArray[np.integer]  # (n,) organs of the sample
    name: str  # of the scan
    offset: NDArray[np.float64]  # (3,) origin of the scan's coordinates minus that of the first


def even_sample(
    cloud: NDArray[np.floating],
    labels: NDArray[np.integer] | None = None,
    name: str = "",
    offset: NDArray[np.float64] | tuple[float, ...] = (0.0, 0.0, 0.0),
) -> EvenSample:
    """Sample at most 1,500 points of an (N, 3) cloud with (N,) labels by farthest points."""
    labels = np.full(len(cloud), -1) if labels is None else labels
    if len(cloud) > POOL_SIZE:
        drawn = np.random.default_rng(SEED).choice(len(cloud), POOL_SIZE, replace=False)
        cloud, labels = cloud[drawn], labels[drawn]
    pool = np.asarray(cloud, np.float64)
    is_inlier = nearest_neighbors(pool, NEIGHBORS_FOR_RADIUS).inliers
    pool, labels = pool[is_inlier], labels[is_inlier]
    chosen = farthest_point_sample(pool, SAMPLE_SIZE)
    return EvenSample(pool, pool[chosen], labels, labels[chosen], name, np.asarray(offset, float))


def surface_graph(points: NDArray[np.float64]) -> "csr_matrix":
    """The connected, symmetric kNN graph of (n, 3) points of an even sample."""
    graph = connected_knn_graph(points, NEIGHBORS_ON_SURFACE)
    return graph.maximum(graph.T)
