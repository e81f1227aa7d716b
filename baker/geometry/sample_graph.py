"""Ways along a plant: which points of an even sample touch each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import spanning_tree
from baker.geometry.sampling import EvenSample

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

AROUND = 6  # neighbours that a point of an even sample has on a surface


def touching_pairs(sample: EvenSample, around: int = 0) -> NDArray[np.intp]:
    """(E, 2) pairs of the sample's points that touch, both ways round; all points are connected.

    Points touch when they lie within two of the sample's radii, or as near as a point's neighbour
    number `around` usually is: where the sample is nearly all of a thin cloud its radius says
    little. Where that leaves gaps (a scan has shadows) the edges of the minimum spanning tree
    bridge them.
    """
    from scipy.spatial import cKDTree

    near = cKDTree(sample.points)
    gaps, _ = near.query(sample.points, k=[min(around, len(sample.points) - 1) + 1])
    reach = max(2.0 * sample.radii[-1], float(np.median(gaps)))
    close = near.query_pairs(reach, output_type="ndarray")
    tree = spanning_tree(sample.points, 0)
    bridges = np.column_stack([tree.parent[tree.order[1:]], tree.order[1:]])
    pairs = np.concatenate([close, bridges])
    return np.concatenate([pairs, pairs[:, ::-1]])


def way_graph(pairs: NDArray[np.intp], lengths: NDArray[np.floating], count: int) -> csr_matrix:
    """Directed edges with lengths; a pair that is named twice keeps its length."""
    from scipy.sparse import csr_matrix

    _, first = np.unique(pairs[:, 0] * count + pairs[:, 1], return_index=True)
    # scipy's graphs drop edges of length zero.
    positive = np.maximum(lengths[first], np.finfo(np.float64).tiny)
    return csr_matrix((positive, tuple(pairs[first].T)), shape=(count, count))
