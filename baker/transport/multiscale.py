"""Solve the transport problem of large clouds from coarse to fine, by domain decomposition.

Both clouds are divided into blocks, level by level. The plan between the blocks of one level is
refined to a feasible, nearly optimal plan of the next level, and improved there; on the last level
the blocks are the points. Large levels are divided into cells, each of which is solved exactly by
the network simplex, in several sweeps with different cells. Time and memory are linear in the
number of points.

References
----------
B. Schmitzer: A sparse multiscale algorithm for dense optimal transport (2016).
M. Bonafini, B. Schmitzer: Domain decomposition for entropy regularized optimal transport (2021).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import thread_map
from baker.transport.problem import Edges, Indices, Masses, Points, TransportOptions, costs
from baker.transport.space_partition import Blocks, bisection_order, cut, refine_plan

BLOCKS_OF_COARSEST_LEVEL = 64  # of either cloud
BLOCKS_IN_A_BLOCK = 4
STEPS = (-3, -1, 1, 3)  # in the orders of two bisections, from a point to its neighbours
POINTS_OF_CELL = 400  # of both clouds together
MAX_POINTS_OF_ONE_CELL = 3_000  # of both clouds; a smaller level is one cell
MAX_POINTS_PRICED_AT_ONCE = 100  # of the smaller cloud; without neighbours, all pairs are priced
MAX_PAIRS_PRICED = 1_500_000  # on the last level; if there are fewer, all pairs are priced
SWEEPS_OF_SMALL_CELLS = 2  # in later sweeps, the size of cells doubles
MAX_SWEEPS = 6  # the time for a point increases with the size of its cell
PARTS_PER_WORKER = 4  # into which the cells of a sweep are divided
MIN_GAIN = 3e-3  # share of the cost; if a sweep gains less, it is the last one


Coupling = tuple[Edges, Masses, str]
"""The pairs and integer masses of a feasible plan, and the name of the solver."""


def couple(
    start: Points, end: Points, supply: Masses, demand: Masses, options: TransportOptions
) -> Coupling:
    """Compute the plan of least cost between two clouds.

    Parameters
    ----------
    start, end : (n, 3) and (m, 3) float64
    supply, demand : (n,) and (m,) int64
        Masses of equal sum.
    options : TransportOptions
    """
    n, m = len(start), len(end)
    if n < m:
        edges, mass, solver = couple(end, start, demand, supply, options)
        return (edges[1], edges[0]), mass, solver
    if m == 1:
        return (np.arange(n), np.zeros(n, np.int64)), supply, "only choice"
    row_order, axes = bisection_order(start, options.seed)
    column_order, _ = bisection_order(end, options.seed, axes)
    row_levels, column_levels = (
        _levels(points[order], masses[order])
        for points, masses, order in ((start, supply, row_order), (end, demand, column_order))
    )
    edges = np.zeros(1, np.int64), np.zeros(1, np.int64)
    mass = np.array([supply.sum()])
    for index, rows in enumerate(row_levels):
        # The cloud with fewer levels stays at its last level, its points.
        columns = column_levels[min(index, len(column_levels) - 1)]
        if index >= len(column_levels):
            columns = columns._replace(first=np.arange(len(columns.points)))
        edges, mass = refine_plan(
            rows.blocks_above(), columns.blocks_above(), rows.masses, columns.masses, edges, mass
        )
        last = index == len(row_levels) - 1
        edges, mass = _improve(rows, columns, edges, mass, options, last)
    return (row_order[edges[0]], column_order[edges[1]]), mass, "network simplex"


class _Level(NamedTuple):
    """A level of a cloud: n blocks in the order of its bisection, at last single points."""

    points: NDArray[np.float64]  # (n, 3) centroids
    masses: Masses
    first: Indices  # the first block in each block of the coarser level

    def blocks_above(self) -> Blocks:
        """The blocks of the coarser level, which consist of the blocks of this one."""
        return Blocks(np.arange(len(self.points)), self.first)


def _levels(points: Points, masses: Masses) -> list[_Level]:
    """The levels of a cloud from coarse to fine; points are in the order of its bisection."""
    n = len(points)
    counts, count = [], BLOCKS_OF_COARSEST_LEVEL
    while 3 * count <= n:
        counts.append(count)
        count *= BLOCKS_IN_A_BLOCK
    levels, above = [], np.zeros(1, np.int64)
    for count in (*counts, n):
        first = -(-np.arange(count) * n // count)  # so that blocks are nested
        blocks = Blocks(np.arange(n), first)
        centroids = points.astype(np.float64) if count == n else blocks.centroids(points)
        levels.append(_Level(centroids, blocks.masses(masses), np.searchsorted(first, above)))
        above = first
    return levels


def _improve(
    rows: _Level, columns: _Level, edges: Edges, mass: Masses, options: TransportOptions, last: bool
) -> tuple[Edges, Masses]:
    """Improve a feasible plan in one sweep, or on the last level in several."""
    from baker.transport.network_simplex import improve_cells

    start, end = rows.points, columns.points
    n, m = len(start), len(end)
    is_small = min(n, m) <= MAX_POINTS_PRICED_AT_ONCE
    exhaustive = is_small or (last and n * m <= MAX_PAIRS_PRICED)
    neighbors: tuple[Indices, Indices] = np.empty((n, 0), np.int64), np.empty((m, 0), np.int64)
    if not is_small:
        seed = options.seed + MAX_SWEEPS
        neighbors = _neighbors(start, seed), _neighbors(end, seed)
    if n + m <= MAX_POINTS_OF_ONE_CELL:
        whole = np.array([0, len(mass)])
        return improve_cells(start, end, neighbors, edges, mass, whole, options.power, exhaustive)
    cost = float(mass @ costs(start, end, edges, options.power))
    for sweep in range(MAX_SWEEPS if last else 1):
        size = POINTS_OF_CELL * 2 ** max(0, sweep + 1 - SWEEPS_OF_SMALL_CELLS)
        cells = round((n + m) / size)
        cell = _cells(start, cells, options.seed, sweep)
        edges, mass = _sweep(start, end, neighbors, edges, mass, cell, exhaustive, options)
        previous, cost = cost, float(mass @ costs(start, end, edges, options.power))
        # No mass crosses the border of a cell, so the next sweep has different cells.
        if cells == 1 or previous - cost <= MIN_GAIN * cost:
            break
    return edges, mass


def _neighbors(points: NDArray[np.float64], seed: int) -> Indices:
    """(n, 8) points near each point, in the order of the cloud and in that of another bisection.

    Plans are as near to the optimum as with the four nearest points, but found sooner.
    """
    rank = np.empty(len(points), np.int64)
    order, index = bisection_order(points, seed)[0], np.arange(len(points))
    rank[order] = index
    adjacent = index[:, None] + STEPS, rank[:, None] + STEPS
    return np.hstack([index.take(adjacent[0], mode="clip"), order.take(adjacent[1], mode="clip")])


def _cells(start: Points, cells: int, seed: int, sweep: int) -> Indices:
    """(n,) the cell of each row, different in every sweep, at first by the bisection."""
    cell = np.arange(len(start)) * cells // len(start)
    if sweep > 0:
        by_cell = cell.copy()
        cell[cut(start, cells, seed + sweep).order] = by_cell
    return cell


def _sweep(
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    neighbors: tuple[Indices, Indices],
    edges: Edges,
    mass: Masses,
    cell: Indices,
    exhaustive: bool,
    options: TransportOptions,
) -> tuple[Edges, Masses]:
    """Solve each cell exactly, with the masses that its rows send and its columns receive now."""
    from baker.transport.network_simplex import improve_cells

    order = np.argsort(cell[edges[0]] * len(start) + edges[0], kind="stable")
    rows, columns, mass = edges[0][order], edges[1][order], mass[order]
    first = np.searchsorted(cell[rows], np.arange(int(cell.max()) + 2))

    def solve(begin: int, stop: int) -> tuple[Edges, Masses]:
        cells = first[begin : stop + 1]
        part = slice(cells[0], cells[-1])
        return improve_cells(
            start, end, neighbors, (rows[part], columns[part]), mass[part], cells - cells[0],
            options.power, exhaustive,
        )  # fmt: skip

    count = len(first) - 1
    parts = min(count, 1 if options.workers == 1 else PARTS_PER_WORKER * options.workers)
    stops = np.arange(parts + 1) * count // parts
    with thread_map(options.workers) as map:
        solved = list(map(solve, stops[:-1], stops[1:]))
    rows = np.concatenate([pairs[0] for pairs, _ in solved])
    columns = np.concatenate([pairs[1] for pairs, _ in solved])
    return (rows, columns), np.concatenate([flow for _, flow in solved])
