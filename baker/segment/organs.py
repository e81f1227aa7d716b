"""Organs of a scan without labels: stem with petioles, leaf blades, bare branches."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.segment.blades import organs_of_nodes
from baker.segment.contact import join_touching
from baker.segment.even import even_sample
from baker.segment.levels import level_tree

FEWEST = 30  # points of a sample that shows organs


def segment_organs(
    points: NDArray[np.floating], root: int, neighbors: int = 10
) -> NDArray[np.int64]:
    """(N,) the organ of each point of an (N, 3) cloud, 0 for stem and petioles.

    root: the point at the stem's base. neighbors: of the graph that ways along the plant follow.
    """
    sample = even_sample(points, root, neighbors)
    if sample.diameter == 0.0 or len(sample.points) < FEWEST:
        return np.zeros(len(points), np.int64)
    tree = level_tree(sample)
    organ = join_touching(sample, organs_of_nodes(sample, tree)[tree.node])
    return organ[sample.nearest].astype(np.int64)
