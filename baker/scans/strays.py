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

    from baker.geometry.contacts import Borders

NEIGHBORS = 12  # of a point, that tell what is around it
SMALL = 0.05  # of an organ: larger pieces are parts of it, whatever lies between
STEPS = 3
SURROUNDED = 0.8  # of what is around a piece has other labels
DOUBTFUL = 0.5  # of an organ may be strays; if more are, its label means something else


def without_strays(borders: Borders) -> Borders:
    """Give pieces of an organ that lie apart from it, amid others, their surroundings' label.

    No organ vanishes. What has no strays is returned as it is.
    """
    owner = _mended(borders)
    return borders if owner is borders.owner else replace(borders, owner=owner)


def _mended(borders: Borders) -> NDArray[np.intp]:
    """(N,) the organ of each point, strays mended."""
    from baker.scans.pieces import pieces

    owner, one, other = borders.owner, borders.one, borders.other
    near = np.ones(len(one), bool)
    near[NEIGHBORS:] = one[NEIGHBORS:] != one[:-NEIGHBORS]
    one, other = one[near], other[near]
    own = owner.take(one) == owner.take(other)
    # A piece is safe that goes on where no other organ is: in a few steps most are found to be.
    safe = np.ones(len(owner), bool)
    safe[one] = False
    for _ in range(STEPS):
        safe[one[own & safe.take(other)]] = True
    doubtful = np.flatnonzero(~safe)
    place = np.full(len(owner), len(doubtful))  # all that is safe as one
    place[doubtful] = np.arange(len(doubtful))
    asked = np.flatnonzero(~(safe.take(one) & safe.take(other)))
    own, there = own.take(asked), owner.take(other.take(asked))
    one, other = place.take(one.take(asked)), place.take(other.take(asked))
    count = len(doubtful) + 1
    piece = pieces(count, one[own], other[own])
    own_piece = piece[:-1]

    size, organ = np.bincount(own_piece, minlength=count), np.zeros(count, np.intp)
    organ[own_piece] = owner.take(doubtful)
    whole = np.bincount(owner)
    amid = np.bincount(piece.take(one[~own]), minlength=count)
    stray = amid >= SURROUNDED * np.maximum(np.bincount(piece.take(one), minlength=count), 1)
    stray &= size < SMALL * whole[organ]
    stray[piece[-1]] = False
    lost = np.bincount(organ[stray], weights=size[stray], minlength=len(whole))
    stray &= (lost <= DOUBTFUL * whole)[organ]
    if not stray.any():
        return owner

    votes = np.flatnonzero(stray[piece[one]] & ~own)
    amid_what, number = np.unique(
        np.stack([piece[one[votes]], there[votes]], axis=1), axis=0, return_counts=True
    )
    best = np.lexsort((amid_what[:, 1], -number, amid_what[:, 0]))
    mistaken, first = np.unique(amid_what[best, 0], return_index=True)
    organ[mistaken] = amid_what[best[first], 1]
    wrong = stray[own_piece]
    mended = owner.copy()
    mended[doubtful[wrong]] = organ[own_piece[wrong]]
    return mended
