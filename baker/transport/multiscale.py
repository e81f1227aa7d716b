"""The optimal plan of large clouds: from coarse to fine, and cell by cell.

Both clouds are cut into ever smaller blocks. The plan between the blocks of one level, handed out
to the blocks within them, is a feasible plan of the next level that is nearly right, and is
improved there; on the last level the blocks are the points. Large levels are improved in cells,
each solved exactly, in sweeps that cut elsewhere (domain decomposition: Bonafini and Schmitzer,
Math. Program. 2021). Time and memory grow linearly with the points.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import nearest_neighbors
from baker.geometry.parallel import thread_map
from baker.transport import bisection
from baker.transport.bisection import Blocks
from baker.transport.problem import Edges, Indices, Masses, Points, costs

_COARSEST = 64  # blocks of either side on the first level
_FINER = 4  # blocks within a block
_NEIGHBORS = 4, 6  # neighbours whose partners are tried; more where there is little slack
_EXHAUSTIVE = 1_500_000  # pairs of a level up to which all in a cell are tried in the end
FEW = 100  # points of the smaller side up to which that is all that is done
WHOLE = 3_000  # points of both sides up to which a level has one cell
_CELL = 250, 500  # points of both sides in a cell above that; more where there is little slack
_NEARBY = 3  # sweeps of such cells; where mass has farther to go, in later ones they double
_ENOUGH = 3e-3  # sweeps end when one lowers the cost by less than this share
_SWEEPS = 6  # at most: the time that a point takes grows with the cells


@dataclass(frozen=True)
class Coupling:
    """A feasible plan in whole masses; `sweeps` that the points took."""

    edges: Edges
    mass: Masses
    solver: str
    sweeps: int = 1

    def turned(self) -> Coupling:
        return replace(self, edges=self.edges[::-1])


@dataclass(frozen=True)
class Search:
    """How to look for the plan of least cost.

    power:   the cost of a pair is distance ** power.
    seed:    of the directions in which clouds are cut.
    slack:   mean cost below which an improvement is not worth another sweep.
    workers: threads; the plan is the same whatever their number.
    """

    power: int = 2
    seed: int = 0
    slack: float = 0.0
    workers: int = 1


@dataclass(frozen=True)
class _Level:
    """A cloud as n blocks, in the order of its bisection; on the finest level as n points.

    points: (n, 3) float64, centres; masses: (n,).
    first:  where each block of the level above begins.
    """

    points: NDArray[np.float64]
    masses: Masses
    first: NDArray[np.int64]

    def as_blocks(self) -> Blocks:
        """The blocks of the level above, made of this level's."""
        return Blocks(np.arange(len(self.points)), self.first)


def couple(start: Points, end: Points, supply: Masses, demand: Masses, search: Search) -> Coupling:
    """The plan of least cost between clouds (n, 3) and (m, 3) with whole masses of equal sum."""
    n, m = len(start), len(end)
    if n < m:
        return couple(end, start, demand, supply, search).turned()
    if m == 1:
        return Coupling((np.arange(n), np.zeros(n, np.int64)), supply, "only choice")
    row_order, row_levels, axes = _levels(start, supply, search.seed)
    column_order, column_levels, _ = _levels(end, demand, search.seed, axes)
    edges: Edges = (np.zeros(1, np.int64), np.zeros(1, np.int64))
    mass, sweeps = np.array([supply.sum()]), 0
    for index in range(len(row_levels)):
        rows, columns = row_levels[index], _at(column_levels, index)
        edges, mass = bisection.expand(
            rows.as_blocks(), columns.as_blocks(), rows.masses, columns.masses, edges, mass
        )
        last = index == len(row_levels) - 1
        edges, mass, sweeps = _improve(rows, columns, edges, mass, search, last)
    edges = row_order[edges[0]], column_order[edges[1]]
    return Coupling(edges, mass, "network simplex", sweeps)


def _levels(
    points: Points, masses: Masses, seed: int, like: Indices | None = None
) -> tuple[Indices, list[_Level], Indices]:
    """The order of a cloud's bisection, its levels from coarse to fine, and the axes of the cuts.

    like: the axes of a cloud of as many points or more, to cut along; what is at the same place of
          both orders then lies at about the same place.
    """
    n = len(points)
    order, axes = bisection.order(points, max(1, (n - 1).bit_length()), seed, like)
    points, masses = points.take(order, axis=0), masses[order]
    counts, count = [], _COARSEST
    while 3 * count <= n:
        counts.append(count)
        count *= _FINER
    levels, above = [], np.zeros(1, np.int64)
    if not counts:
        return order, [_Level(np.asarray(points, np.float64), masses, above)], axes
    for count in (*counts, n):
        own = -(-np.arange(count) * n // count)  # blocks lie within those of the level above
        sizes = np.diff(own, append=n)
        centres = np.add.reduceat(points, own) / sizes[:, None]
        levels.append(_Level(centres, np.add.reduceat(masses, own), np.searchsorted(own, above)))
        above = own
    return order, levels, axes


def _at(levels: list[_Level], index: int) -> _Level:
    """A level from the coarsest on; a cloud that has fewer than the other waits at its points."""
    if index < len(levels):
        return levels[index]
    return replace(levels[-1], first=np.arange(len(levels[-1].points)))


def _improve(
    rows: _Level, columns: _Level, edges: Edges, mass: Masses, search: Search, last: bool
) -> tuple[Edges, Masses, int]:
    """Improve a feasible plan in a sweep; the last level's until one gains next to nothing.

    edges: by row.
    """
    from baker.transport.network_simplex import improve_cells

    start, end = rows.points, columns.points
    n, m = len(start), len(end)
    few = min(n, m) <= FEW
    exhaustive = few or (last and n * m <= _EXHAUSTIVE)

    def cost() -> float:
        return float(mass @ costs(start, end, edges, search.power)) / float(mass.sum())

    whole = n + m <= WHOLE
    now = np.inf if whole else cost()
    little_slack = whole or (last and search.slack < _ENOUGH * now)
    k, size = 0 if few else _NEIGHBORS[int(little_slack)], _CELL[int(little_slack)]
    near = _neighbours(start, k), _neighbours(end, k)
    if whole:
        one = np.array([0, len(mass)])
        *pair, moved = improve_cells(start, end, *near, *edges, mass, one, search.power, exhaustive)
        return (pair[0], pair[1]), moved.astype(np.int64, copy=False), 1
    for sweep in range(_SWEEPS if last else 1):
        farther = sweep + 1 - _NEARBY
        cells = round((n + m) / (size * 2 ** max(0, farther)))
        cell = _cells(start, cells, search.seed, sweep)
        edges, mass = _solve_cells(start, end, near, edges, mass, cell, exhaustive, search)
        before, now = now, cost()
        # A sweep can't see past its cells' borders: the next one cuts elsewhere.
        enough = max(search.slack, _ENOUGH * now if farther > 0 else 0.0)
        if cells == 1 or (farther >= 0 and before - now <= enough):
            break
    return edges, mass, sweep + 1


def _neighbours(points: NDArray[np.float64], k: int) -> NDArray[np.int32]:
    """(n, k) the nearest other points of each point; itself where there are fewer than k."""
    found = nearest_neighbors(points, k).indices
    own = np.arange(len(points), dtype=np.int32)[:, None]
    return np.hstack([found, np.tile(own, k - found.shape[1])])


def _cells(start: Points, cells: int, seed: int, sweep: int) -> NDArray[np.int64]:
    """(n,) the cell of each row; every sweep cuts elsewhere, the first along the bisection."""
    n = len(start)
    cell = np.arange(n) * cells // n
    if sweep > 0:
        cut = bisection.cut(start, cells, seed + sweep)
        cell[cut.order] = np.arange(n) * cells // n
    return cell


def _solve_cells(
    start: Points,
    end: Points,
    near: tuple[NDArray[np.int32], NDArray[np.int32]],
    edges: Edges,
    mass: Masses,
    cell: NDArray[np.int64],
    exhaustive: bool,
    search: Search,
) -> tuple[Edges, Masses]:
    """Solve each cell's rows exactly for the masses that they now send."""
    from baker.transport.network_simplex import improve_cells

    order = np.argsort(cell[edges[0]] * len(start) + edges[0], kind="stable")
    rows, columns, mass = edges[0][order], edges[1][order], mass[order]
    cells = int(cell.max()) + 1
    first = np.searchsorted(cell[rows], np.arange(cells + 1))

    def solve(part: tuple[int, int]) -> tuple[NDArray[np.integer], ...]:
        bounds = first[part[0] : part[1] + 1]
        span = slice(bounds[0], bounds[-1])
        return improve_cells(
            start, end, *near, rows[span], columns[span], mass[span], bounds - bounds[0],
            search.power, exhaustive,
        )  # fmt: skip

    parts = min(cells, 1 if search.workers == 1 else 4 * search.workers)
    stops = [part * cells // parts for part in range(parts + 1)]
    with thread_map(search.workers) as map:
        solved = list(map(solve, pairwise(stops)))
    rows, columns, mass = (np.concatenate(found) for found in zip(*solved, strict=True))
    return (rows, columns), mass
