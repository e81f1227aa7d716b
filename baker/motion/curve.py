"""Movers of organs that bend or turn go on curves: each organ's own, and that of what bears it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.interval import Moved
from baker.match import IntervalOrgans, Match
from baker.motion.organ import OrganMotion, fit_motion
from baker.motion.shape import OrganShape, organ_shapes
from baker.segment.hierarchy import NO_PARENT, Hierarchy
from baker.workers import ALONE, Crew
from gclip.pack import raised

MOST = 0.25  # of the way that movers go, that they bow by: turning by a right angle takes 0.21
ASKED = 50  # points of an organ that bound how far it is from its bearer
MATTERS = 0.25  # point spacings; a smaller bow is below what the scan shows

Motions = dict[int, OrganMotion]  # of an interval's bending organs, by segment of the second scan


def organ_motions(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    bases: Sequence[NDArray[np.floating]],
    spacing: float,
    crew: Crew = ALONE,
) -> list[Motions]:
    """For each interval, by segment of its second scan, how the organs that bend or turn move.

    bases: (3,) where the plant leaves the ground in each scan.

    The root stands, and what has too few points or hardly bends goes straight: they are left out.
    """
    sides = [
        (k + side, hierarchy, [pair[side] for pair in match.pairs])
        for k, match in enumerate(matches)
        for side, hierarchy in enumerate((match.first, match.second))
    ]

    def shapes_of(side: tuple[int, Hierarchy, list[int]]) -> list[OrganShape | None]:
        scan, hierarchy, matched = side
        return organ_shapes(clouds[scan], hierarchy, bases[scan], matched)

    shapes = iter(crew.map(shapes_of, sides))
    pairs: list[tuple[int, int, OrganShape, OrganShape]] = []
    for k, match in enumerate(matches):
        before, after = next(shapes), next(shapes)
        for a, b in match.pairs:
            one, two = before[a], after[b]
            if a != match.first.root and b != match.second.root and one and two:
                pairs.append((k, b, one, two))
    fitted = crew.map(lambda pair: fit_motion(pair[2], pair[3], MATTERS * spacing), pairs)
    motions: list[Motions] = [{} for _ in matches]
    for (k, b, _, _), motion in zip(pairs, fitted, strict=True):
        if motion is not None:
            motions[k][b] = motion
    return motions


def curved(
    solved: Sequence[Sequence[Moved]],
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    motions: Sequence[Motions],
) -> list[list[Moved]]:
    """The solved tasks of each interval, what bends on curves of degree 2, the rest as it was.

    An organ is carried along, as a whole, by what it grows from.
    """
    return [
        _interval(tasks, clouds[k : k + 2], matches[k], organs[k], motions[k])
        if motions[k]
        else [*tasks]
        for k, tasks in enumerate(solved)
    ]


def _interval(
    tasks: Sequence[Moved],
    clouds: Sequence[NDArray[np.floating]],
    match: Match,
    organs: IntervalOrgans,
    motions: Motions,
) -> list[Moved]:
    segments = {organs.second[b]: b for b in match.second.from_the_root()}
    found = [segments.get(int(m.movers.tracks[0])) if len(m.movers) else None for m in tasks]
    bows: dict[int, NDArray[np.float64]] = {}
    for moved, segment in zip(tasks, found, strict=True):
        if segment in motions and moved.start_points is not None and not moved.born:
            bow = motions[segment].bow(clouds[0][moved.start_points])
            if _to_be_trusted(bow, moved):
                bows[segment] = bow
    carried = _carried(clouds[1], match, {b: motions[b] for b in bows})
    done = []
    for moved, segment in zip(tasks, found, strict=True):
        if segment is None or moved.start_points is None:
            done.append(moved)
            continue
        shift = np.broadcast_to(carried[segment], (len(moved.movers), 3))
        if segment in bows and not moved.born:
            shift = shift + bows[segment]
        done.append(_bowed(moved, shift) if shift.any() else moved)
    return done


def _to_be_trusted(bow: NDArray[np.float64], moved: Moved) -> bool:
    """Whether movers go far enough for such a bow, (M, 3): else the spine was found wrongly."""
    way = moved.movers.curve[-1].astype(float) - moved.movers.curve[0]
    return bool((bow**2).sum() <= MOST**2 * (way**2).sum())


def _carried(
    end: NDArray[np.floating], match: Match, motions: Motions
) -> dict[int, NDArray[np.float64]]:
    """(3,) for each segment of the second scan: the bow of what bears it, where that does."""
    from scipy.spatial import cKDTree

    carried: dict[int, NDArray[np.float64]] = {}
    trees = {segment: cKDTree(motion.warped) for segment, motion in motions.items()}
    for segment in match.second.from_the_root():
        parent = match.second.parents[segment]
        carried[segment] = np.zeros(3) if parent == NO_PARENT else carried[parent]
        own = end[match.second.segments[segment]]
        if parent in motions and len(own):
            bearer, tree = motions[parent], trees[parent]
            # A few bound the gap, and the search ends there: most points are farther.
            some = own[:: max(1, len(own) // ASKED)]
            bound = 1.000001 * float(tree.query(some)[0].min()) or np.inf
            gaps, touched = tree.query(own, distance_upper_bound=bound)
            base = bearer.sample[touched[[int(np.argmin(gaps))]]]
            carried[segment] = carried[segment] + bearer.bow(base)[0]
    return carried


def _bowed(moved: Moved, bow: NDArray[np.floating]) -> Moved:
    """Movers whose middle is shifted: the control point of degree 2 counts half there."""
    origin, control, target = raised(moved.movers.curve, 2)
    curve = (origin, (control + 2.0 * bow).astype(np.float32), target)
    return replace(moved, movers=replace(moved.movers, curve=curve))
