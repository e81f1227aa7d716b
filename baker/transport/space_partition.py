"""Recursive bisection of clouds into blocks, and refinement of plans from blocks to points."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import Edges, Indices, Masses, Points


class Blocks(NamedTuple):
    """A partition of a cloud into compact blocks, whose numbers of points differ by at most one."""

    order: Indices  # (n,) indices of the points, block after block
    first: Indices  # (blocks,) index in `order` of the first point of each block

    def masses(self, masses: Masses) -> Masses:
        """(blocks,) int64, the sum of the points' masses in each block."""
        return np.add.reduceat(masses[self.order], self.first)

    def centroids(self, points: Points) -> NDArray[np.float64]:
        """(blocks, 3) float64, the mean of the points of each block."""
        sizes = np.diff(self.first, append=len(self.order))
        return np.add.reduceat(points[self.order], self.first) / sizes[:, None]


def bisection_order(
    points: Points, seed: int, axes: Indices | None = None
) -> tuple[Indices, Indices]:
    """Sort a cloud by recursive bisection, so that neighbours in space are near in the order.

    Every part is bisected across its longest extent, in a randomly rotated frame.

    Parameters
    ----------
    points : (n, 3) float
    seed : int
        Of the rotation.
    axes : (a,) int, optional
        Those of another cloud of at least n points; the orders of two similar clouds with the same
        axes correspond.

    Returns
    -------
    order : (n,) int64
    axes : (a,) int64
        Part p of a level of 2 ** level parts is bisected along ``axes[2 ** level + p]``.
    """
    from baker.transport.bisection import bisect

    n, known = len(points), axes is not None
    depth = max(1, (n - 1).bit_length())
    axes = np.zeros(2**depth, np.int64) if axes is None else axes
    order = np.arange(n)
    bisect(np.ascontiguousarray((points @ random_rotation(seed)).T), order, axes, known)
    return order, axes


@cache
def random_rotation(seed: int) -> NDArray[np.float64]:
    """(3, 3) random rotation or reflection."""
    return np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]


def cut(points: Points, count: int, seed: int) -> Blocks:
    """Divide a cloud into `count` blocks by bisection in a frame given by the seed."""
    n = len(points)
    count = min(count, n)
    return Blocks(bisection_order(points, seed)[0], np.arange(count) * n // count)


def refine_plan(
    rows: Blocks, columns: Blocks, supply: Masses, demand: Masses, edges: Edges, mass: Masses
) -> tuple[Edges, Masses]:
    """Refine a feasible plan between blocks to a feasible plan between points.

    The mass of each pair of blocks is distributed by the north-west corner rule, in the order of
    the blocks. With a single block on each side this is the bisection coupling (BSP-OT, Genest et
    al. 2025). Integer masses make the plan feasible for any sizes; it has at most n + m more pairs
    than the plan between blocks.

    Parameters
    ----------
    rows, columns : Blocks
        Of n and m points.
    supply, demand : (n,) and (m,) int64
        Masses of the points.
    edges, mass : Edges, (E,) int64
        The plan between blocks.

    Returns
    -------
    edges, mass : Edges, (F,) int64
        Sorted by row, then column, in the order of the blocks.
    """
    by_row = np.argsort(edges[0] * len(columns.first) + edges[1], kind="stable")
    block, mass = edges[1][by_row], mass[by_row]
    by_column = np.argsort(block, kind="stable")
    # Cumulative masses: at the ends of rows and columns, and at the starts of the pairs of blocks,
    # sorted by row (`begin`) and by column (`sorted_begin`).
    row_ends, column_ends = np.cumsum(supply[rows.order]), np.cumsum(demand[columns.order])
    begin, sorted_begin = np.cumsum(mass) - mass, np.cumsum(mass[by_column]) - mass[by_column]
    shift = np.empty_like(begin)
    shift[by_column] = sorted_begin - begin[by_column]
    # A new pair of points starts with each pair of blocks, each row and each column.
    column_pair = by_column[np.searchsorted(sorted_begin, column_ends[:-1], "right") - 1]
    begins = np.sort(np.r_[begin, row_ends[:-1], column_ends[:-1] - shift[column_pair]])
    handed = np.diff(begins, append=row_ends[-1])
    begins, handed = begins[handed > 0], handed[handed > 0]
    pair = np.searchsorted(begin, begins, "right") - 1
    i = np.searchsorted(row_ends, begins, "right")
    j = np.searchsorted(column_ends, begins + shift[pair], "right")
    return (rows.order[i], columns.order[j]), handed


def bisection_plan(
    start: Points, end: Points, supply: Masses, demand: Masses, seed: int
) -> tuple[Edges, Masses]:
    """A feasible plan between points at the same position in both clouds' bisections."""
    if len(start) < len(end):
        (columns, rows), mass = bisection_plan(end, start, demand, supply, seed)
        return (rows, columns), mass
    row_order, axes = bisection_order(start, seed)
    column_order, _ = bisection_order(end, seed, axes)
    whole = np.zeros(1, np.int64)
    return refine_plan(
        Blocks(row_order, whole), Blocks(column_order, whole),
        supply, demand, (whole, whole), np.array([supply.sum()]),
    )  # fmt: skip
