"""Organs stay attached to their parents between two scans.

Transport takes points near an organ's attachment point to points farther out, and the parent
deforms, too, so between the scans the organ may come off. Its control points are shifted by
what keeps its attachment point, in the least-squares sense, as near to its parent as at the
scans.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.attachment import points_near
from baker.interpolation.movers import OrganMovers
from baker.interpolation.resampling import position_at
from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT
from baker.transport.tasks import Task
from gclip.evaluate import bernstein
from gclip.pack import raised

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

INSTANTS = (0.0, 0.25, 0.5, 0.75, 1.0)  # of an interval, at which distances are compared
MAX_WIDENING = 0.25  # point spacings by which a gap may widen; less is not seen
CONTACT_MARGIN = 2.0  # point spacings beyond the nearest point within which an organ is in contact
FOLLOWING_RADIUS = 0.5  # root mean square radii of an organ; nearer points follow its attachment


def attached(
    tasks: Sequence[OrganMovers], match: Match, organs: IntervalOrgans, spacing: float
) -> list[OrganMovers]:
    """The solved tasks of an interval, with organs that keep their distance from their parents.

    Parents come before their children, which follow them. Positions at the scans don't change; what
    is lost is left alone. spacing: the point spacing of the scans, in their unit.
    """
    done = list(tasks)
    place = {
        int(moved.movers.tracks[0]): index
        for index, moved in enumerate(tasks)
        if len(moved.movers) and moved.end_points is not None
    }
    trees: dict[int, tuple[cKDTree, ...]] = {}
    for segment in match.second.from_the_root():
        parent = match.second.parents[segment]
        if parent == NO_PARENT:
            continue
        index, carrier = (place.get(organs.second[s]) for s in (segment, parent))
        if index is None or carrier is None:
            continue
        if carrier not in trees:
            trees[carrier] = _trees(done[carrier])
        done[index] = _attached(done[index], trees[carrier], spacing)
    return done


def attachment_finder(
    clouds: tuple[NDArray[np.floating], NDArray[np.floating]], match: Match, organs: IntervalOrgans
) -> Callable[[Task], tuple[int, int] | None]:
    """A function that finds a task's points nearest to its parent, in both scans.

    It returns their indices within the task; None of roots, of what is not matched, and where a
    parent has no points.
    """
    from scipy.spatial import cKDTree

    hierarchies = match.first, match.second
    segments = {organs.second[b]: (a, b) for a, b in match.pairs}

    @cache
    def tree(side: int, parent: int) -> cKDTree:
        points = clouds[side].take(hierarchies[side].segments[parent], axis=0)
        return cKDTree(points, balanced_tree=False)

    def find(task: Task) -> tuple[int, int] | None:
        if task.event != "match":
            return None
        found = []
        for side, members in enumerate((task.start, task.end)):
            parent = hierarchies[side].parents[segments[task.organ][side]]
            if parent == NO_PARENT or not len(hierarchies[side].segments[parent]):
                return None
            near, distances = points_near(tree(side, parent), clouds[side].take(members, axis=0))
            found.append(int(near[np.argmin(distances)]))
        return found[0], found[1]

    return find


def _trees(moved: OrganMovers) -> tuple[cKDTree, ...]:
    """k-d trees of an organ's movers at each instant."""
    from scipy.spatial import cKDTree

    return tuple(cKDTree(position_at(moved.movers.curve, u), balanced_tree=False) for u in INSTANTS)


def _attached(moved: OrganMovers, parent: tuple[cKDTree, ...], spacing: float) -> OrganMovers:
    """An organ shifted between the scans, less so farther from its attachment point."""
    places = np.stack([position_at(moved.movers.curve, u) for u in INSTANTS]).astype(float)
    # Only what is near its parent at the scans or half-way can tell how far the organ comes off.
    margin = CONTACT_MARGIN * spacing
    close = [points_near(parent[k], places[k], margin)[0] for k in range(0, len(INSTANTS), 2)]
    near = np.unique(np.concatenate(close))
    found = [tree.query(points[near]) for tree, points in zip(parent, places, strict=True)]
    distances = np.stack([distance for distance, _ in found])
    gaps = distances.min(axis=1)
    allowed = max(gaps[0], gaps[-1])
    if gaps.max() <= allowed + MAX_WIDENING * spacing:
        return moved
    nearest = int(np.argmin(distances.sum(axis=0)))  # to its parent at all instants
    base, distances = int(near[nearest]), distances[:, nearest]
    touched = np.stack(
        [tree.data[touching[nearest]] for tree, (_, touching) in zip(parent, found, strict=True)]
    )
    shares = np.maximum(1.0 - allowed / np.maximum(distances, 1e-30), 0.0)
    shift = shares[:, None] * (touched - places[:, base])
    radius = FOLLOWING_RADIUS * np.sqrt(places.var(axis=1).sum(axis=1)) + 1e-30
    squared = ((places - places[:, [base]]) ** 2).sum(axis=2)
    following = np.exp(-squared / radius[:, None] ** 2)
    # The inner control points' one shift that comes closest to these at all instants.
    degree = max(2, len(moved.movers.curve) - 1)
    weight = np.array([bernstein(degree, u)[1:-1].sum() for u in INSTANTS])
    inner = np.einsum("k,kn,kd->nd", weight, following, shift) / (weight**2).sum()
    first, *control, last = raised(moved.movers.curve, degree)
    control = [(points + inner).astype(np.float32) for points in control]
    return replace(moved, movers=replace(moved.movers, curve=(first, *control, last)))
