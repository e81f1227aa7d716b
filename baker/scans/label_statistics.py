"""Statistics that tell labels of organs from other fields, such as heights or classes."""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import edge_components
from baker.geometry.neighbors import nearest_neighbors

NEIGHBORS = 8  # of a point in the kNN graph
MIN_SAMPLE, MAX_SAMPLE = 100, 10_000  # number of points of a scan that are examined
MIN_POINTS_OF_LABEL = 30  # the components of smaller labels are not counted


def label_statistics(points: NDArray[np.floating], labels: NDArray) -> tuple[float, float, float]:
    """Measure how the (N,) labels of a scan, numbers or words, are distributed on its kNN graph.

    Returns Cohen's kappa of the labels of nearest neighbours; the median effective number of
    connected components of a label (the inverse Simpson index, in which small components count
    little); and, of the nearest neighbours whose labels differ, the share whose labels differ by
    one, 0 if there are few labels.
    """
    step = -(-len(points) // MAX_SAMPLE)
    points = points[::step]
    distinct, label = np.unique(labels[::step], return_inverse=True)
    if len(points) < MIN_SAMPLE or len(distinct) == 1:
        return 1.0, 1.0, 0.0
    neighbors = nearest_neighbors(points, NEIGHBORS).indices
    same = label[neighbors] == label[:, None]
    counts = np.bincount(label)
    by_chance = float(((counts / len(label)) ** 2).sum())
    agreement = (same[:, 0].mean() - by_chance) / (1.0 - by_chance)

    source, k = np.nonzero(same)
    component = edge_components(np.stack([source, neighbors[source, k]]), len(points))
    _, first, size = np.unique(component, return_index=True, return_counts=True)
    components = counts**2 / np.bincount(label[first], size.astype(float) ** 2)
    is_large = counts >= MIN_POINTS_OF_LABEL  # a few points are separate by chance
    median = 1.0
    if is_large.any():  # over labels, or over points if that is more
        point_components = np.repeat(components[is_large], counts[is_large])
        median = max(np.median(components[is_large]), np.median(point_components))

    steps = 0.0
    if len(distinct) > NEIGHBORS and not same[:, 0].all():
        differences = np.abs(label[neighbors[:, 0]] - label)[~same[:, 0]]
        steps = float((differences == 1).mean())
    return float(agreement), float(median), steps
