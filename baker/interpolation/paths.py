"""Paths of organs between two scans: they deform, and carry what grows on them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.movers import OrganMovers, shifted
from baker.interpolation.organ_motion import OrganMotion
from baker.interpolation.spine import at_levels
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

POINTS_COMPARED = 100  # of an organ that show where it touches its parent

Points = NDArray[np.floating]
Deviation = tuple[Points, dict[int, Points]]
"""Deviations at mid-interval: (M, 3) of movers, and (3,) of where each child is attached."""


class OrganPaths:
    """Finds how the organs of an interval deviate from straight paths.

    Straight go the root, and organs of few points.

    end: points of the second scan, (N, 3), and scan: its hierarchy.
    """

    def __init__(self, end: Points, scan: Hierarchy) -> None:
        self._end, self._scan = end, scan
        self._segments = {organ: segment for segment, organ in enumerate(scan.organs)}

    def deviation(
        self, organ: int, motion: OrganMotion | None, start: Points, rows: NDArray[np.integer]
    ) -> Deviation | None:
        """How movers from these rows of an organ deviate; None where they go straight."""
        from scipy.spatial import cKDTree

        segment = self._segments.get(organ, NO_PARENT)
        if motion is None or segment == self._scan.root:
            return None
        shift = motion.deviation(start).take(rows, axis=0)
        tree, touched = cKDTree(motion.deformed), dict[int, int]()
        for child, members in enumerate(self._scan.segments):
            if self._scan.parents[child] == segment and len(members):
                some = members[:: max(1, len(members) // POINTS_COMPARED)]
                distances, nearest = tree.query(self._end.take(some, axis=0))
                touched[child] = int(nearest[np.argmin(distances)])
        shifts = at_levels(motion.deviations, motion.along[[*touched.values()]])
        return shift, dict(zip(touched, shifts, strict=True))

    def curved(
        self, solved: Sequence[OrganMovers], deviations: Sequence[Deviation | None]
    ) -> list[OrganMovers]:
        """The solved tasks, carried along by their parents; those that deviate, on curves."""
        segments = [self._segments.get(_track(moved)) for moved in solved]
        of = {s: d for s, d in zip(segments, deviations, strict=True) if d is not None}
        carried: dict[int, Points] = {NO_PARENT: np.zeros(3)}
        for child in self._scan.from_the_root():
            parent = self._scan.parents[child]
            own = of[parent][1].get(child) if parent in of else None
            carried[child] = carried[parent] + (0.0 if own is None else own)
        done = []
        for moved, segment, deviation in zip(solved, segments, deviations, strict=True):
            if segment is not None and moved.start_points is not None:
                shift = np.broadcast_to(carried[segment], (len(moved.movers), 3))
                if deviation is not None:
                    shift = shift + deviation[0]
                moved = shifted(moved, shift) if shift.any() else moved
            done.append(moved)
        return done


def _track(moved: OrganMovers) -> int:
    return int(moved.movers.tracks[0]) if len(moved.movers) else -1
