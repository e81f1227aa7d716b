"""Recursive bisection of clouds, and refinement of plans from blocks of points to points."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import Coupling, Edges, Indices, Masses, Points


def bisection_order(
    points: Points, seed: int, axes: Indices | None = None
) -> tuple[Indices, Indices]:
    """Sort (n, 3) points by recursive bisection, so that neighbours in space are near in the order.

    Every part is bisected across its longest extent, in a frame that is rotated at random, by the
    seed; or along the `axes` of another cloud of at least as many points, so that the orders of
    similar clouds correspond. Part p of a level of 2 ** level parts is bisected along
    ``axes[2 ** level + p]``.
    """
    from baker.transport.partition_kernels import bisect

    n, has_axes = len(points), axes is not None
    depth = max(1, (n - 1).bit_length())
    axes = np.zeros(2**depth, np.int64) if axes is None else axes
    order = np.arange(n)
    bisect(np.ascontiguousarray((points @ random_rotation(seed)).T), order, axes, has_axes)
    return order, axes


@cache
def random_rotation(seed: int) -> NDArray[np.float64]:
    """(3, 3) random rotation or reflection."""
    return np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]


def blocks(points: Points, masses: Masses, count: int) -> tuple[NDArray[np.float64], Masses]:
    """Centroids and masses of `count` blocks of successive points, or of the points if fewer.

    The numbers of points in blocks differ by at most one. If one count divides another one, the
    smaller blocks are nested in the larger ones.
    """
    n = len(points)
    if count >= n:
        return np.asarray(points, np.float64), masses
    first = -(-np.arange(count) * n // count)
    sizes = np.diff(first, append=n)
    return np.add.reduceat(points, first) / sizes[:, None], np.add.reduceat(masses, first)


def refine_plan(supply: Masses, demand: Masses, plan: Coupling) -> Coupling:
    """Refine a feasible plan between blocks of successive points to one between the points.

    The mass of each pair of blocks is distributed by the north-west corner rule. With a single
    block on each side this is the bisection coupling (BSP-OT, Genest et al. 2025). Integer masses
    make the plan feasible for any sizes; it has at most n + m more pairs.

    supply, demand: (n,) and (m,) masses of the points. The returned pairs are sorted by row, then
    column.
    """
    _, columns, mass = plan.take(np.lexsort(plan[1::-1]), axis=1)
    by_column = np.argsort(columns, kind="stable")
    # All masses are laid end to end, those of rows and of columns: each pair takes a part of both.
    begin, column_begin = np.cumsum(mass) - mass, np.empty_like(mass)
    column_begin[by_column] = np.cumsum(mass[by_column]) - mass[by_column]
    row_ends, column_ends = np.cumsum(supply), np.cumsum(demand)
    pair = by_column[np.searchsorted(column_begin[by_column], column_ends - 1, "right") - 1]
    cuts = np.sort(np.r_[begin, row_ends, column_ends + (begin - column_begin)[pair]])
    moved = np.diff(cuts)
    first, moved = cuts[:-1][moved > 0], moved[moved > 0]
    row = np.searchsorted(row_ends, first, "right")
    pair = np.searchsorted(begin, first, "right") - 1
    column = np.searchsorted(column_ends, first + (column_begin - begin)[pair], "right")
    return np.stack([row, column, moved])


def bisection_plan(
    start: Points, end: Points, supply: Masses, demand: Masses, seed: int
) -> tuple[Edges, Masses]:
    """A feasible plan between points at the same position in both clouds' bisections."""
    if len(start) < len(end):
        (columns, rows), mass = bisection_plan(end, start, demand, supply, seed)
        return (rows, columns), mass
    row, axes = bisection_order(start, seed)
    column, _ = bisection_order(end, seed, axes)
    masses = supply[row], demand[column]
    rows, columns, mass = refine_plan(*masses, np.array([[0], [0], [supply.sum()]]))
    return (row[rows], column[columns]), mass
