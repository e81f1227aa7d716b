"""Add movers where they would be sparse at mid-interval.

The number of an organ's movers is determined by its points in the scans. So at mid-interval, an
organ that grows fast is sparser than others, and a new one is denser. Where there are few movers
for their area, some are repeated: with the same start and end, so that the scans are still
reproduced exactly, but displaced at mid-interval.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.morton import morton_order
from baker.geometry.neighbors import blocks
from baker.interpolation.packing import Movers, elevate_degree
from gclip.evaluate import bernstein
from gclip.schema import OPTIONAL

# docs/method.md, "Density".
MAX_OVERHANG = 0.35  # distance of a mover from its group's mean, in roots of the group's area
NEIGHBORS = 8  # towards which repetitions of a mover that shares no point are displaced in turn
DENSEST_SHARE = 20  # one in so many movers is denser than the greatest target density

Floats = NDArray[np.floating]
Indices = NDArray[np.integer]


def with_even_density(
    movers: Movers, area: Floats, start_points: Indices, end_points: Indices, growth: float
) -> list[Movers]:
    """Repeat movers where they are sparse, up to `growth` times their number.

    Returns the movers and, if any are repeated, the repetitions, on curves of degree 2.

    area: (M,) area that each mover represents at mid-interval, in squared length units.
    start_points, end_points: (M,) indices of the points at its ends.
    """
    density, weights = _target_density(area, growth), bernstein(len(movers.curve) - 1, 0.5)
    middle: Any = sum(w * points for w, points in zip(weights, movers.curve, strict=True))
    repeated, repetition = _choose_repeated(middle, np.maximum(density * area - 1, 0))
    if not len(repeated) or len(movers) <= NEIGHBORS:
        return [movers]
    curve = tuple(points.take(repeated, axis=0) for points in movers.curve)
    start, control, end = elevate_degree(curve, 2)
    groups, width = (start_points, end_points), np.sqrt(area[repeated])
    for part, shift in _displacements(middle, width, groups, repeated, repetition):
        control[part] += 2.0 * shift  # its weight at mid-interval is 1/2
    values: dict[str, Any] = {name: getattr(movers, name) for name in ("tracks", *OPTIONAL)}
    values = {name: v if v is None else v.take(repeated, axis=0) for name, v in values.items()}
    return [movers, replace(movers, curve=(start, control, end), **values)]


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
) -> Iterator[tuple[slice, Floats]]:
    """Yield the displacements of repeated movers at mid-interval, in blocks of these.

    Movers with the same start or end point form a group around its mean. A repetition is displaced
    away from that mean, by at most `MAX_OVERHANG`, since beyond a tip there are no other movers. A
    mover that shares no point is displaced towards a neighbour.

    middle: (M, 3) positions of all movers at mid-interval. width: (n,) of the repeated movers.
    repeated, repetition: as `_choose_repeated` returns them.
    """
    from scipy.spatial import cKDTree

    tree, means = cKDTree(middle, balanced_tree=False), [_group_means(g, middle) for g in groups]
    for part in blocks(len(repeated)):
        chosen, turn, limit = repeated[part], repetition[part], MAX_OVERHANG * width[part]
        own = middle[chosen]
        from_start, from_end = (
            own - mean[group[chosen]] for mean, group in zip(means, groups, strict=True)
        )
        length = np.linalg.norm(from_start, axis=1)
        shorter = np.divide(limit, length, out=np.ones_like(length), where=length > limit)
        shift = from_start * shorter[:, None] + from_end
        is_single = ~shift.any(axis=1)
        if is_single.any():
            distinct, number = np.unique(chosen[is_single], return_inverse=True)
            rank = turn[is_single] % NEIGHBORS
            nearest = tree.query(middle[distinct], k=np.arange(2, rank.max() + 3))[1]
            # A third of the distance: the neighbour's repetition may be as near from its side.
            shift[is_single] = (middle[nearest[number, rank]] - own[is_single]) / 3
        yield part, shift / (1 + turn // np.where(is_single, NEIGHBORS, 1))[:, None]


def _group_means(group: Indices, values: Floats) -> Floats:
    """(groups, 3) mean of the `values` of each group's movers; 0 for a group without movers."""
    count = np.maximum(np.bincount(group), 1)
    return np.stack([np.bincount(group, weights) / count for weights in values.T], axis=1)


def _choose_repeated(points: Floats, wanted: Floats) -> tuple[Indices, Indices]:
    """Indices of the movers to repeat, at even steps along the Morton curve.

    wanted: (N,) expected number of repetitions of each mover. Also returns how many times each of
    the chosen movers was chosen before.
    """
    order = morton_order(points)
    total = np.cumsum(wanted[order])
    rank = np.searchsorted(total, np.arange(0.5, total[-1], 1.0))
    return order[rank], np.arange(len(rank)) - np.searchsorted(rank, rank)
