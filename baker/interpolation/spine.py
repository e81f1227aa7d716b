"""The spine of an organ: the curve through the level sets of geodesic distance within it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph, geodesic_distances
from baker.geometry.neighbors import Neighbors, nearest_neighbors
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

Points = NDArray[np.float64]

LEVELS = 11  # nodes of a spine
NEIGHBORS = 9  # of the kNN graph
TIP_QUANTILE = 0.98  # of geodesic distance, at which the tip lies; what is beyond may be noise
KERNEL_WIDTH = 0.09  # of a level, as a share of the spine's length
MAX_SAMPLE = 400  # points of an organ that its spine is fitted to
MIN_POINTS_FOR_SPINE = 40
CONTACT_RADIUS = 2.0  # spacings of the sample beyond the smallest gap that still touch the parent


@dataclass(frozen=True)
class Spine:
    """A curve from an organ's attachment (along = 0) to its tip (along = 1)."""

    nodes: Points  # (LEVELS, 3), at even steps along
    tangents: Points  # (LEVELS, 3), unit vectors towards the tip
    along: NDArray[np.float64]  # (n,), where each of the organ's points lies, 0 to 1


@dataclass(frozen=True)
class OrganShape:
    """A segment of a scan: a sample of its points, and the spine through it."""

    points: Points  # (n, 3), at most MAX_SAMPLE
    spine: Spine
    lengths: NDArray[np.float64]  # (n,), geodesic distances from the plant base


def organ_shapes(
    points: NDArray[np.floating],
    hierarchy: Hierarchy,
    base: NDArray[np.floating],
    segments: Iterable[int],
) -> list[OrganShape | None]:
    """The shapes of segments of a scan, (N, 3) points; None of those with too few, and of others.

    Geodesics run through the parents, from the plant base, (3,): an organ that leaves its parent
    over a long contact, as a grass leaf does its whorl, is measured from where it leaves it first.
    """
    shapes: list[OrganShape | None] = [None] * len(hierarchy.segments)
    needed = {above for segment in segments for above in (segment, *hierarchy.ancestors(segment))}
    for segment in hierarchy.from_the_root():
        members, parent = hierarchy.segments[segment], hierarchy.parents[segment]
        if segment not in needed or len(members) < MIN_POINTS_FOR_SPINE:
            continue
        if len(members) > MAX_SAMPLE:
            chosen = np.random.default_rng(0).permutation(len(members))[:MAX_SAMPLE]
            members = members[np.sort(chosen)]
        sample = points[members].astype(np.float64)
        neighbors = nearest_neighbors(sample, NEIGHBORS)
        above = None if parent == NO_PARENT else shapes[parent]
        seeds, offsets = _contact(sample, CONTACT_RADIUS * neighbors.spacing, above, base)
        lengths = path_lengths(sample, seeds, offsets, neighbors)
        shapes[segment] = OrganShape(sample, fit_spine(sample, lengths), lengths + offsets.min())
    return shapes


def path_lengths(
    points: Points,
    seeds: NDArray[np.intp],
    offsets: NDArray[np.float64],
    neighbors: Neighbors | None = None,
) -> NDArray[np.float64]:
    """(n,) geodesic distances from the seeds, above the smallest of their offsets.

    offsets: distances at the seeds; neighbors: the NEIGHBORS nearest ones, where these are known.
    """
    graph, _, _ = connected_knn_graph(points, NEIGHBORS, neighbors)
    return geodesic_distances(graph, seeds, offsets - offsets.min())


def fit_spine(points: Points, lengths: NDArray[np.float64]) -> Spine:
    """The spine through an organ's level sets of geodesic distance, (n,), from its attachment.

    A node is the value at its level of a line fitted to the points around it, which is not biased
    at the ends; the line's slope is the tangent.
    """
    length = float(np.quantile(lengths, TIP_QUANTILE)) or 1.0
    along = np.clip(lengths / length, 0.0, 1.0)
    lag = along[None, :] - levels()[:, None]
    weight = np.exp(-0.5 * (lag / KERNEL_WIDTH) ** 2) + 1e-12
    total = weight.sum(axis=1)
    mean_lag = (weight * lag).sum(axis=1) / total
    mean_point = weight @ points / total[:, None]
    centered = weight * (lag - mean_lag[:, None])
    spread = (centered * (lag - mean_lag[:, None])).sum(axis=1) / total
    slope = centered @ points / total[:, None] / (spread[:, None] + 1e-4 * KERNEL_WIDTH**2)
    return Spine(mean_point - mean_lag[:, None] * slope, unit(slope), along)


def levels() -> NDArray[np.float64]:
    """(LEVELS,) the places of a spine's nodes."""
    return np.linspace(0.0, 1.0, LEVELS)


def at_levels(values: NDArray[np.float64], along: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values at the levels, (LEVELS, ...), interpolated linearly at (n,) places: (n, ...)."""
    place = np.clip(along, 0.0, 1.0) * (LEVELS - 1)
    before = np.minimum(place.astype(np.intp), LEVELS - 2)
    share = (place - before).reshape(-1, *[1] * (values.ndim - 1))
    return (1.0 - share) * values[before] + share * values[before + 1]


def unit(vectors: Points) -> Points:
    """Vectors at length 1, zeros upright."""
    norm = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(norm > 0, vectors / np.where(norm > 0, norm, 1.0), (0.0, 0.0, 1.0))


def _contact(
    sample: Points, radius: float, parent: OrganShape | None, base: NDArray[np.floating]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """The points where an organ touches its parent, and their distances from the plant base."""
    from scipy.spatial import cKDTree

    if parent is None:
        lowest = int(np.argmin(((sample - base) ** 2).sum(axis=1)))
        return np.array([lowest]), np.zeros(1)
    gap, touched = cKDTree(parent.points).query(sample)
    seeds = np.flatnonzero(gap <= gap.min() + radius)
    return seeds, parent.lengths[touched[seeds]] + gap[seeds]
