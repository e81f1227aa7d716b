"""The optimal plan of large clouds, from coarse to fine and cell by cell.

Both clouds are cut into ever smaller blocks. The plan between the blocks of one level, handed out
to the blocks within them, is a feasible plan of the next level that is nearly optimal, and is
improved there; on the last level the blocks are the points. Large levels are improved in cells,
each solved exactly by the network simplex, in sweeps that cut elsewhere (domain decomposition).
Time and memory grow linearly with the points.

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

BLOCKS_OF_COARSEST_LEVEL = 64  # of either side
BLOCKS_IN_A_BLOCK = 4
STEPS = (-3, -1, 1, 3)  # along two bisections, to the points whose partners are priced
POINTS_OF_CELL = 400  # of both sides together
MAX_POINTS_OF_ONE_CELL = 3_000  # of both sides, up to which a level has one cell
MAX_POINTS_PRICED_AT_ONCE = 100  # of the smaller side, up to which neighbours are not looked for
MAX_PAIRS_PRICED = 1_500_000  # of the last level, up to which all pairs of a cell are priced
SWEEPS_OF_SMALL_CELLS = 2  # in later ones cells double, for mass that has farther to go
MAX_SWEEPS = 6  # the time that a point takes grows with the cells
PARTS_PER_WORKER = 4  # that a worker's cells are solved in
MIN_GAIN = 3e-3  # share of the cost that a sweep has to gain


Coupling = tuple[Edges, Masses, str]
"""A feasible plan in whole masses, and what found it."""


def couple(
    start: Points,
    end: Points,
    supply: Masses,
    demand: Masses,
    options: TransportOptions,
) -> Coupling:
    """The plan of least cost between two clouds, (n, 3) and (m, 3), of masses of equal sum."""
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
        # A cloud that has fewer levels than the other waits at its points.
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
    """A cloud as n blocks, in the order of its bisection; on the finest level as n points."""

    points: NDArray[np.float64]  # (n, 3) centroids
    masses: Masses
    first: Indices  # where each block of the level above begins

    def blocks_above(self) -> Blocks:
        """The blocks of the level above, made of this level's."""
        return Blocks(np.arange(len(self.points)), self.first)


def _levels(points: Points, masses: Masses) -> list[_Level]:
    """The levels of a cloud in the order of its bisection, from coarse to fine."""
    n = len(points)
    counts, count = [], BLOCKS_OF_COARSEST_LEVEL
    while 3 * count <= n:
        counts.append(count)
        count *= BLOCKS_IN_A_BLOCK
    levels, above = [], np.zeros(1, np.int64)
    for count in (*counts, n):
        first = -(-np.arange(count) * n // count)  # blocks lie within those of the level above
        blocks = Blocks(np.arange(n), first)
        centroids = points.astype(np.float64) if count == n else blocks.centroids(points)
        levels.append(_Level(centroids, blocks.masses(masses), np.searchsorted(first, above)))
        above = first
    return levels


def _improve(
    rows: _Level,
    columns: _Level,
    edges: Edges,
    mass: Masses,
    options: TransportOptions,
    last: bool,
) -> tuple[Edges, Masses]:
    """Improve a feasible plan in one sweep; on the last level until a sweep gains too little."""
    from baker.transport.network_simplex import improve_cells

    start, end = rows.points, columns.points
    n, m = len(start), len(end)
    few = min(n, m) <= MAX_POINTS_PRICED_AT_ONCE
    exhaustive = few or (last and n * m <= MAX_PAIRS_PRICED)
    nothing = np.empty((n, 0), np.int64), np.empty((m, 0), np.int64)
    other = options.seed + MAX_SWEEPS
    near = nothing if few else (_neighbors(start, other), _neighbors(end, other))
    if n + m <= MAX_POINTS_OF_ONE_CELL:
        whole = np.array([0, len(mass)])
        return improve_cells(start, end, near, edges, mass, whole, options.power, exhaustive)

    def cost() -> float:
        return float(mass @ costs(start, end, edges, options.power))

    now = cost()
    for sweep in range(MAX_SWEEPS if last else 1):
        size = POINTS_OF_CELL * 2 ** max(0, sweep + 1 - SWEEPS_OF_SMALL_CELLS)
        cells = round((n + m) / size)
        cell = _cells(start, cells, options.seed, sweep)
        edges, mass = _sweep(start, end, near, edges, mass, cell, exhaustive, options)
        before, now = now, cost()
        # A sweep can't see past its cells' borders: the next one cuts elsewhere.
        if cells == 1 or before - now <= MIN_GAIN * now:
            break
    return edges, mass


def _neighbors(points: NDArray[np.float64], seed: int) -> Indices:
    """(n, 8) what lies beside each point in the cloud's order, and in that of another bisection.

    Plans come as near to the optimum as with the four nearest points, and sooner.
    """
    place = np.empty(len(points), np.int64)
    order, own = bisection_order(points, seed)[0], np.arange(len(points))
    place[order] = own
    beside = own[:, None] + STEPS, place[:, None] + STEPS
    return np.hstack([own.take(beside[0], mode="clip"), order.take(beside[1], mode="clip")])


def _cells(start: Points, cells: int, seed: int, sweep: int) -> Indices:
    """(n,) the cell of each row; every sweep cuts elsewhere, the first along the bisection."""
    cell = np.arange(len(start)) * cells // len(start)
    if sweep > 0:
        by_cell = cell.copy()
        cell[cut(start, cells, seed + sweep).order] = by_cell
    return cell


def _sweep(
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    near: tuple[Indices, Indices],
    edges: Edges,
    mass: Masses,
    cell: Indices,
    exhaustive: bool,
    options: TransportOptions,
) -> tuple[Edges, Masses]:
    """Solve each cell's rows exactly for the masses that they now send."""
    from baker.transport.network_simplex import improve_cells

    order = np.argsort(cell[edges[0]] * len(start) + edges[0], kind="stable")
    rows, columns, mass = edges[0][order], edges[1][order], mass[order]
    first = np.searchsorted(cell[rows], np.arange(int(cell.max()) + 2))

    def solve(begin: int, stop: int) -> tuple[Edges, Masses]:
        cells = first[begin : stop + 1]
        part = slice(cells[0], cells[-1])
        return improve_cells(
            start, end, near, (rows[part], columns[part]), mass[part], cells - cells[0],
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
