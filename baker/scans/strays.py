"""Labels that a few points have by mistake: specks of one organ amid another.

Whoever labels a scan, by hand or by a network, leaves some. Matched and moved with an organ that is
elsewhere they fly through the picture.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.spatial import cKDTree

    from baker.contacts import Borders

NEIGHBORS = 12
SMALL = 0.05  # of an organ: larger pieces are parts of it, whatever lies between
SURROUNDED = 0.8  # of what is around a piece has other labels
DOUBTFUL = 0.5  # of an organ may be strays; if more are, its label means something else


def without_strays(borders: Borders, tree: cKDTree) -> Borders:
    """Give pieces of an organ that lie apart from it, amid others, their surroundings' label.

    No organ vanishes. What has no strays is returned as it is.

    tree: of the points.
    """
    organs = _mended(borders, tree) if borders.reach else borders.owner
    changed = np.flatnonzero(organs != borders.owner)
    if not len(changed):
        return borders
    near = borders.near.copy()
    for around in tree.query_ball_point(borders.points[changed], borders.reach):
        near[around] = True  # what was of the same organ may be of another now
    return replace(borders, owner=organs, near=near)


def _mended(borders: Borders, tree: cKDTree) -> NDArray[np.intp]:
    """(N,) the organ of each point, strays mended."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    points, owner, near = borders.points, borders.owner, borders.near
    border = np.flatnonzero(near)
    if not len(border):
        return owner
    k = min(NEIGHBORS + 1, len(points))
    _, around = tree.query(points[border], k, distance_upper_bound=borders.reach)
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
