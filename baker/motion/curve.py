"""Movers of organs that bend or turn go on curves: each organ's own, and that of what bears it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from baker.interval import Moved
from baker.match import IntervalOrgans, Match
from baker.motion.organ import OrganMotion, fit_motion
from baker.motion.shape import OrganShape, organ_shapes
from baker.segment.hierarchy import NO_PARENT
from baker.workers import ALONE, Crew
from gclip.pack import raised

MOST = 0.25  # of the way that movers go, that they bow by: turning by a right angle takes 0.21
ASKED = 50  # points of an organ that bound how far it is from its bearer
MATTERS = 0.25  # point spacings; a smaller bow is below what the scan shows


Motions = dict[int, OrganMotion]  # of an interval's bending organs, by segment of the second scan
Shapes = list[OrganShape | None]


def shaping(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    bases: Sequence[NDArray[np.floating]],
) -> list[Callable[[], Shapes]]:
    """For each interval's first and second scan what finds its organs' shapes once it is called.

    bases: (3,) where the plant leaves the ground in each scan.
    """
    return [
        partial(
            organ_shapes,
            clouds[k + side],
            hierarchy,
            bases[k + side],
            [pair[side] for pair in match.pairs],
        )
        for k, match in enumerate(matches)
        for side, hierarchy in enumerate((match.first, match.second))
    ]


def organ_motions(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    bases: Sequence[NDArray[np.floating]],
    spacing: float,
    crew: Crew = ALONE,
    known: Sequence[Shapes] | None = None,
) -> list[Motions]:
    """For each interval, by segment of its second scan, how the organs that bend or turn move.

    bases: (3,) where the plant leaves the ground in each scan.
    known: what `shaping` finds, where that is known.

    The root stands, and what has too few points or hardly bends goes straight: they are left out.
    """
    if known is None:
        known = crew.map(lambda find: find(), shaping(clouds, matches, bases))
    shapes = iter(known)
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
    crew: Crew = ALONE,
) -> list[list[Moved]]:
    """The solved tasks of each interval, what bends on curves of degree 2, the rest as it was.

    An organ is carried along, as a whole, by what it grows from.
    """
    return [
        _interval(tasks, clouds[k : k + 2], matches[k], organs[k], motions[k], crew)
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
    crew: Crew,
) -> list[Moved]:
    segments = {organs.second[b]: b for b in match.second.from_the_root()}
    found = [segments.get(int(m.movers.tracks[0])) if len(m.movers) else None for m in tasks]
    bending = [
        (segment, moved)
        for moved, segment in zip(tasks, found, strict=True)
        if segment is not None
        and segment in motions
        and moved.start_points is not None
        and not moved.born
    ]
    borne: dict[int, list[int]] = {}
    for child in match.second.from_the_root():
        borne.setdefault(match.second.parents[child], []).append(child)

    def bend(which: tuple[int, Moved]) -> Bend | None:
        segment, moved = which
        members = {child: match.second.segments[child] for child in borne.get(segment, ())}
        return _bend(motions[segment], moved, clouds, members)

    bends = crew.map(bend, bending)
    bows = {b: bow for (b, _), bow in zip(bending, bends, strict=True) if bow is not None}
    carried = _carried(match, bows)
    done = []
    for moved, segment in zip(tasks, found, strict=True):
        if segment is None or moved.start_points is None:
            done.append(moved)
            continue
        shift = np.broadcast_to(carried[segment], (len(moved.movers), 3))
        if segment in bows and not moved.born:
            shift = shift + bows[segment].own
        done.append(_bowed(moved, shift) if shift.any() else moved)
    return done


@dataclass(frozen=True)
class Bend:
    """own: (M, 3) the bow of an organ's movers; of: (3,) of where each organ that it bears is."""

    own: NDArray[np.float64]
    of: dict[int, NDArray[np.float64]]


def _bend(
    motion: OrganMotion,
    moved: Moved,
    clouds: Sequence[NDArray[np.floating]],
    borne: dict[int, NDArray[np.intp]],
) -> Bend | None:
    """None where movers don't go far enough for such a bow: then the spine was found wrongly.

    borne: the points, in the second of the clouds, of each segment that the organ bears.
    """
    from scipy.spatial import cKDTree

    bow = motion.bow(clouds[0][moved.start_points])
    way = moved.movers.curve[-1].astype(float) - moved.movers.curve[0]
    if (bow**2).sum() > MOST**2 * (way**2).sum():
        return None
    tree = cKDTree(motion.warped)
    shifts = {}
    for segment, members in borne.items():
        if len(members):
            own = clouds[1][members]
            # A few bound the gap, and the search ends there: most points are farther.
            some = own[:: max(1, len(own) // ASKED)]
            bound = 1.000001 * float(tree.query(some)[0].min()) or np.inf
            gaps, touched = tree.query(own, distance_upper_bound=bound)
            base = motion.sample[touched[[int(np.argmin(gaps))]]]
            shifts[segment] = motion.bow(base)[0]
    return Bend(bow, shifts)


def _carried(match: Match, bends: dict[int, Bend]) -> dict[int, NDArray[np.float64]]:
    """(3,) for each segment of the second scan: the bow of what bears it, where that does."""
    carried: dict[int, NDArray[np.float64]] = {}
    for segment in match.second.from_the_root():
        parent = match.second.parents[segment]
        carried[segment] = np.zeros(3) if parent == NO_PARENT else carried[parent]
        if parent in bends and segment in bends[parent].of:
            carried[segment] = carried[segment] + bends[parent].of[segment]
    return carried


def _bowed(moved: Moved, bow: NDArray[np.floating]) -> Moved:
    """Movers whose middle is shifted: the control point of degree 2 counts half there."""
    origin, control, target = raised(moved.movers.curve, 2)
    curve = (origin, (control + 2.0 * bow).astype(np.float32), target)
    return replace(moved, movers=replace(moved.movers, curve=curve))
