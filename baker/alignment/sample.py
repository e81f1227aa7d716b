"""An even sample of a scan, in which every point stands for the same area, and its graph.

Scanners see some organs densely and others hardly; an even sample weighs organs by area.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import MIN_LENGTH, spanning_tree
from baker.geometry.neighbors import NEIGHBORS_FOR_REACH, Gaps, nearest_neighbors, segment_adjacency
from baker.geometry.sampling import farthest_point_sample

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

POOL_SIZE, SAMPLE_SIZE, SEED = 6_000, 1_500, 0
NEIGHBORS_ON_SURFACE = 6  # of a point of an even sample


@dataclass(frozen=True)
class EvenSample:
    """Points of a cloud in farthest-point order: any first n of them cover the cloud evenly."""

    pool: NDArray[np.float64]  # (M, 3) without outliers, thinned at random if it is large
    points: NDArray[np.float64]  # (n, 3) the sample of it
    radii: NDArray[np.float64]  # (n,) distance of any point of the pool from the first 1, 2, ...
    pool_labels: NDArray[np.integer]  # (M,) organ of each point; -1 where the scan has no labels
    labels: NDArray[np.integer]  # (n,) those of the sample
    gaps: Gaps  # between the labelled organs that touch


def even_sample(
    cloud: NDArray[np.floating], labels: NDArray[np.integer] | None = None
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
    indices, radii = farthest_point_sample(pool, SAMPLE_SIZE)
    return EvenSample(pool, pool[indices], radii, labels, labels[indices], gaps)


def touching_graph(sample: EvenSample, k: int = 0) -> "csr_matrix":
    """A connected graph of the sample's points, symmetric, weighted by the edges' lengths.

    Points touch when they lie within two of the sample's radii, or as near as a point's k-th
    neighbor usually is: where the sample is nearly all of a thin cloud its radius says little.
    Where that leaves gaps (a scan has shadows) the edges of the minimum spanning tree bridge them.
    """
    from scipy.sparse import csr_matrix
    from scipy.spatial import KDTree

    points, count = sample.points, len(sample.points)
    tree = KDTree(points)
    distances, _ = tree.query(points, k=[min(k, count - 1) + 1])
    radius = max(2.0 * sample.radii[-1], float(np.median(distances)))
    spanning = spanning_tree(points, 0)
    bridges = np.stack([spanning.parent[spanning.order[1:]], spanning.order[1:]])
    close = tree.query_pairs(radius, output_type="ndarray").T
    low, high = np.sort(np.concatenate([close, bridges], axis=1), axis=0)
    low, high = np.divmod(np.unique(low * count + high), count)
    lengths = np.maximum(np.linalg.norm(points[low] - points[high], axis=1), MIN_LENGTH)
    graph = csr_matrix((lengths, (low, high)), (count, count))
    return graph + graph.T
