"""Add movers where they would be sparse at mid-interval.

The number of an organ's movers is determined by its points in the scans. So at mid-interval, an
organ that grows fast is sparser than others, and a new one is denser. Where there are few movers
for their area, some are repeated: with the same start and end, so that the scans are still
reproduced exactly, but displaced at mid-interval.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.morton import morton_order
from baker.interpolation.packing import Movers, elevate_degree
from gclip.evaluate import bernstein
from gclip.schema import OPTIONAL

# docs/method.md, "Density".
MAX_OVERHANG = 0.35  # distance of a mover from the mean of its group : square root of its area
NEIGHBORS = 8  # towards which repetitions of a mover that shares no point are displaced in turn
DENSEST_SHARE = 20  # one in so many movers is denser than the greatest target density

Floats = NDArray[np.floating]
Indices = NDArray[np.integer]


def with_even_density(
    movers: Movers, area: Floats, start_points: Indices, end_points: Indices, growth: float
) -> Movers:
    """Repeat movers where they are sparse, up to `growth` times their number.

    All movers then move on curves of degree 2; the repeated ones come last.

    area: (M,) area that each mover represents at mid-interval, in squared length units.
    start_points, end_points: (M,) indices of the points at its ends.
    """
    middle = position_at(movers.curve, 0.5)
    wanted = np.maximum(_target_density(area, growth) * area - 1, 0)
    repeated, repetition = _choose_repeated(middle, wanted)
    if not len(repeated) or len(movers) <= NEIGHBORS:
        return movers
    groups, width = (start_points, end_points), np.sqrt(area)
    shift = _displacements(middle, width, groups, repeated, repetition)

    def extended(values: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate([values, values.take(repeated, axis=0)])

    start, control, end = map(extended, elevate_degree(movers.curve, 2))
    control[len(movers) :] += 2.0 * shift  # its weight at mid-interval is 1/2
    attributes = {name: getattr(movers, name) for name in ("tracks", *OPTIONAL)}
    repeated_attributes: dict[str, Any] = {
        name: extended(values) for name, values in attributes.items() if values is not None
    }
    return replace(movers, curve=(start, control, end), **repeated_attributes)


def position_at(curve: Sequence[Floats], u: float) -> Floats:
    """(N, 3) positions on Bézier curves at the parameter u."""
    position = np.zeros(curve[0].shape)
    for weight, points in zip(bernstein(len(curve) - 1, u), curve, strict=True):
        position += weight * points
    return position


def _target_density(areas: Floats, growth: float) -> float:
    """The density, in movers per area, up to which `growth` times as many movers can be added.

    It is at most the density that only the densest twentieth of the movers exceeds.
    """
    descending = np.sort(areas)[::-1].astype(float)
    total = np.cumsum(descending)
    if not total[-1] > 0:
        return 0.0
    # If the n sparsest movers are filled up, `density * total[n - 1] - n` movers are added.
    candidates = (growth * len(areas) + np.arange(1, len(areas) + 1)) / total
    # At least the sparsest mover is repeated, even if rounding makes (1 / 49) * 49 less than 1.
    last = int(np.flatnonzero(candidates * descending >= 1)[-1:].sum())
    least = descending[-(len(areas) // DENSEST_SHARE) - 1]
    return float(min(candidates[last], 1 / max(least, 1e-300)))


def _displacements(
    middle: Floats,
    width: Floats,
    groups: tuple[Indices, Indices],
    repeated: Indices,
    repetition: Indices,
) -> Floats:
    """(n, 3) displacements of repeated movers at mid-interval.

    Movers with the same start or end point form a group around its mean. A repetition is displaced
    away from that mean, by at most `MAX_OVERHANG`, since beyond a tip there are no other movers. A
    mover that shares no point is displaced towards a neighbour.

    middle, width: (M, 3) and (M,) position and width of each mover at mid-interval. repeated,
    repetition: as `_choose_repeated` returns them.
    """
    from scipy.spatial import KDTree

    own = middle[repeated]
    from_start, from_end = (own - _group_means(g, middle)[g[repeated]] for g in groups)
    length, limit = np.linalg.norm(from_start, axis=1), MAX_OVERHANG * width[repeated]
    from_start *= np.divide(limit, length, out=np.ones_like(length), where=length > limit)[:, None]
    shift = from_start + from_end
    is_single = ~shift.any(axis=1)
    if is_single.any():
        own = own[is_single]
        ranks = np.arange(2, min(int(repetition[is_single].max()), NEIGHBORS - 1) + 3)
        nearest = KDTree(middle, balanced_tree=False).query(own, k=ranks)[1]
        neighbor = nearest[np.arange(len(nearest)), repetition[is_single] % NEIGHBORS]
        # A third of the distance, since the neighbour's repetition may be as near from its side.
        shift[is_single] = (middle[neighbor] - own) / 3
    return shift / (1 + repetition // np.where(is_single, NEIGHBORS, 1))[:, None]


def _group_means(group: Indices, values: Floats) -> Floats:
    """(g, 3) mean of the (M, 3) values of each group's movers; NaN for a group without movers."""
    sums = np.stack([np.bincount(group, weights) for weights in values.T], axis=1)
    with np.errstate(invalid="ignore"):
        return sums / np.bincount(group)[:, None]


def _choose_repeated(points: Floats, wanted: Floats) -> tuple[Indices, Indices]:
    """Indices of the movers to repeat, at even steps along the Morton curve.

    wanted: (N,) expected number of repetitions of each mover. Also returns how many times each of
    the chosen movers was chosen before.
    """
    order = morton_order(points)
    total = np.cumsum(wanted[order])
    rank = np.searchsorted(total, np.arange(0.5, total[-1], 1.0))
    return order[rank], np.arange(len(rank)) - np.searchsorted(rank, rank)
