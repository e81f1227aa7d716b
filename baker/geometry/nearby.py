"""Nearest neighbours of clouds whose points come in any order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gclip.morton import morton_order

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

ROUGHLY = 1.0  # a distance may be twice as large, where it is but a bound


def bound_by(some: NDArray[np.floating], tree: cKDTree, count: int = 1) -> float:
    """What the `count` points of a cloud that are nearest to a tree's are surely within.

    some: (n, 3) a sample of the cloud. A search for those ends there: most points are farther.
    """
    reach = np.sort(tree.query(some, eps=ROUGHLY)[0])[:count][-1]
    return float(1.000001 * reach) or np.inf


def along_curve(points: NDArray[np.floating]) -> NDArray[np.intp]:
    """(n,) indices of (n, 3) points along a Morton curve: so asked, searches are 3 times as fast.

    So is making a tree of them.
    """
    return morton_order(points)


@dataclass(frozen=True)
class CurveTree:
    """A k-d tree of a cloud's points in the order of a Morton curve.

    order:  (n,) the points' numbers in the cloud.
    points: (n, 3) the points in that order.
    tree:   of these.
    """

    order: NDArray[np.intp]
    points: NDArray[np.floating]
    tree: cKDTree

    @classmethod
    def of(cls, points: NDArray[np.floating]) -> CurveTree:
        """The tree of (n, 3) points."""
        from scipy.spatial import cKDTree

        order = along_curve(points)
        placed = points.take(order, axis=0)
        return cls(order, placed, cKDTree(placed, balanced_tree=False))


def nearest(points: NDArray[np.floating], among: NDArray[np.floating]) -> NDArray[np.intp]:
    """(n,) which of (m, 3) points is the nearest to each of (n, 3) points."""
    order, there = along_curve(points), CurveTree.of(among)
    found = np.empty(len(points), np.intp)
    found[order] = there.order[there.tree.query(points.take(order, axis=0))[1]]
    return found


def nearest_others(
    points: NDArray[np.floating], count: int
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """(n, count) distances to the nearest other points of each of (n, 3) points, and which.

    In order of distance. Where a point has fewer others, itself at an infinite distance.
    """
    from baker.geometry.halves import Halves

    halves = Halves.of(points)
    squared, near = halves.nearest(count)
    away, found = np.empty_like(squared), np.empty(near.shape, np.intp)
    away[halves.order], found[halves.order] = np.sqrt(squared), halves.order[near]
    return away, found
