"""Organs stay attached to their parents between two scans.

Transport takes points near an organ's attachment point to points farther out, and the parent
deforms, too, so at mid-interval the organ may come off. It is then shifted, less so farther from
its attachment point, until it is as near to its parent as at the scans.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from baker.interpolation.movers import OrganMovers, shifted
from baker.interpolation.organ_attachments import Attachment, attachment
from baker.interpolation.resampling import position_at
from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

MAX_WIDENING = 0.25  # point spacings by which a gap may widen; less is not seen
FOLLOWING_RADIUS = 0.5  # root mean square radii of an organ; nearer points follow its attachment


def attached(
    tasks: Sequence[OrganMovers],
    match: Match,
    organs: IntervalOrgans,
    at_end: Mapping[int, Attachment],
    spacing: float,
) -> list[OrganMovers]:
    """The solved tasks of an interval, with organs that keep their distance from their parents.

    Parents come before their children, which follow them. Positions at the scans don't change; what
    is lost is left alone. at_end: `attachments` of the second scan; spacing: the point spacing of
    the scans, in their unit.
    """
    from scipy.spatial import cKDTree

    done = list(tasks)
    place = {
        int(moved.movers.tracks[0]): index
        for index, moved in enumerate(tasks)
        if len(moved.movers) and moved.end_points is not None
    }

    @cache
    def tree(index: int, u: float) -> "cKDTree":
        return cKDTree(position_at(done[index].movers.curve, u), balanced_tree=False)

    for segment in match.second.from_the_root():
        parent = match.second.parents[segment]
        index = place.get(organs.second[segment])
        carrier = None if parent == NO_PARENT else place.get(organs.second[parent])
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
