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
    carried = _carried(clouds[1], match, motions)
    segments = {organs.second[b]: b for b in carried}
    done = []
    for moved in tasks:
        segment = segments.get(int(moved.movers.tracks[0])) if len(moved.movers) else None
        if segment is None or moved.start_points is None:
            done.append(moved)
            continue
        bow = np.broadcast_to(carried[segment], (len(moved.movers), 3))
        if segment in motions and not moved.born:
            bow = bow + motions[segment].bow(clouds[0][moved.start_points])
        done.append(_bowed(moved, bow) if bow.any() else moved)
    return done


def _carried(
    end: NDArray[np.floating], match: Match, motions: Motions
) -> dict[int, NDArray[np.float64]]:
    """(3,) for each segment of the second scan: the bow of what bears it, where that does."""
    from scipy.spatial import cKDTree

    carried: dict[int, NDArray[np.float64]] = {}
    for segment in match.second.from_the_root():
        parent = match.second.parents[segment]
        carried[segment] = np.zeros(3) if parent == NO_PARENT else carried[parent]
        own = end[match.second.segments[segment]]
        if parent in motions and len(own):
            bearer = motions[parent]
            tree = cKDTree(bearer.warped)
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
