"""Add movers where they would be sparse between two scans.

A scan's points follow its scanner, and an organ has as many movers as the larger of its two sides
has points. So at mid-interval an organ that doubles is sparser than the stem beside it, and one
that is being born is denser. Where movers are few for their area, more are added: with the ends of
others, so that both scans show nothing but their own points, yet displaced in between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from gclip.evaluate import bernstein
from gclip.morton import morton_order
from gclip.pack import Movers, elevate_degree

if TYPE_CHECKING:
    from baker.interpolation.movers import OrganMovers

MAX_OVERHANG = 0.35  # of the square root of a mover's area: how far it may be from its mean
NEIGHBORS = 8  # towards which additions to a lonely mover are displaced in turn

Array = NDArray[Any]
Floats = NDArray[np.floating]


def with_even_density(
    tasks: Sequence[OrganMovers], growth: float, map: MapLike = map
) -> list[Movers]:
    """An interval's movers, and up to `growth` times as many more where they are sparse.

    Tasks without an area are left as they are. The added movers of a task follow its own. map: over
    tasks, by threads.
    """
    known = [task.area for task in tasks if task.area is not None]
    density = _density(np.concatenate(known), growth) if known else 0.0
    return list(map(_filled, tasks, [density] * len(tasks)))


def position_at(curve: Sequence[Floats], u: float) -> Floats:
    """(N, 3) positions on Bézier curves at the share `u` of the interval."""
    weights = bernstein(len(curve) - 1, u)
    return np.tensordot(weights, np.stack(curve), axes=1)


def _density(areas: Floats, growth: float) -> float:
    """Movers per area at which filling up to it adds `growth` times as many.

    At most what the twentieth densest has: then all are even.
    """
    descending = np.sort(areas)[::-1].astype(float)
    held = np.cumsum(descending)
    if not held[-1] > 0:
        return 0.0
    # If the first n are filled up, `density * held[n - 1] - n` movers are added.
    candidates = (growth * len(areas) + np.arange(1, len(areas) + 1)) / held
    # The first is always filled, though (1 / 49) * 49 is less than 1.
    filled = int(np.flatnonzero(candidates * descending >= 1)[-1:].sum())
    return float(min(candidates[filled], 1 / max(descending[-(len(areas) // 20) - 1], 1e-300)))


def _filled(task: OrganMovers, density: float) -> Movers:
    """A task's movers, and some of them once more with their inner control points shifted."""
    movers, degree = task.movers, max(2, len(task.movers.curve) - 1)
    if task.area is None or len(movers) <= NEIGHBORS:
        return movers
    middle = position_at(movers.curve, 0.5)
    own = _spread_out(middle, np.maximum(density * task.area - 1, 0))
    if not len(own):
        return movers
    # At mid-interval the ends keep a weight of 2 / 2 ** degree.
    shift = _aside(task, middle, own) / (1 - 2.0 ** (1 - degree))

    def extended(values: Array, shift: Floats | int = 0) -> Array:
        return np.concatenate([values, values.take(own, axis=0) + shift], dtype=values.dtype)

    start, *control, end = elevate_degree(movers.curve, degree)
    names = ("start_colors", "end_colors", "normals")
    optional: dict[str, Any] = {
        n: getattr(movers, n) for n in names if getattr(movers, n) is not None
    }
    more: dict[str, Any] = {name: extended(one) for name, one in optional.items()}
    return replace(
        movers,
        curve=(extended(start), *(extended(points, shift) for points in control), extended(end)),
        tracks=extended(movers.tracks),
        **more,
    )


def _aside(task: OrganMovers, middle: Floats, own: NDArray[np.intp]) -> Floats:
    """(n, 3) displacements of the additions from their movers at mid-interval.

    Movers from one point spread out, movers to one point draw together: an addition keeps that
    order where it goes on from the others through its mover, no farther than the gap to those from
    the next point: beyond a tip there are none. A mover that shares no point has it between itself
    and a neighbour.
    """
    from scipy.spatial import cKDTree

    leaving = middle - _mean_of_twins(task.start_points, middle)
    assert task.area is not None
    length, limit = np.linalg.norm(leaving, axis=1), MAX_OVERHANG * np.sqrt(task.area)
    leaving *= np.divide(limit, length, out=np.ones_like(length), where=length > limit)[:, None]
    shared = (leaving + middle - _mean_of_twins(task.end_points, middle)) / 2
    turn = np.arange(len(own)) - np.searchsorted(own, own)
    shift = 2 * shared.take(own, axis=0)
    lonely = ~shift.any(axis=1)
    if lonely.any():
        ranks = np.arange(2, min(int(turn[lonely].max()), NEIGHBORS - 1) + 3)
        tree = cKDTree(middle, balanced_tree=False)
        nearest = tree.query(middle[own[lonely]], k=ranks)[1]
        partner = nearest[np.arange(len(nearest)), turn[lonely] % NEIGHBORS]
        # A third of the way: the neighbour's own addition may come as far towards this one.
        shift[lonely] = (middle[partner] - middle[own[lonely]]) / 3
    return shift / (1 + turn // np.where(lonely, NEIGHBORS, 1))[:, None]


def _mean_of_twins(ends: NDArray[np.integer] | None, values: Floats) -> Floats:
    """(N, 3) each mover's mean of `values` over all movers that have the same end."""
    assert ends is not None  # what has an area moves from points to points
    sums = np.stack([np.bincount(ends, weights).take(ends) for weights in values.T], axis=1)
    return sums / np.bincount(ends).take(ends)[:, None]


def _spread_out(points: Floats, wanted: Floats) -> NDArray[np.intp]:
    """Which movers to repeat, ascending: even steps along the Morton curve leave no clusters."""
    order = morton_order(points)
    reached = np.cumsum(wanted[order])
    steps = np.arange(0.5, reached[-1], 1.0) if len(order) else np.empty(0)
    return np.sort(order[np.searchsorted(reached, steps)])
