"""The optimal plan of large clouds: from coarse to fine, then cell by cell.

A plan between blocks of points says roughly where each point goes: neighbours of *there* are the
pairs worth looking at, and handing the blocks' mass to their points is a first, feasible plan. It
is improved in sweeps: the cloud is cut into cells, each cell's part of the plan is solved exactly
(domain decomposition: Bonafini and Schmitzer, Math. Program. 2021), and the next sweep cuts
elsewhere. Time and memory grow linearly with the points.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.transport import bisection, linear
from baker.transport.plan import Edges, Masses, Points, costs
from baker.transport.support import nearest, shield, unique

_DENSE = 1_000_000  # pairs up to which the dense problem is solved directly
_FEWEST_BLOCKS = 700
_BLOCK = 4  # points in a block, more where the blocks would outnumber the next line
_BLOCKS = 10_000  # blocks of both sides
_WHOLE = 25_000  # points of both sides up to which a sweep has one cell
_CELL = 2_500  # points of both sides in a cell above that
_WHOLE_BIJECTION = 200_000  # the same where both sides have as many points: assignment is faster
_CELL_BIJECTION = 40_000
_SHIELD = 8  # neighbours whose partners are tried
_ENOUGH = 1e-3  # sweeps end when one lowers the cost by less than this share
_SWEEPS = 6


@dataclass(frozen=True)
class Coupling:
    """A feasible plan in whole masses."""

    edges: Edges
    mass: Masses
    solver: str
    sweeps: int = 1
    notes: tuple[str, ...] = ()

    def turned(self) -> Coupling:
        return replace(self, edges=self.edges[::-1])


@dataclass(frozen=True)
class Search:
    """How to look for the plan of least cost.

    power: the cost of a pair is distance ** power.
    k:     nearest neighbours tried, both ways.
    seed:  of the directions in which clouds are cut.
    slack: mean cost below which an improvement is not worth another sweep.
    """

    power: int = 2
    k: int = 15
    seed: int = 0
    slack: float = 0.0


def couple(start: Points, end: Points, supply: Masses, demand: Masses, search: Search) -> Coupling:
    """The plan of least cost between clouds (n, 3) and (m, 3) with whole masses of equal sum."""
    n, m = len(start), len(end)
    if n < m:
        return couple(end, start, demand, supply, search).turned()
    if m == 1:
        return Coupling((np.arange(n), np.zeros(n, np.int64)), supply, "only choice")
    if n * m <= _DENSE:
        cost = costs(start, end, np.divmod(np.arange(n * m), m), search.power).reshape(n, m)
        return Coupling(*linear.solve_dense(cost, supply, demand), "emd dense")

    share = min(1 / _BLOCK, _BLOCKS / (n + m))
    rows = bisection.cut(start, max(_FEWEST_BLOCKS, int(n * share)), search.seed)
    columns = bisection.cut(end, max(_FEWEST_BLOCKS, int(m * share)), search.seed)
    block_start, block_end = rows.centres(start), columns.centres(end)
    coarse = couple(block_start, block_end, rows.masses(supply), columns.masses(demand), search)
    warped = start + _interpolate(block_start, _motion(block_start, block_end, coarse), start)
    # Bisecting where the points go is the better start, but not where they gather about few ends.
    firsts = [
        bisection.expand(rows, columns, supply, demand, coarse.edges, coarse.mass),
        bisection.couple(warped, end, supply, demand, search.seed),
    ]
    first = min(firsts, key=lambda plan: float(plan[1] @ costs(start, end, plan[0], search.power)))
    return _sweep(start, end, first, nearest(warped, end, search.k), search)


def _motion(start: Points, end: Points, coupling: Coupling) -> NDArray[np.float64]:
    """The mean way that each start point's mass goes."""
    (rows, columns), mass = coupling.edges, coupling.mass
    ways = mass[:, None] * (end[columns] - start[rows])
    total = [np.bincount(rows, way, len(start)) for way in ways.T]
    return np.stack(total, axis=1) / np.bincount(rows, mass, len(start))[:, None]


def _interpolate(
    places: Points, values: NDArray[np.float64], wanted: Points
) -> NDArray[np.float64]:
    """Values at the wanted places: Gaussian means over the nearest known ones."""
    from scipy.spatial import cKDTree

    distance, near = cKDTree(places).query(wanted, 8)
    width = np.maximum(distance[:, -1:], np.finfo(float).tiny)
    weight = np.exp(-2.0 * (distance / width) ** 2)
    return np.einsum("ij,ijk->ik", weight, values[near]) / weight.sum(1, keepdims=True)


def _sweep(
    start: Points, end: Points, first: tuple[Edges, Masses], candidates: Edges, search: Search
) -> Coupling:
    """Improve a feasible plan until a sweep gains next to nothing; it stays feasible throughout."""
    (edges, mass), n, m = first, len(start), len(end)
    bijection = n == m and bool((mass == mass[0]).all())
    whole, part = (_WHOLE_BIJECTION, _CELL_BIJECTION) if bijection else (_WHOLE, _CELL)
    cells = 1 if n + m <= whole else -(-(n + m) // part)
    total = mass.sum()
    best = float(mass @ costs(start, end, edges, search.power)) / total
    notes: list[str] = []
    for sweep in range(1, _SWEEPS + 1):
        cell = np.empty(n, np.int64)
        cut = bisection.cut(start, cells, search.seed + sweep)
        cell[cut.order] = np.searchsorted(cut.first, np.arange(n), side="right") - 1
        edges, mass, failed = _solve_cells(
            start, end, edges, mass, candidates, cell, cells, search.power
        )
        if failed:
            notes.append(f"{failed} of {cells} cells kept their plan in sweep {sweep}")
        cost = float(mass @ costs(start, end, edges, search.power)) / total
        # The first sweep can't see past its cells' borders: the second cuts elsewhere.
        if (sweep > 1 and best - cost <= max(_ENOUGH * best, search.slack)) or cost == 0.0:
            break
        best = cost
        candidates = shield(start, end, edges, _SHIELD)
    solver = "assignment" if bijection else "emd sparse"
    return Coupling(edges, mass, solver, sweep, tuple(notes))


def _solve_cells(
    start: Points,
    end: Points,
    edges: Edges,
    mass: Masses,
    candidates: Edges,
    cell: NDArray[np.int64],
    cells: int,
    power: int,
) -> tuple[Edges, Masses, int]:
    """Solve each cell's rows exactly for the masses that they now send; count those that failed."""
    mine, bounds = _by_cell(cell[edges[0]], cells)
    tried, tried_bounds = _by_cell(cell[candidates[0]], cells)
    local_row, local_column = np.zeros(len(start), np.int64), np.full(len(end), -1)
    parts, failed = [], 0
    for index in range(cells):
        own = mine[bounds[index] : bounds[index + 1]]
        old, old_mass = (edges[0][own], edges[1][own]), mass[own]
        rows, columns = np.unique(old[0]), np.unique(old[1])
        local_row[rows], local_column[columns] = np.arange(len(rows)), np.arange(len(columns))
        new = tried[tried_bounds[index] : tried_bounds[index + 1]]
        new = new[local_column[candidates[1][new]] >= 0]
        allowed = unique(old, (candidates[0][new], candidates[1][new]))
        try:
            found, found_mass = linear.solve_sparse(
                (local_row[allowed[0]], local_column[allowed[1]]),
                costs(start, end, allowed, power),
                np.bincount(local_row[old[0]], old_mass).astype(np.int64),
                np.bincount(local_column[old[1]], old_mass).astype(np.int64),
            )
            parts.append((rows[found[0]], columns[found[1]], found_mass))
        except linear.SolverError:
            parts.append((*old, old_mass))
            failed += 1
        local_column[columns] = -1
    rows, columns, mass = (np.concatenate(part) for part in zip(*parts, strict=True))
    return (rows, columns), mass, failed


def _by_cell(cell: NDArray[np.int64], cells: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices grouped by cell, and where each group begins."""
    grouped = np.argsort(cell, kind="stable")
    return grouped, np.searchsorted(cell[grouped], np.arange(cells + 1))
