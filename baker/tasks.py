"""What has to be transported in one interval: matched segments, buds that unfold, organs lost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.match import IntervalOrgans, Match
from baker.missing import Part
from baker.segment.hierarchy import NO_PARENT
from gclip.clip import Motion

BUD_SHARE, BUD_LEAST, BUD_MOST = 0.01, 10, 100


@dataclass(frozen=True)
class Task:
    """One segment's way through an interval, as point indices into the two scans.

    event: "match", "birth" (start is the bud), "loss" (end is empty), or "part": of a matched
           organ a part is lost, and leaves in its own way.
    leaves: how a part goes; notes: for the report.
    """

    event: str
    organ: int
    start: NDArray[np.intp]
    end: NDArray[np.intp]
    leaves: Motion | None = None
    notes: tuple[str, ...] = ()


def interval_tasks(
    points: tuple[NDArray[np.floating], NDArray[np.floating]],
    match: Match,
    organs: IntervalOrgans,
    bud_points: int | None = None,
    parts: Sequence[Part] = (),
) -> list[Task]:
    """The tasks between two scans' (N, 3) points.

    parts: what matched organs lose.
    bud_points: l, how many points a new organ unfolds from; by default 1 % of what it grows on.

    Every point of the first scan starts a task's mover and every point of the second ends one.
    """
    first, second = match.first, match.second
    tasks = [
        Task("match", organs.second[b], first.segments[a], second.segments[b])
        for a, b in match.pairs
    ]
    for segment in match.births:
        bud = _bud(points, match, segment, bud_points)
        tasks.append(Task("birth", organs.second[segment], bud, second.segments[segment]))
    nothing = np.empty(0, np.intp)
    tasks += [Task("loss", organs.first[s], first.segments[s], nothing) for s in match.losses]
    for part in parts:
        tasks = [task if task.organ != part.organ else _without(task, part) for task in tasks]
        tasks.append(Task("part", part.organ, part.points, nothing, part.leaves))
    return [task for task in tasks if len(task.start) or len(task.end)]


def _without(task: Task, part: Part) -> Task:
    kept = np.setdiff1d(task.start, part.points, assume_unique=True)
    return replace(task, start=kept, notes=(*task.notes, part.note))


def _bud(
    points: tuple[NDArray[np.floating], NDArray[np.floating]],
    match: Match,
    segment: int,
    bud_points: int | None,
) -> NDArray[np.intp]:
    """Points of the first scan that a new segment unfolds from (section 3.3.1, growth).

    A whole new subtree unfolds from one bud, on the nearest ancestor that both scans have; under
    an empty virtual root the bud lies anywhere on the plant. The bud is the l points nearest to
    the subtree's base, l = 1 % of the ancestor's, at least 10, at most 100; ties: lowest index.
    """
    from scipy.spatial import cKDTree

    first, second = match.first, match.second
    base = segment
    ancestor = match.start_of(second.parents[base])
    while ancestor is None and second.parents[base] != NO_PARENT:
        base = second.parents[base]
        ancestor = match.start_of(second.parents[base])
    candidates = np.arange(len(points[0]))
    if ancestor is not None and len(first.segments[ancestor]):
        candidates = first.segments[ancestor]
    target = second.segments[base if len(second.segments[base]) else segment]
    distances, _ = cKDTree(points[1][target]).query(points[0][candidates])
    count = bud_points or int(np.clip(round(BUD_SHARE * len(candidates)), BUD_LEAST, BUD_MOST))
    return candidates[np.argsort(distances, kind="stable")[:count]]
