"""A hierarchy drawn as a graph, growing upwards from its root (the paper's Figure 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

MAX_NUMBERED_NODES = 40


@dataclass(frozen=True)
class Graph:
    """A drawing of a hierarchy, in pixels from the top left corner."""

    places: NDArray[np.float64]  #: (S, 2) x and y of each segment's node
    radius: float  #: of a node
    size: tuple[float, float]  #: width and height

    @property
    def numbered(self) -> bool:
        """Whether there is room for numbers in the nodes."""
        return len(self.places) <= MAX_NUMBERED_NODES


def draw_tree(hierarchy: Hierarchy, organs: Sequence[int]) -> Graph:
    """Draw the hierarchy alone, its root at the bottom; children in the order of their organs."""
    places = tree_layout(hierarchy, organs)
    few = len(places) <= MAX_NUMBERED_NODES
    radius, column, row = (13.0, 38.0, 72.0) if few else (5.0, 13.0, 44.0)
    margin = radius + (16.0 if few else 6.0)  # with room for the segments' own numbers
    width, height = (places.max(axis=0) * [column, row]).tolist()
    pixels = margin + np.column_stack([column * places[:, 0], height - row * places[:, 1]])
    return Graph(pixels.round(1), radius, (2 * margin + width, 2 * margin + height))


def draw_over(places: NDArray[np.float64], size: tuple[float, float]) -> Graph:
    """Draw the hierarchy on top of a picture, each segment at its (x, y) of (S, 2) `places`."""
    radius = (0.020 if len(places) <= MAX_NUMBERED_NODES else 0.010) * max(size)
    return Graph(places.round(1), radius, size)


def segment_centers(hierarchy: Hierarchy, points: NDArray[np.floating]) -> NDArray[np.float64]:
    """(S, 3) the point of each segment nearest to its mean; of an empty root the plant's mean."""
    centers = np.tile(points.mean(axis=0, dtype=float), (len(hierarchy.segments), 1))
    for segment, members in enumerate(hierarchy.segments):
        if len(members):
            cloud = points[members].astype(float)
            centers[segment] = cloud[((cloud - cloud.mean(axis=0)) ** 2).sum(axis=1).argmin()]
    return centers


def tree_layout(hierarchy: Hierarchy, organs: Sequence[int]) -> NDArray[np.float64]:
    """(S, 2) column and depth of each segment: leaves in a row, a parent amid its children."""
    children: list[list[int]] = [[] for _ in hierarchy.segments]
    for segment in sorted(range(len(organs)), key=lambda s: (organs[s], s)):
        if hierarchy.parents[segment] != NO_PARENT:
            children[hierarchy.parents[segment]].append(segment)
    places = np.zeros((len(organs), 2))
    depth_first, stack = [], [hierarchy.root]
    while stack:
        segment = stack.pop()
        depth_first.append(segment)
        stack += reversed(children[segment])
        places[children[segment], 1] = places[segment, 1] + 1
    leaves = [segment for segment in depth_first if not children[segment]]
    places[leaves, 0] = np.arange(len(leaves))
    for segment in reversed(depth_first):
        if own := children[segment]:
            places[segment, 0] = (places[own[0], 0] + places[own[-1], 0]) / 2
    return places
