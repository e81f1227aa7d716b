"""Paths of organs between two scans: they deform, carry what grows on them, and stay attached.

Transport takes points near an organ's attachment point to points farther out, and the parent
deforms, too, so at mid-interval the organ may come off. It is then shifted, less so farther from
its attachment point, until it is as near to its parent as at the scans.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.movers import OrganMovers, shifted
from baker.interpolation.organ_attachments import Attachment, attachment
from baker.interpolation.organ_motion import OrganMotion
from baker.interpolation.resampling import position_at
from baker.interpolation.spine import at_levels
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

POINTS_COMPARED = 100  # of an organ that show where it touches its parent
MAX_WIDENING = 0.25  # point spacings by which a gap may widen; less is not seen
FOLLOWING_RADIUS = 0.5  # root mean square radii of an organ; nearer points follow its attachment

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

    def deviation(self, moved: OrganMovers, motion: OrganMotion | None) -> Deviation | None:
        """How one task's movers deviate; None where they go straight."""
        from scipy.spatial import cKDTree

        segment = self._segments.get(_track(moved), NO_PARENT)
        if motion is None or segment == self._scan.root:
            return None
        assert moved.start_points is not None
        starts = np.zeros((int(moved.start_points.max()) + 1, 3), np.float32)
        starts[moved.start_points] = moved.movers.curve[0]
        shift = motion.deviation(starts)[moved.start_points]
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


def attached(
    tasks: Sequence[OrganMovers],
    scan: Hierarchy,
    at_end: Mapping[int, Attachment],
    spacing: float,
) -> list[OrganMovers]:
    """The solved tasks of an interval, with organs that keep their distance from their parents.

    Parents come before their children, which follow them. Positions at the scans don't change; what
    is lost is left alone. scan, at_end: hierarchy and `attachments` of the second scan; spacing:
    the point spacing of the scans, in their unit.
    """
    from scipy.spatial import cKDTree

    done = list(tasks)
    place = {
        _track(moved): index
        for index, moved in enumerate(tasks)
        if len(moved.movers) and moved.end_points is not None
    }

    @cache
    def tree(index: int, u: float) -> "cKDTree":
        return cKDTree(position_at(done[index].movers.curve, u), balanced_tree=False)

    for segment in scan.from_the_root():
        parent = scan.parents[segment]
        index = place.get(scan.organs[segment])
        carrier = None if parent == NO_PARENT else place.get(scan.organs[parent])
        if index is not None and carrier is not None:
            gap = at_end[segment].gap
            done[index] = _attached(done[index], partial(tree, carrier), gap, spacing)
    return done


def _attached(
    moved: OrganMovers, parent: Callable[[float], "cKDTree"], gap_at_end: float, spacing: float
) -> OrganMovers:
    """An organ shifted at mid-interval; parent: its parent's movers at a share of the interval."""
    middle, start = position_at(moved.movers.curve, 0.5), moved.movers.curve[0]
    base, gap = attachment(middle, parent(0.5))
    if gap <= gap_at_end + MAX_WIDENING * spacing:
        return moved
    allowed = max(gap_at_end, attachment(start, parent(0.0)).gap)
    if gap <= allowed + MAX_WIDENING * spacing:
        return moved
    touched = parent(0.5).data[parent(0.5).query(middle[base])[1]]
    shift = (1.0 - allowed / gap) * (touched - middle[base])
    radius = FOLLOWING_RADIUS * np.sqrt(middle.var(axis=0).sum()) + 1e-30
    squared = ((middle - middle[base]) ** 2).sum(axis=1)
    return shifted(moved, np.exp(-squared / radius**2)[:, None] * shift)


def _track(moved: OrganMovers) -> int:
    return int(moved.movers.tracks[0]) if len(moved.movers) else -1
