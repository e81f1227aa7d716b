"""Solve the transport problem of large clouds from coarse to fine, by domain decomposition.

Both clouds are divided into blocks, level by level. The plan between the blocks of one level is
refined to a feasible, nearly optimal plan of the next level, and improved there; on the last level
the blocks are the points. Large levels are divided into cells, each of which is solved exactly by
the network simplex, in several sweeps with different and ever larger cells. Time and memory are
linear in the number of points.

References
----------
B. Schmitzer: A sparse multiscale algorithm for dense optimal transport (2016).
M. Bonafini, B. Schmitzer: Domain decomposition for entropy regularized optimal transport (2021).
"""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import thread_map
from baker.transport.problem import Coupling, Edges, Indices, Masses, TransportOptions, costs
from baker.transport.space_partition import bisection_order, blocks, refine_plan

BLOCKS_OF_COARSEST_LEVEL = 64  # of either cloud
BLOCKS_IN_A_BLOCK = 4, 2  # of the next level: on levels that are one cell, and on larger ones
MIN_RATIO = 1.4  # of the number of points to that of the blocks of the level before
# In the orders of two bisections, from a point to its neighbours.
STEPS = np.array([-3, -1, 1, 3], np.int32)
POINTS_OF_CELL = 400  # of both clouds together, in the first sweep
MAX_POINTS_OF_ONE_CELL = 3_000  # of both clouds; a smaller level is one cell
MAX_POINTS_PRICED_AT_ONCE = 100  # of the smaller cloud; without neighbours, all pairs are priced
MAX_PAIRS_PRICED = 1_500_000  # on the last level; if there are fewer, all pairs are priced
MAX_SWEEPS = 6  # each has cells of twice the size; the time for a point increases with it
PARTS_PER_WORKER = 4  # into which the cells of a sweep are divided
MIN_GAIN = 5e-3  # share of the cost; if a sweep gains less, it is the last one

Floats = NDArray[np.float64]


def multiscale_plan(
    start: Floats, end: Floats, supply: Masses, demand: Masses, options: TransportOptions
) -> tuple[Edges, Masses]:
    """Compute the plan of least cost between (n, 3) and (m, 3) points with masses of equal sum."""
    if len(start) < len(end):
        edges, mass = multiscale_plan(end, start, demand, supply, options)
        return (edges[1], edges[0]), mass
    row, axes = bisection_order(start, seed=0)
    column, _ = bisection_order(end, 0, axes)
    row_levels = _levels(start[row], supply[row])
    column_levels = _levels(end[column], demand[column])
    last = len(row_levels)
    column_levels += column_levels[-1:] * (last - len(column_levels))  # stays at its points
    plan = np.array([[0], [0], [supply.sum()]])
    for index, (rows, columns) in enumerate(zip(row_levels, column_levels, strict=True), start=1):
        plan = refine_plan(rows[1], columns[1], plan)
        plan = _improve(rows[0], columns[0], plan, options, index == last)
    return (row[plan[0]], column[plan[1]]), plan[2]


def _levels(points: Floats, masses: Masses) -> list[tuple[Floats, Masses]]:
    """The centroids and masses of the blocks of each level, at last the points themselves."""
    count, levels = BLOCKS_OF_COARSEST_LEVEL, []
    while MIN_RATIO * count <= len(points):
        levels.append(blocks(points, masses, count))
        count *= BLOCKS_IN_A_BLOCK[2 * count > MAX_POINTS_OF_ONE_CELL]
    return [*levels, (points, masses)]


def _improve(
    start: Floats, end: Floats, plan: Coupling, options: TransportOptions, is_last: bool
) -> Coupling:
    """Improve a feasible plan in sweeps; the points are in the order of their bisection."""
    from baker.transport.network_simplex import improve_cells

    n, m = len(start), len(end)
    is_small = min(n, m) <= MAX_POINTS_PRICED_AT_ONCE
    exhaustive = is_small or (is_last and n * m <= MAX_PAIRS_PRICED)
    points, near = np.concatenate([start, end]), np.empty((n + m, 0), np.int32)
    orders = [np.arange(n)]
    if not is_small:
        with thread_map(options.workers) as map:
            other = partial(bisection_order, seed=1)
            (rows, _), (columns, _) = map(other, (start, end))
        near = np.vstack([_neighbors(rows), np.int32(n) + _neighbors(columns)])
        orders.append(rows)

    def solve(stops: Indices, begin: int = 0) -> Coupling:
        offset = np.array([[0], [n], [0]])  # of the columns among all points
        part = plan[:, begin : stops[-1]] + offset
        part = improve_cells(points, near, part, stops - begin, options.power, exhaustive)
        return part - offset

    if n + m <= MAX_POINTS_OF_ONE_CELL:
        return solve(np.array([plan.shape[1]]))
    cost = plan[2] @ costs(start, end, (plan[0], plan[1]), options.power)
    for sweep in range(MAX_SWEEPS):
        cells = max(1, round((n + m) / (POINTS_OF_CELL * 2**sweep)))
        # No mass crosses the border of a cell, so each sweep has different ones.
        # They have equal numbers of pairs: where rows have much mass, they have many columns.
        rows = orders[sweep] if sweep < len(orders) else bisection_order(start, seed=sweep)[0]
        counts, cell = np.bincount(plan[0], minlength=n)[rows], np.empty(n, np.int64)
        cell[rows] = (np.cumsum(counts) - counts) * cells // plan.shape[1]
        plan = plan.take(np.argsort(cell[plan[0]] * n + plan[0], kind="stable"), axis=1)
        stops = np.searchsorted(cell[plan[0]], np.arange(cells), "right")
        parts = np.array_split(stops, min(cells, PARTS_PER_WORKER * options.workers))
        with thread_map(options.workers) as map:
            plan = np.hstack([*map(solve, parts, [0, *(part[-1] for part in parts)])])
        previous, cost = cost, plan[2] @ costs(start, end, (plan[0], plan[1]), options.power)
        if cells == 1 or previous - cost <= MIN_GAIN * cost:
            break
    return plan


def _neighbors(order: Indices) -> Indices:
    """(n, 8) points near each point, in the order of the cloud and in that of another bisection.

    Plans are as near to the optimum as with the four nearest points, but found sooner.
    """
    rank, index = np.empty(len(order), np.int32), np.arange(len(order), dtype=np.int32)
    rank[order] = index
    adjacent = index[:, None] + STEPS, rank[:, None] + STEPS
    order = order.astype(np.int32)
    return np.hstack([index.take(adjacent[0], mode="clip"), order.take(adjacent[1], mode="clip")])
