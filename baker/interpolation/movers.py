"""The movers of an organ in one interval: their start, end and path.

Organs deform between the two scans, and their children move with them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.alignment.keyframes import Keyframe
from baker.geometry.up_axis import Vertical
from baker.interpolation.organ_motion import OrganMotion
from baker.interpolation.spine import at_levels
from baker.interpolation.timing import Timing
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy
from baker.transport.correspondences import Correspondences
from baker.transport.tasks import Task
from gclip import Motion, SegmentPair
from gclip.pack import Movers, elevate_degree

Floats = NDArray[np.floating]
Indices = NDArray[np.integer]
Deviation = tuple[Floats, dict[int, Floats]]
"""Deviations at mid-interval: (M, 3) of movers, and (3,) of each child organ's attachment."""

POINTS_COMPARED = 100  # of a child, to find its attachment point


@dataclass(frozen=True)
class OrganMovers:
    """The movers of one task."""

    movers: Movers
    pair: SegmentPair  # for the report
    area: Floats | None = None  # (M,) at mid-interval; None if no movers are to be added
    start_points: Indices | None = None  # (M,) numbers of the points of the task; None if lost
    end_points: Indices | None = None  # likewise
    deviation: Deviation | None = None  # from straight paths


def moving(
    task: Task, plan: Correspondences, start: Keyframe, end: Keyframe, timing: Timing | None = None
) -> OrganMovers:
    """The movers of a matched or new organ, from the correspondences of its points.

    timing: of a matched organ; by default movers move evenly.
    """
    a, b = task.start[plan.rows], task.end[plan.columns]
    origin, target = start.positions.take(a, axis=0), end.positions.take(b, axis=0)
    colors: tuple[NDArray[np.uint8] | None, NDArray[np.uint8] | None] = None, None
    if start.colors is not None and end.colors is not None:
        colors = start.colors.take(a, axis=0), end.colors.take(b, axis=0)
    born, area, normals = task.event == "birth", None, None
    if start.normals is not None and end.normals is not None:
        last = end.normals.take(b, axis=0)  # a new organ has no surface at the start
        normals = np.hstack([last if born else start.normals.take(a, axis=0), last])
    movers = Movers(Motion.MOVE, (origin, target), np.full(len(a), task.organ), *colors, normals)
    if start.area is not None and end.area is not None:
        area = mid_area(start.area[a], plan.rows, end.area[b], plan.columns, born)
    pair = _pair(task, len(a), plan.solver, plan.distance, plan.marginal_error, plan.notes)
    moved = OrganMovers(movers, pair, area, plan.rows, plan.columns)
    return moved if timing is None else shifted(moved, timing.shift(origin, target))


def shifted(moved: OrganMovers, shift: Floats) -> OrganMovers:
    """Shift movers on curves of degree 1 or 2 by (M, 3) at mid-interval."""
    origin, control, target = elevate_degree(moved.movers.curve, 2)
    # The weight of the control point at mid-interval is 1/2.
    curve = (origin, (control + 2.0 * shift).astype(np.float32), target)
    return replace(moved, movers=replace(moved.movers, curve=curve))


def leaving(
    task: Task, start: Keyframe, decay: Motion, vertical: Vertical, floor: float
) -> OrganMovers:
    """The movers of a lost organ (section 3.3.1 of the paper, decay).

    They fall vertically to the height `floor`, unless they are below it, or stay in place until
    they have faded or are removed.
    """
    origin = start.positions.take(task.start, axis=0)
    lower = np.minimum(vertical.height(origin), floor)
    landing = vertical.at_height(origin, lower) if decay is Motion.FALL else origin
    colors = None if start.colors is None else start.colors.take(task.start, axis=0)
    tracks = np.full(len(origin), task.organ)
    drop = float(np.sqrt(((landing - origin) ** 2).sum(axis=1).mean()))
    normals = None if start.normals is None else np.tile(start.normals[task.start], 2)
    movers = Movers(decay, (origin, landing), tracks, colors, colors, normals)
    return OrganMovers(movers, _pair(task, len(origin), "identity", drop, 0.0))


def mid_area(
    before: Floats, a: Indices, after: Floats, b: Indices, born: bool = False
) -> NDArray[np.float64]:
    """(M,) area that each mover represents at mid-interval.

    The area of a point is divided among its movers; a new organ has no area at the start. Lengths
    are averaged instead of areas.

    before, after: (M,) areas of the start and end points of the movers; a, b: (M,) their indices.
    """
    start = np.sqrt(before / np.bincount(a)[a])
    end = np.sqrt(after / np.bincount(b)[b])
    return (((0.0 if born else start) + end) / 2) ** 2


def _pair(
    task: Task, movers: int, solver: str, cost: float, error: float, notes: tuple[str, ...] = ()
) -> SegmentPair:
    points = len(task.start), len(task.end)
    return SegmentPair(task.organ, task.event, *points, movers, solver, cost, error, notes)


def deviation_of(
    organ: int, motion: OrganMotion, start: Floats, end: Floats, scan: Hierarchy
) -> Deviation:
    """The deviation of movers that start at (M, 3) points of an organ.

    end, scan: (N, 3) points of the second scan, and its hierarchy.
    """
    from scipy.spatial import KDTree

    tree, attached_to = KDTree(motion.deformed), dict[int, int]()
    for child in scan.children(scan.organs.index(organ)):
        members = scan.segments[child]
        if len(members):
            sample = members[:: max(1, len(members) // POINTS_COMPARED)]
            distances, nearest = tree.query(end.take(sample, axis=0))
            attached_to[scan.organs[child]] = int(nearest[np.argmin(distances)])
    shifts = at_levels(motion.deviations, motion.along[[*attached_to.values()]])
    return motion.deviation(start), dict(zip(attached_to, shifts, strict=True))


def with_deviations(solved: Sequence[OrganMovers], scan: Hierarchy) -> list[OrganMovers]:
    """Shift movers by the deviation of their organ and by those of what it grows on."""
    carried: dict[int, Floats] = {}  # organ -> deviation of its attachment
    for moved in solved:
        carried |= moved.deviation[1] if moved.deviation else {}
    shifts: dict[int, Floats] = {NO_PARENT: np.zeros(3)}  # segment -> sum along its ancestors
    for child in scan.from_the_root():
        shifts[child] = shifts[scan.parents[child]] + carried.get(scan.organs[child], 0.0)
    by_organ = {organ: shifts[segment] for segment, organ in enumerate(scan.organs)}
    result = []
    for moved in solved:
        shift = np.asarray(by_organ.get(moved.pair.track, np.zeros(3)))
        if moved.deviation is not None:
            shift = shift + moved.deviation[0]
        is_straight = moved.start_points is None or not shift.any()
        result.append(moved if is_straight else shifted(moved, shift))
    return result
