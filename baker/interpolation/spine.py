"""The spine of an organ: the curve through the level sets of geodesic distance within it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph, geodesic_distances

Points = NDArray[np.float64]

LEVELS = 11  # nodes of a spine
NEIGHBORS = 9  # of the kNN graph
TIP_QUANTILE = 0.98  # of geodesic distance, at which the tip lies; what is beyond may be noise
KERNEL_WIDTH = 0.09  # of a level, as a share of the spine's length
MAX_SAMPLE = 400  # points of an organ that its spine is fitted to
MIN_POINTS_FOR_SPINE = 12


@dataclass(frozen=True)
class Spine:
    """A curve from an organ's attachment (along = 0) to its tip (along = 1)."""

    nodes: Points  # (LEVELS, 3), at even steps along
    tangents: Points  # (LEVELS, 3), unit vectors towards the tip
    along: NDArray[np.float64]  # (n,), where each of the organ's points lies, 0 to 1


def sampled(members: NDArray[np.intp]) -> NDArray[np.intp]:
    """At most MAX_SAMPLE of an organ's points, the same ones every time."""
    if len(members) <= MAX_SAMPLE:
        return members
    chosen = np.random.default_rng(0).permutation(len(members))[:MAX_SAMPLE]
    return members[np.sort(chosen)]


def path_lengths(
    points: Points, seeds: NDArray[np.intp], offsets: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(n,) geodesic distances from the seeds, above the smallest of their offsets."""
    graph, _, _ = connected_knn_graph(points, NEIGHBORS)
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
