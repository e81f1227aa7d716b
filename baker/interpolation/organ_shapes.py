"""The shapes of a scan's organs: coordinates along and across each, from its attachment on."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.organ_attachments import Attachments
from baker.interpolation.spine import (
    MIN_POINTS_FOR_SPINE,
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
    lengths: NDArray[np.float64]  # (n,), geodesic distances from the plant base
    # by child organ, which of these points it is attached at
    nodes: dict[int, int] = field(default_factory=dict)

    @property
    def length(self) -> float:
        """Of the spine."""
        return float(np.linalg.norm(np.diff(self.spine.nodes, axis=0), axis=1).sum())


def organ_shapes(
    points: NDArray[np.floating],
    hierarchy: Hierarchy,
    base: NDArray[np.floating],
    attachments: Attachments,
    segments: Iterable[int],
) -> dict[int, OrganShape]:
    """The shapes of organs of a scan, (N, 3), that have enough points and an attachment, by organ.

    Geodesics run through the parents, from the plant base, (3,): an organ that leaves its parent
    over a long contact, as a grass leaf does its whorl, is measured from where it leaves it first.
    segments: those whose shapes, and whose ancestors', are wanted.
    """
    from scipy.spatial import KDTree

    shapes: dict[int, OrganShape] = {}
    needed = {above for segment in segments for above in (segment, *hierarchy.ancestors(segment))}
    for segment in hierarchy.from_the_root():
        members, parent = hierarchy.segments[segment], hierarchy.parents[segment]
        organ = hierarchy.organs[segment]
        above = None if parent == NO_PARENT else shapes.get(hierarchy.organs[parent])
        if segment not in needed or len(members) < MIN_POINTS_FOR_SPINE:
            continue
        contact = base[None] if parent == NO_PARENT else attachments.get(organ)
        if contact is None:
            continue
        sample = points[sampled(members)].astype(np.float64)
        seeds = np.unique(KDTree(sample).query(contact)[1])
        offsets = np.zeros(len(seeds))
        if above is not None:
            gaps, touched = KDTree(above.points).query(sample[seeds])
            offsets = above.lengths[touched] + gaps
            above.nodes[organ] = int(touched[np.argmin(offsets)])
        lengths = path_lengths(sample, seeds, offsets)
        attachment = sample[seeds[np.argmin(offsets)]]
        spine = fit_spine(sample, lengths)
        shapes[organ] = OrganShape(sample, spine, attachment, offsets.min() + lengths)
    return shapes
