"""What has to be transported in one interval: matched segments, buds that unfold, organs lost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT

BUD_SHARE, BUD_MOST = 0.01, 100
BUD_LEAST = 3  # in a sparse scan more would stretch far along the bearer
SAMPLED = 10  # times as many points as the bud's bound how far it reaches


@dataclass(frozen=True)
class Task:
    """One segment's way through an interval, as point indices into the two scans.

    event: "match", "birth" (start is the bud) or "loss" (end is empty).
    """

    event: str
    organ: int
    start: NDArray[np.intp]
    end: NDArray[np.intp]


def interval_tasks(
    points: tuple[NDArray[np.floating], NDArray[np.floating]],
    match: Match,
    organs: IntervalOrgans,
    bud_points: int | None = None,
    bud_least: int = BUD_LEAST,
) -> list[Task]:
    """The tasks between two scans' (N, 3) points.

    bud_points: l, how many points a new organ unfolds from; by default 1 % of what it grows on, ...
    bud_least:  ... at least so many.

    Every point of the first scan starts a task's mover and every point of the second ends one.
    """
    first, second = match.first, match.second
    tasks = [
        Task("match", organs.second[b], first.segments[a], second.segments[b])
        for a, b in match.pairs
        if len(first.segments[a]) and len(second.segments[b])
    ]
    # A stem that meets a virtual, empty root has nothing to become, or to come from.
    emptied = [a for a, b in match.pairs if not len(second.segments[b])]
    filled = [b for a, b in match.pairs if not len(first.segments[a])]
    buds: dict[tuple[int | None, int], NDArray[np.intp]] = {}
    for segment in (*match.births, *filled):
        if not len(second.segments[segment]):
            continue
        place = _bud_place(match, segment)
        if place not in buds:
            buds[place] = _bud(points, match, *place, bud_points, bud_least)
        organ, members = organs.second[segment], second.segments[segment]
        tasks.append(Task("birth", organ, buds[place], members))
    nothing = np.empty(0, np.intp)
    lost = (*match.losses, *emptied)
    tasks += [Task("loss", organs.first[s], first.segments[s], nothing) for s in lost]
    return [task for task in tasks if len(task.start) or len(task.end)]


def _bud_place(match: Match, segment: int) -> tuple[int | None, int]:
    """Where a new segment unfolds: the first scan's segment, and the second's that grows there.

    A whole new subtree unfolds from one bud, on the nearest ancestor that both scans have; under
    an empty virtual root (None) the bud lies anywhere on the plant.
    """
    first, second = match.first, match.second
    base = segment
    ancestor = match.start_of(second.parents[base])
    while ancestor is None and second.parents[base] != NO_PARENT:
        base = second.parents[base]
        ancestor = match.start_of(second.parents[base])
    if ancestor is not None and not len(first.segments[ancestor]):
        ancestor = None
    return ancestor, base if len(second.segments[base]) else segment


def _bud(
    points: tuple[NDArray[np.floating], NDArray[np.floating]],
    match: Match,
    ancestor: int | None,
    base: int,
    bud_points: int | None,
    bud_least: int,
) -> NDArray[np.intp]:
    """Points of the first scan that a new segment unfolds from (section 3.3.1, growth).

    The l points nearest to the base, l = 1 % of the ancestor's, at least `bud_least`, at most 100;
    ties: lowest index.
    """
    from scipy.spatial import cKDTree

    candidates = np.arange(len(points[0])) if ancestor is None else match.first.segments[ancestor]
    count = bud_points or int(np.clip(round(BUD_SHARE * len(candidates)), bud_least, BUD_MOST))
    grown = points[1].take(match.second.segments[base], axis=0)
    tree = cKDTree(grown, balanced_tree=False)
    sample = candidates[:: max(1, len(candidates) // (SAMPLED * count))]
    nearest = np.sort(tree.query(points[0].take(sample, axis=0))[0])[:count]
    bound = 1.000001 * float(nearest[-1]) or np.inf
    own = points[0].take(candidates, axis=0)
    inside = _within(own, tree.mins, tree.maxes, bound)
    candidates = candidates[inside]
    distances, _ = tree.query(own[inside], distance_upper_bound=bound)
    return candidates[np.argsort(distances, kind="stable")[:count]]


def _within(
    points: NDArray[np.floating],
    low: NDArray[np.floating],
    high: NDArray[np.floating],
    bound: float,
) -> NDArray[np.intp]:
    """Which of (n, 3) points are no farther than the bound from a box, along each axis."""
    inside = np.ones(len(points), bool)
    for axis in range(3):
        place = points[:, axis]
        inside &= (place >= low[axis] - bound) & (place <= high[axis] + bound)
    return np.flatnonzero(inside)
