"""An organ's movers as pairs of points: by one transport plan, or by one for each of its limbs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.transport.problem import TransportOptions, costs

if TYPE_CHECKING:
    from baker.matching.leaflets import Piece

Points = NDArray[np.floating]


@dataclass(frozen=True)
class Coupled:
    """rows, columns: (M,) the pairs, ordered by row, then column; the rest as in `Plan`.

    limbs: whether limbs were moved each on its own.
    """

    rows: NDArray[np.integer]
    columns: NDArray[np.integer]
    distance: float
    marginal_error: float
    solver: str
    notes: tuple[str, ...] = ()
    limbs: bool = False


def coupled(
    start: Points,
    end: Points,
    options: TransportOptions,
    foot: tuple[int, int] | None = None,
) -> Coupled:
    """Pair the points of an organ, (n, 3) and (m, 3), by optimal transport.

    foot: the points where it is attached, one of either side. Then limbs that both scans show are
          transported each on its own, by the mass that both scans have around each point, so that
          leaves born beside a leaf take none of its points.

    The distance is that of all pairs, the marginals' error the largest of a piece.
    """
    cut = [] if foot is None else _cut(start, end, foot)
    if not cut:
        return _paired(start, end, (start, end), options)
    shared = replace(options, shared=True)
    found = [
        _paired(piece.here, piece.there, (start[piece.start], end[piece.end]), shared)
        for piece in cut
    ]
    rows = np.concatenate([piece.start[one.rows] for piece, one in zip(cut, found, strict=True)])
    columns = np.concatenate([p.end[one.columns] for p, one in zip(cut, found, strict=True)])
    order = np.lexsort((columns, rows))
    work = [
        one.distance**options.power * len(piece.end) for piece, one in zip(cut, found, strict=True)
    ]
    return Coupled(
        rows[order],
        columns[order],
        (sum(work) / len(end)) ** (1 / options.power),
        max(one.marginal_error for one in found),
        max(zip(work, found, strict=True), key=lambda pair: pair[0])[1].solver,
        (f"its limbs moved each on its own, {len(cut)} pieces in all",) if len(cut) > 1 else (),
        len(cut) > 1,
    )


def _cut(start: Points, end: Points, foot: tuple[int, int]) -> list[Piece]:
    from baker.matching.leaflets import pieces

    return pieces(start, end, foot)


def _paired(
    here: Points, there: Points, true: tuple[Points, Points], options: TransportOptions
) -> Coupled:
    """The pairs of one plan, and their distance between the true positions."""
    from baker.transport.correspondences import movers
    from baker.transport.solve import solve

    plan = solve(here, there, options)
    rows, columns, _ = movers(plan, len(here), len(there))
    distance = plan.distance
    if here is not true[0]:
        cost = plan.mass @ costs(*true, (plan.rows, plan.columns), options.power)
        distance = float(cost) ** (1 / options.power)
    return Coupled(rows, columns, distance, plan.marginal_error, plan.solver, plan.notes)
