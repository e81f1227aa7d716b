"""The spine of an organ: how far each point is along it, and the curve through its level sets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

LEVELS = 11  # nodes of a spine
GRAPH_NEIGHBORS = 10
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


Neighbours = tuple[NDArray[np.float64], NDArray[np.intp]]


def neighbours(points: Points) -> Neighbours:
    """(n, k) how far the nearest of (n, 3) points are from each, and which they are; itself first.

    Up to GRAPH_NEIGHBORS of them.
    """
    from scipy.spatial import cKDTree

    tree = cKDTree(points, balanced_tree=False)
    apart, near = tree.query(points, k=min(GRAPH_NEIGHBORS, len(points)))
    return apart.reshape(len(points), -1), near.reshape(len(points), -1)


def path_lengths(
    points: Points,
    seeds: NDArray[np.intp],
    head_starts: NDArray[np.float64],
    around: Neighbours | None = None,
) -> NDArray[np.float64]:
    """(n,) length of the shortest path through the points from the nearest seed.

    head_starts: (seeds,) what the path is long already where it enters at each seed.
    around: the points' `neighbours`, where these are known.

    Parts of the neighbour graph that no seed is in are joined by their shortest gaps.
    """
    from scipy.sparse import coo_matrix, csr_matrix
    from scipy.sparse.csgraph import connected_components, dijkstra
    from scipy.spatial import cKDTree

    count = len(points)
    apart, near = around or neighbours(points)
    tiny = 1e-9 * float(apart.max() or 1.0)
    weights = np.concatenate([apart.ravel(), head_starts - head_starts.min()]) + tiny
    columns = np.concatenate([near.ravel(), seeds])
    ends = np.append(near.shape[1] * np.arange(count + 1), len(columns))
    graph = csr_matrix((weights, columns, ends), (count + 1, count + 1))
    while True:
        parts, part = connected_components(graph, directed=False)
        if parts == 1:
            break
        joined = []
        for lone in set(range(parts)) - {int(part[count])}:
            inside = np.flatnonzero(part[:count] == lone)
            outside = np.flatnonzero(part[:count] != lone)
            gap, nearest = cKDTree(points[outside]).query(points[inside])
            best = int(np.argmin(gap))
            joined.append((gap[best] + tiny, inside[best], outside[nearest[best]]))
        gaps, rows, columns = (np.array(values) for values in zip(*joined, strict=True))
        graph = graph + coo_matrix((gaps, (rows, columns)), graph.shape).tocsr()
    return dijkstra(graph, directed=False, indices=count)[:count]


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
