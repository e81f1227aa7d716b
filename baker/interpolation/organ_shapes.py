"""The shapes of a scan's organs: coordinates along and across each, from its attachment on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import nearest_neighbors
from baker.interpolation.organ_attachments import Attachments
from baker.interpolation.spine import (
    MIN_POINTS_FOR_SPINE,
    NEIGHBORS,
    Points,
    Spine,
    fit_spine,
    path_lengths,
    sampled,
)
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy


@dataclass(frozen=True)
class OrganShape:
    """A segment of a scan: a sample of its points, and the spine through it."""

    points: Points  # (n, 3), at most MAX_SAMPLE
    spine: Spine
    attachment: Points  # (3,)
    nodes: dict[int, float] = field(default_factory=dict)  # by child organ, where it is attached

    @property
    def length(self) -> float:
        """Of the spine."""
        return float(np.linalg.norm(np.diff(self.spine.nodes, axis=0), axis=1).sum())


def organ_shapes(
    points: NDArray[np.floating],
    hierarchy: Hierarchy,
    base: NDArray[np.floating],
    attachments: Attachments,
    names: Mapping[int, int],
    segments: Iterable[int],
) -> dict[int, OrganShape]:
    """The shapes of organs of a scan that have enough points, by organ.

    Parameters
    ----------
    points : (N, 3) float ndarray
    hierarchy : Hierarchy
    base : (3,) float ndarray
        The plant base, from which the root's spine begins.
    attachments : mapping of int to (3,) float ndarray
        By organ; those without one have no shape.
    names : mapping of int to int
        The organ of each segment.
    segments : iterable of int
        Those whose shapes are wanted.
    """
    from scipy.spatial import KDTree

    shapes: dict[int, OrganShape] = {}
    for segment in segments:
        members, organ = hierarchy.segments[segment], names[segment]
        start = base if hierarchy.parents[segment] == NO_PARENT else attachments.get(organ)
        if start is not None and len(members) >= MIN_POINTS_FOR_SPINE:
            sample = points[sampled(members)].astype(np.float64)
            seed = int(np.argmin(((sample - start) ** 2).sum(axis=1)))
            lengths = path_lengths(sample, seed, nearest_neighbors(sample, NEIGHBORS))
            shapes[organ] = OrganShape(sample, fit_spine(sample, lengths), sample[seed])
    for segment, parent in enumerate(hierarchy.parents):
        place, above = attachments.get(names[segment]), shapes.get(names.get(parent, NO_PARENT))
        if place is not None and above is not None:
            nearest = KDTree(above.points).query(place)[1]
            above.nodes[names[segment]] = float(above.spine.along[nearest])
    return shapes
