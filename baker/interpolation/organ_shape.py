"""The organs of one scan as the motion sees them: an even share of their points, and a spine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import nearest_neighbors
from baker.interpolation.spine import NEIGHBORS, Points, Spine, fit_spine, path_lengths
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

SAMPLE = 750
FEWEST = 40  # points below which an organ has no spine
CONTACT = 2.0  # spacings of the sample beyond the smallest gap that still touch the parent


@dataclass(frozen=True)
class OrganShape:
    """A segment of a scan: a sample of its points, and the spine through it.

    points: (n, 3) float64, n at most SAMPLE.
    lengths: (n,) path length from the root of the plant, as far as the organ's attachment counts.
    """

    points: Points
    spine: Spine
    lengths: NDArray[np.float64]


class Shapes:
    """Finds the shapes of a scan's organs, each when it is asked for first, from any thread.

    points: (N, 3) of the scan; base: (3,) where the plant leaves the ground.

    Path lengths run through the parents: an organ that leaves its parent over a long contact, as
    a grass leaf does its whorl, is measured from where it leaves it first.
    """

    def __init__(
        self, points: NDArray[np.floating], hierarchy: Hierarchy, base: NDArray[np.floating]
    ) -> None:
        self._points, self._hierarchy, self._base = points, hierarchy, base
        self._found: dict[int, OrganShape | None] = {NO_PARENT: None}

    def of(self, segment: int) -> OrganShape | None:
        """The shape of a segment; None where it has too few points."""
        for above in (*reversed(self._hierarchy.ancestors(segment)), segment):
            if above not in self._found:
                self._found[above] = self._shape(above)
        return self._found[segment]

    def _shape(self, segment: int) -> OrganShape | None:
        members = self._hierarchy.segments[segment]
        if len(members) < FEWEST:
            return None
        sample = self._points[members[_sample(len(members))]].astype(np.float64)
        neighbors = nearest_neighbors(sample, NEIGHBORS)
        above = self._found[self._hierarchy.parents[segment]]
        seeds, head = _contact(sample, CONTACT * neighbors.spacing, above, self._base)
        lengths = path_lengths(sample, seeds, head, neighbors)
        return OrganShape(sample, fit_spine(sample, lengths), lengths + head.min())


def _sample(count: int) -> NDArray[np.intp]:
    if count <= SAMPLE:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).permutation(count)[:SAMPLE])


def _contact(
    sample: Points, contact: float, parent: OrganShape | None, base: NDArray[np.floating]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """The points where an organ touches its parent, and how far along the plant those are.

    contact: how far beyond the smallest gap points still touch.
    """
    from scipy.spatial import cKDTree

    if parent is None:
        lowest = int(np.argmin(((sample - base) ** 2).sum(1)))
        return np.array([lowest]), np.zeros(1)
    gap, touched = cKDTree(parent.points).query(sample)
    seeds = np.flatnonzero(gap <= gap.min() + contact)
    return seeds, parent.lengths[touched[seeds]] + gap[seeds]
