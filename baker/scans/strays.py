"""Labels that a few points have by mistake: specks of one organ amid another.

Whoever labels a scan, by hand or by a network, leaves some. Matched and moved with an organ that is
elsewhere they fly through the picture.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from baker.borders import near_others
from baker.nearby import along_curve
from baker.spacing import point_spacing

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.spatial import cKDTree

    from baker.scans.cloud import Cloud

REACH = 3.0  # of the point spacing: what counts as around a point
NEIGHBORS = 12
SMALL = 0.05  # of an organ: larger pieces are parts of it, whatever lies between
SURROUNDED = 0.8  # of what is around a piece has other labels
DOUBTFUL = 0.5  # of an organ may be strays; if more are, its label means something else


def without_strays(cloud: Cloud) -> Cloud:
    """Give pieces of an organ that lie apart from it, amid others, their surroundings' label.

    No organ vanishes. Notes how many points were given another label.
    """
    if cloud.labels is None:
        return cloud
    labels = mended(cloud.points, cloud.labels)
    changed = int((labels != cloud.labels).sum())
    if not changed:
        return cloud
    points = "point has" if changed == 1 else "points have"
    return replace(cloud, labels=labels).noting(
        f"{changed} {points} the label of what is all around now, not of an organ elsewhere."
    )


def mended(points: NDArray[np.floating], labels: NDArray[np.int64]) -> NDArray[np.int64]:
    """(N,) the labels of (N, 3) points, strays mended."""
    from scipy.spatial import cKDTree

    names, owner = np.unique(labels, return_inverse=True)
    if len(names) < 2:
        return labels
    order = along_curve(points)
    tree = cKDTree(points[order], balanced_tree=False)
    reach = REACH * point_spacing(points, tree)
    if reach:
        owner[order] = _mended(points[order], owner[order], tree, reach)
    return names[owner]


def _mended(
    points: NDArray[np.floating], owner: NDArray[np.intp], tree: cKDTree, reach: float
) -> NDArray[np.intp]:
    """(N,) the organ of each point, from 0 on; `tree` is of the points."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    near = near_others(points, owner, reach)
    border = np.flatnonzero(near)
    if not len(border):
        return owner
    k = min(NEIGHBORS + 1, len(points))
    _, around = tree.query(points[border], k, distance_upper_bound=reach)
    around = around[:, 1:]  # the nearest is the point itself
    found = around < len(points)
    one, other = np.broadcast_to(border[:, None], around.shape)[found], around[found]
    own = owner[one] == owner[other]
    touching = coo_matrix((np.ones(own.sum()), (one[own], other[own])), shape=[len(points)] * 2)
    count, piece = connected_components(touching, directed=False)

    size, organ = np.bincount(piece, minlength=count), np.zeros(count, np.intp)
    organ[piece] = owner
    amid = np.bincount(piece[one[~own]], minlength=count)
    stray = amid >= SURROUNDED * np.maximum(np.bincount(piece[one], minlength=count), 1)
    stray &= size < SMALL * np.bincount(owner)[organ]
    stray[piece[~near]] = False  # it goes on where no other organ is
    lost = np.bincount(organ[stray], weights=size[stray], minlength=int(owner.max()) + 1)
    stray &= (lost <= DOUBTFUL * np.bincount(owner))[organ]

    votes = np.flatnonzero(stray[piece[one]] & ~own)
    pairs, number = np.unique(
        np.stack([piece[one[votes]], owner[other[votes]]], axis=1), axis=0, return_counts=True
    )
    best = np.lexsort((pairs[:, 1], -number, pairs[:, 0]))
    pieces, first = np.unique(pairs[best, 0], return_index=True)
    organ[pieces] = pairs[best[first], 1]
    return organ[piece]
