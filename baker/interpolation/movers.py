"""The movers of an interval: their starts, ends and paths.

Organs deform between the two scans, and their children move with them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from baker.alignment.keyframes import Keyframe
from baker.geometry.up_axis import Vertical
from baker.interpolation.organ_motion import OrganMotion
from baker.interpolation.packing import Movers, elevate_degree
from baker.interpolation.resampling import Floats, Indices, with_even_density
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy
from baker.transport.correspondences import Correspondences
from baker.transport.tasks import Task
from gclip import Motion, SegmentPair

POINTS_COMPARED = 100  # of a child, to find its attachment point


@dataclass(frozen=True)
class OrganPaths:
    """The paths of the points of a matched or new organ."""

    task: Task
    plan: Correspondences  # of M pairs of points
    deviation: Floats | float = 0.0  # (M, 3) from straight paths at mid-interval
    child_deviations: Mapping[int, Floats] = field(default_factory=dict)  # organ -> (3,)

    def bud(self, contact: Indices, points: Floats) -> NDArray[np.intp]:
        """The (l,) points of the first scan from which an organ that is attached here unfolds.

        They are around the middle of the movers' starts that end in its (l,) contact, since some of
        these may be far away. points: (N, 3) of the first scan.
        """
        is_chosen = np.isin(self.task.end[self.plan.columns], contact, kind="table")
        starts = points.take(self.task.start[self.plan.rows[is_chosen]], axis=0)
        from_median = ((starts - np.median(starts, axis=0)) ** 2).sum(axis=1)
        offsets = points.take(self.task.start, axis=0) - starts[from_median.argmin()]
        count = min(len(contact), len(offsets))
        nearest = np.argpartition((offsets**2).sum(axis=1), count - 1)[:count]
        return self.task.start[np.sort(nearest)]

    @property
    def pair(self) -> SegmentPair:
        """The organ's entry in the clip's table of segment pairs."""
        task, plan = self.task, self.plan
        return SegmentPair(
            task.organ, task.event, len(task.start), len(task.end), len(plan.rows),
            plan.solver, plan.distance, plan.marginal_error, plan.notes,
        )  # fmt: skip


def organ_movers(
    organs: Sequence[OrganPaths], start: Keyframe, end: Keyframe, scan: Hierarchy, growth: float
) -> list[Movers]:
    """The movers of all matched and new organs of an interval.

    scan: the hierarchy of the second scan. growth: as in `with_even_density`; used if the keyframes
    have point areas.
    """
    # The points of both scans that movers start and end at.
    a = np.concatenate([organ.task.start[organ.plan.rows] for organ in organs], dtype=np.int32)
    b = np.concatenate([organ.task.end[organ.plan.columns] for organ in organs], dtype=np.int32)
    counts = [len(organ.plan.rows) for organ in organs]
    is_born = np.repeat([organ.task.shares_start for organ in organs], counts)
    curve = _curve(start.positions.take(a, axis=0), end.positions.take(b, axis=0), organs, scan)
    colors: tuple[NDArray[np.uint8] | None, NDArray[np.uint8] | None] = None, None
    if start.colors is not None and end.colors is not None:
        colors = start.colors.take(a, axis=0), end.colors.take(b, axis=0)
    normals = None
    if start.normals is not None and end.normals is not None:
        normals = np.hstack([start.normals.take(a, axis=0), end.normals.take(b, axis=0)])
        normals[is_born, :2] = normals[is_born, 2:]  # a new organ has no surface at the start
    tracks = np.repeat(np.array([organ.task.organ for organ in organs], np.int32), counts)
    movers = Movers(Motion.MOVE, curve, tracks, *colors, normals)
    if start.area is None or end.area is None:
        return [movers]
    # Several new organs may start at the same points, but share no area there.
    begins = np.cumsum([0, *(len(organ.task.start) for organ in organs[:-1])], dtype=np.int32)
    rows = np.concatenate([organ.plan.rows for organ in organs]) + np.repeat(begins, counts)
    area = mid_area(np.where(is_born, 0.0, start.area[a]), rows, end.area[b], b)
    return with_even_density(movers, area, rows, b, growth)


def _curve(
    start: Floats, end: Floats, organs: Sequence[OrganPaths], scan: Hierarchy
) -> tuple[Floats, ...]:
    """The curves of movers, with the deviations of their organs and of all these grow on."""
    attached: dict[int, Floats] = {}  # organ -> deviation of its attachment on the parent
    for organ in organs:
        attached |= organ.child_deviations
    shifts: dict[int, Floats] = {NO_PARENT: np.zeros(3)}  # segment -> sum along its ancestors
    for segment in scan.parents_first():
        own = attached.get(scan.organs[segment], np.zeros(3))
        shifts[segment] = shifts[scan.parents[segment]] + own
    by_track = {track: shifts[segment] for segment, track in enumerate(scan.organs)}
    control, stop, is_bent = elevate_degree((start, end), 2)[1], 0, False
    for organ in organs:
        shift = by_track[organ.task.organ] + organ.deviation
        begin, stop = stop, stop + len(organ.plan.rows)
        control[begin:stop] += 2.0 * shift  # its weight at mid-interval is 1/2
        is_bent = is_bent or bool(shift.any())
    return (start, control, end) if is_bent else (start, end)


def lost_organ_movers(
    task: Task, start: Keyframe, decay: Motion, vertical: Vertical, floor: float
) -> tuple[Movers, SegmentPair]:
    """The movers of a lost organ, and its entry in the table of segment pairs (section 3.3.1).

    They fall vertically to the height `floor`, unless they are below it, or stay in place until
    they have faded or are removed.
    """
    origin = start.positions.take(task.start, axis=0)
    lower = np.minimum(vertical.height(origin), floor)
    landing = vertical.at_height(origin, lower) if decay is Motion.FALL else origin
    colors = None if start.colors is None else start.colors.take(task.start, axis=0)
    drop = float(np.sqrt(((landing - origin) ** 2).sum(axis=1).mean()))
    normals = None if start.normals is None else np.tile(start.normals[task.start], 2)
    count, organ = len(origin), task.organ
    movers = Movers(decay, (origin, landing), np.full(count, organ), colors, colors, normals)
    return movers, SegmentPair(organ, task.event, count, 0, count, "identity", drop, 0.0)


def mid_area(before: Floats, a: Indices, after: Floats, b: Indices) -> NDArray[np.float64]:
    """(M,) area that each mover represents at mid-interval.

    The area of a point is divided among its movers. Lengths are averaged instead of areas.

    before, after: (M,) areas of the start and end points of the movers; a, b: (M,) their indices.
    """
    start = np.sqrt(before / np.bincount(a)[a])
    end = np.sqrt(after / np.bincount(b)[b])
    return ((start + end) / 2) ** 2


def child_deviations(
    organ: int, motion: OrganMotion, end: Floats, scan: Hierarchy
) -> dict[int, Floats]:
    """(3,) deviation at mid-interval of the attachment of each child of an organ, by track id.

    motion: of the organ. end, scan: (N, 3) points of the second scan, and its hierarchy.
    """
    from scipy.spatial import cKDTree

    tree, attached_to = cKDTree(motion.deformed), dict[int, int]()
    for child in scan.children(scan.organs.index(organ)):
        members = scan.segments[child]
        sample = members[:: max(1, len(members) // POINTS_COMPARED)]
        distances, nearest = tree.query(end.take(sample, axis=0))
        attached_to[scan.organs[child]] = int(nearest[np.argmin(distances)])
    shifts = motion.deviations[[*attached_to.values()]]
    return dict(zip(attached_to, shifts, strict=True))
