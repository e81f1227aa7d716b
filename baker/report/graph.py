"""A hierarchy drawn as a graph, growing upwards from its root (the paper's Figure 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

READABLE = 40  # nodes up to which each gets its number


@dataclass(frozen=True)
class Node:
    """One segment: its place in the drawing, in pixels from the top left corner."""

    segment: int
    organ: int
    points: int
    x: float
    y: float
    parent: int | None


@dataclass(frozen=True)
class Graph:
    """A drawing of nodes; `radius` and `size` (width, height) in pixels."""

    nodes: tuple[Node, ...]
    radius: float
    size: tuple[float, float]

    @property
    def readable(self) -> bool:
        """Whether there is room for numbers in the nodes."""
        return len(self.nodes) <= READABLE

    @property
    def edges(self) -> list[tuple[Node, Node]]:
        """Parent and child of each edge."""
        return [(self.nodes[n.parent], n) for n in self.nodes if n.parent is not None]


def draw_tree(hierarchy: Hierarchy, organs: Sequence[int]) -> Graph:
    """The hierarchy alone, its root at the bottom.

    organs: of each segment; children stand in their order, so that scans compare at a glance.
    """
    places = tree_layout(hierarchy, organs)
    few = len(places) <= READABLE
    radius, column, row = (13.0, 38.0, 72.0) if few else (5.0, 13.0, 44.0)
    wide, deep = places.max(axis=0)
    margin = radius + (16.0 if few else 6.0)  # with room for the segments' own numbers
    x = margin + column * places[:, 0]
    y = margin + row * (deep - places[:, 1])
    size = (2 * margin + column * wide, 2 * margin + row * deep)
    return Graph(_nodes(hierarchy, organs, np.column_stack([x, y])), radius, size)


def draw_over(
    hierarchy: Hierarchy,
    organs: Sequence[int],
    places: NDArray[np.floating],
    size: tuple[float, float],
) -> Graph:
    """The hierarchy on top of a picture, each segment at its (x, y) of (S, 2) `places`."""
    radius = (0.020 if len(places) <= READABLE else 0.010) * max(size)
    return Graph(_nodes(hierarchy, organs, places), radius, size)


def middles(hierarchy: Hierarchy, points: NDArray[np.floating]) -> NDArray[np.float64]:
    """(S, 3) a point of each segment near its middle; an empty root stands at the plant's mean."""
    found = np.tile(points.mean(axis=0, dtype=float), (len(hierarchy.segments), 1))
    for segment, members in enumerate(hierarchy.segments):
        if len(members):
            cloud = points[members].astype(float)
            found[segment] = cloud[((cloud - cloud.mean(axis=0)) ** 2).sum(axis=1).argmin()]
    return found


def tree_layout(hierarchy: Hierarchy, organs: Sequence[int]) -> NDArray[np.float64]:
    """(S, 2) column and depth of each segment: leaves side by side, a parent amid its children."""
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
        for child in children[segment]:
            places[child, 1] = places[segment, 1] + 1
    leaves = [segment for segment in depth_first if not children[segment]]
    places[leaves, 0] = np.arange(len(leaves))
    for segment in reversed(depth_first):
        if own := children[segment]:
            places[segment, 0] = (places[own[0], 0] + places[own[-1], 0]) / 2
    return places


def _nodes(
    hierarchy: Hierarchy, organs: Sequence[int], places: NDArray[np.floating]
) -> tuple[Node, ...]:
    return tuple(
        Node(
            segment=segment,
            organ=organs[segment],
            points=len(hierarchy.segments[segment]),
            x=round(float(places[segment, 0]), 1),
            y=round(float(places[segment, 1]), 1),
            parent=None if parent == NO_PARENT else parent,
        )
        for segment, parent in enumerate(hierarchy.parents)
    )
