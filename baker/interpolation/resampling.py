"""Add movers where they would be sparse at mid-interval.

The number of an organ's movers follows from its points in the scans. So at mid-interval, an organ
that grows fast is sparser than others, and a new one is denser. Where movers are sparse for their
area, movers are repeated: with the same start and end, so that the scans are still reproduced
exactly, but displaced in between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gclip.evaluate import bernstein
from gclip.morton import morton_order
from gclip.pack import Movers, elevate_degree

if TYPE_CHECKING:
    from baker.interpolation.movers import OrganMovers

MAX_OVERHANG = 0.35  # distance of a mover from the mean of its group : square root of its area
NEIGHBORS = 8  # towards which repetitions of a mover that shares no point are displaced in turn

Array = NDArray[Any]
Floats = NDArray[np.floating]


def with_even_density(tasks: Sequence[OrganMovers], growth: float) -> list[Movers]:
    """Repeat movers of an interval where they are sparse, up to `growth` times their number.

    Tasks without an area are left unchanged. The added movers of a task follow the others.
    """
    areas = [task.area for task in tasks if task.area is not None]
    density = _target_density(np.concatenate(areas), growth) if areas else 0.0
    return list(map(_fill, tasks, [density] * len(tasks)))


def position_at(curve: Sequence[Floats], u: float) -> Floats:
    """(N, 3) positions on Bézier curves at the parameter u."""
    weights = bernstein(len(curve) - 1, u)
    return np.tensordot(weights, np.stack(curve), axes=1)


def _target_density(areas: Floats, growth: float) -> float:
    """The density, in movers per area, that is reached with `growth` times as many movers.

    It is at most that of the densest twentieth, with which all movers are even.
    """
    descending = np.sort(areas)[::-1].astype(float)
    total = np.cumsum(descending)
    if not total[-1] > 0:
        return 0.0
    # If the n sparsest movers are filled up, `density * total[n - 1] - n` movers are added.
    candidates = (growth * len(areas) + np.arange(1, len(areas) + 1)) / total
    # At least the sparsest is filled, even if rounding makes (1 / 49) * 49 less than 1.
    last = int(np.flatnonzero(candidates * descending >= 1)[-1:].sum())
    return float(min(candidates[last], 1 / max(descending[-(len(areas) // 20) - 1], 1e-300)))


def _fill(task: OrganMovers, density: float) -> Movers:
    """Repeat some of a task's movers, on curves of degree 2, with their control points shifted."""
    movers = task.movers
    if task.area is None or len(movers) <= NEIGHBORS:
        return movers
    middle = position_at(movers.curve, 0.5)
    repeated = _choose_repeated(middle, np.maximum(density * task.area - 1, 0))
    if not len(repeated):
        return movers

    def extended(values: Array, shift: Floats | int = 0) -> Array:
        return np.concatenate([values, values.take(repeated, axis=0) + shift], dtype=values.dtype)

    start, control, end = elevate_degree(movers.curve, 2)
    # The weight of the control point at mid-interval is 1/2.
    control = extended(control, 2.0 * _displacements(task, middle, repeated))
    attributes = {n: getattr(movers, n) for n in ("start_colors", "end_colors", "normals")}
    optional: dict[str, Any] = {n: extended(v) for n, v in attributes.items() if v is not None}
    return replace(
        movers,
        curve=(extended(start), control, extended(end)),
        tracks=extended(movers.tracks),
        **optional,
    )


def _displacements(task: OrganMovers, middle: Floats, repeated: NDArray[np.intp]) -> Floats:
    """(n, 3) displacements of repeated movers at mid-interval.

    Movers with the same start or end point form a group around its mean. A repetition is displaced
    away from that mean, by at most `MAX_OVERHANG`, since beyond a tip there are no other movers. A
    mover that shares no point is displaced towards a neighbour.
    """
    from scipy.spatial import KDTree

    from_mean = middle - _group_mean(task.start_points, middle)
    assert task.area is not None
    length, limit = np.linalg.norm(from_mean, axis=1), MAX_OVERHANG * np.sqrt(task.area)
    from_mean *= np.divide(limit, length, out=np.ones_like(length), where=length > limit)[:, None]
    shared = (from_mean + middle - _group_mean(task.end_points, middle)) / 2
    repetition = np.arange(len(repeated)) - np.searchsorted(repeated, repeated)
    shift = 2 * shared.take(repeated, axis=0)
    is_single = ~shift.any(axis=1)
    if is_single.any():
        ranks = np.arange(2, min(int(repetition[is_single].max()), NEIGHBORS - 1) + 3)
        tree = KDTree(middle, balanced_tree=False)
        nearest = tree.query(middle[repeated[is_single]], k=ranks)[1]
        neighbor = nearest[np.arange(len(nearest)), repetition[is_single] % NEIGHBORS]
        # A third of the distance, since the neighbour's repetition may be as near from its side.
        shift[is_single] = (middle[neighbor] - middle[repeated[is_single]]) / 3
    return shift / (1 + repetition // np.where(is_single, NEIGHBORS, 1))[:, None]


def _group_mean(group: NDArray[np.integer] | None, values: Floats) -> Floats:
    """(N, 3) mean of `values` over the movers of each mover's group."""
    assert group is not None  # movers with an area have start and end points
    sums = np.stack([np.bincount(group, weights).take(group) for weights in values.T], axis=1)
    return sums / np.bincount(group).take(group)[:, None]


def _choose_repeated(points: Floats, wanted: Floats) -> NDArray[np.intp]:
    """Indices of the movers to repeat, ascending, in even steps along the Morton curve.

    wanted: (N,) the number of repetitions of each mover, as a fraction.
    """
    order = morton_order(points)
    total = np.cumsum(wanted[order])
    steps = np.arange(0.5, total[-1], 1.0) if len(order) else np.empty(0)
    return np.sort(order[np.searchsorted(total, steps)])
