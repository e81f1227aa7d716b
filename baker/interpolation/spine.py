"""The spine of an organ: how far each point is along it, and the curve through its level sets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph, geodesic_distances
from baker.geometry.neighbors import Neighbors

Points = NDArray[np.float64]

LEVELS = 11  # nodes of a spine
NEIGHBORS = 9  # that paths go through
TIP = 0.98  # the share of points that lie before the tip; the rest may be noise
BAND = 0.09  # width of a level's kernel, as a share of the length


@dataclass(frozen=True)
class Spine:
    """A curve from an organ's attachment (along = 0) to its tip (along = 1).

    nodes:    (LEVELS, 3) at even steps along.
    tangents: (LEVELS, 3) unit vectors towards the tip.
    along:    (n,) where each of the organ's points lies, in [0, 1].
    length:   of the path from attachment to tip through the organ's tissue.
    """

    nodes: Points
    tangents: Points
    along: NDArray[np.float64]
    length: float


def levels() -> NDArray[np.float64]:
    """(LEVELS,) the places of a spine's nodes."""
    return np.linspace(0.0, 1.0, LEVELS)


def path_lengths(
    points: Points,
    seeds: NDArray[np.intp],
    head_starts: NDArray[np.float64],
    neighbors: Neighbors | None = None,
) -> NDArray[np.float64]:
    """(n,) length of the shortest path through the points from the nearest seed.

    head_starts: (seeds,) what the path is long already where it enters at each seed.
    neighbors: the NEIGHBORS nearest ones of the points, where these are known.
    """
    graph, _, _ = connected_knn_graph(points, NEIGHBORS, neighbors)
    return geodesic_distances(graph, seeds, head_starts - head_starts.min())


def fit_spine(points: Points, lengths: NDArray[np.float64]) -> Spine:
    """The spine through an organ's level sets of path length.

    A node is the level's value of a line fitted to the points around the level, which leans
    neither in nor out at the ends; the line's slope is the tangent.
    """
    length = float(np.quantile(lengths, TIP)) or 1.0
    along = np.clip(lengths / length, 0.0, 1.0)
    place = levels()
    away = along[None, :] - place[:, None]
    weight = np.exp(-0.5 * (away / BAND) ** 2) + 1e-12
    total = weight.sum(1)
    mean_away = (weight * away).sum(1) / total
    mean_point = weight @ points / total[:, None]
    spread = (weight * (away - mean_away[:, None]) ** 2).sum(1) / total
    cross = (weight * (away - mean_away[:, None])) @ points / total[:, None]
    slope = cross / (spread[:, None] + 1e-4 * BAND**2)
    nodes = mean_point - mean_away[:, None] * slope
    return Spine(nodes, unit(slope), along, length)


def unit(vectors: Points) -> Points:
    """Vectors at length 1, zeros upright."""
    norm = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(norm > 0, vectors / np.where(norm > 0, norm, 1.0), (0.0, 0.0, 1.0))


def at_levels(values: NDArray[np.float64], along: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values at the levels, (LEVELS, ...), read between them: (n, ...)."""
    place = np.clip(along, 0.0, 1.0) * (LEVELS - 1)
    before = np.minimum(place.astype(np.intp), LEVELS - 2)
    share = (place - before).reshape(-1, *[1] * (values.ndim - 1))
    return (1.0 - share) * values[before] + share * values[before + 1]
