"""Where the shortest paths from the plant base enter the organs of a scan, and from which ones.

The point of an organ that is nearest to another one may be a leaf's tip that touches it. But most
of the paths to an organ's points enter it at its base. Steps from organ to organ count twice, lest
a path lead through organs that only touch.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import chain_ends, connected_knn_graph
from baker.segmentation.hierarchy import split_by_label

MAX_POINTS, NEIGHBORS = 400, 20  # of each organ; of each point in the kNN graph
CROSSING_FACTOR = 2.0  # by which edges of the graph between organs are longer


@dataclass(frozen=True)
class OrganEntries:
    """The shortest paths to a sample of the points of n organs, by ascending label."""

    labels: list[int]  # n
    points: NDArray[np.float64]  # (m, 3) the sample, whose first point is the plant base
    organ: NDArray[np.intp]  # (m,) index of each point's organ
    entry: NDArray[np.intp]  # (m,) index of the point at which the path last enters that organ
    source: NDArray[np.intp]  # (m,) index of the organ from which it does; of the root's, the root
    distance: NDArray[np.float64]  # (m,) length of the path to each point

    def shares(self) -> NDArray[np.float64]:
        """(n, n) share of the paths to the row's organ that enter it from the column's."""
        counts = np.zeros((len(self.labels), len(self.labels)))
        np.add.at(counts, (self.organ, self.source), 1.0)
        return np.asarray(counts / counts.sum(axis=1, keepdims=True))

    def attachments(self) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
        """(n, 3) attachment points of the organs, and (n,) organs from which most paths come.

        An attachment point is the mean of the points at which these paths enter; that of the root
        is the plant base.
        """
        source = self.shares().argmax(axis=1)
        attachments = [
            self.points[self.entry[(self.organ == k) & (self.source == other)]].mean(axis=0)
            for k, other in enumerate(source)
        ]
        attachments[self.organ[0]] = self.points[0]
        return np.array(attachments), source


def organ_entries(
    cloud: NDArray[np.floating], labels: NDArray[np.integer], root_point: int
) -> OrganEntries:
    """Find the shortest paths to the organs of a scan, along the kNN graph of at most 400 of each.

    cloud, labels: (N, 3) points and (N,) organs. root_point: index of the point at the plant base.
    """
    from scipy.sparse.csgraph import dijkstra

    distinct, members = split_by_label(labels)
    parts = [points[:: -(-len(points) // MAX_POINTS)] for points in members]
    root = distinct.index(int(labels[root_point]))
    organ = np.append(root, np.repeat(np.arange(len(parts)), [*map(len, parts)]))
    points = cloud[np.concatenate([[root_point], *parts])].astype(np.float64)
    graph = connected_knn_graph(points, NEIGHBORS).tocoo()
    graph.data[organ[graph.row] != organ[graph.col]] *= CROSSING_FACTOR
    distance, before = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
    before = np.maximum(before, 0)  # the point before each one; negative at the plant base
    entry = chain_ends(np.where(organ[before] == organ, before, np.arange(len(organ))))
    return OrganEntries(distinct, points, organ, entry, organ[before[entry]], distance)
