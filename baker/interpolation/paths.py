"""Movers of organs that bend or turn go on curves: each organ's own, and that of what bears it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.movers import Moved
from baker.interpolation.organ_motion import OrganMotion, fit_motion
from baker.interpolation.organ_shape import FEWEST, Shapes
from baker.interpolation.spine import at_levels
from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT
from gclip.pack import raised

MOST = 0.25  # of the way that movers go, that they bow by: turning by a right angle takes 0.21
ASKED = 100  # points of an organ that tell where it touches its bearer
MATTERS = 0.25  # point spacings; a smaller bow is below what the scan shows


@dataclass(frozen=True)
class Bending:
    """How the organs of an interval bend and turn.

    The root stands, and what has too few points or hardly bends goes straight; so does what has
    limbs, through which no one spine runs.

    clouds:  of the two scans; bases: (3,) where the plant leaves the ground in each.
    spacing: the point spacing, which says what bows matter.
    """

    clouds: Sequence[NDArray[np.floating]]
    match: Match
    organs: IntervalOrgans
    bases: Sequence[NDArray[np.floating]]
    spacing: float

    def of(self, moved: Moved) -> Bend | None:
        """How one task's movers bend, and where that takes what their organ bears."""
        segment = self._segments.get(_track(moved))
        if segment is None or segment not in self._partners:
            return None
        if moved.start_points is None or moved.born or moved.limbs:
            return None
        before = self._shapes[0].of(self._partners[segment])
        after = self._shapes[1].of(segment)
        if before is None or after is None:
            return None
        motion = fit_motion(before, after, MATTERS * self.spacing)
        if motion is None:
            return None
        borne = {child: self.match.second.segments[child] for child in self._borne.get(segment, ())}
        return _bend(motion, moved, self.clouds, borne)

    def curved(self, solved: Sequence[Moved], bends: Sequence[Bend | None]) -> list[Moved]:
        """The solved tasks, what bends on curves of degree 2, the rest as it was.

        bends: of each task. An organ is carried along, as a whole, by what it grows from.
        """
        found = [self._segments.get(_track(moved)) for moved in solved]
        of = {
            segment: bend
            for segment, bend in zip(found, bends, strict=True)
            if segment is not None and bend is not None
        }
        carried = _carried(self.match, of)
        done = []
        for moved, segment, bend in zip(solved, found, bends, strict=True):
            if segment is None or moved.start_points is None:
                done.append(moved)
                continue
            shift = np.broadcast_to(carried[segment], (len(moved.movers), 3))
            if bend is not None:
                shift = shift + bend.own
            done.append(_bowed(moved, shift) if shift.any() else moved)
        return done

    @cached_property
    def _segments(self) -> dict[int, int]:
        """The segment of the second scan that each organ is there."""
        return {self.organs.second[b]: b for b in self.match.second.from_the_root()}

    @cached_property
    def _partners(self) -> dict[int, int]:
        """By segment of the second scan that may bend what it was in the first."""
        scans = self.match.first, self.match.second
        return {
            pair[1]: pair[0]
            for pair in self.match.pairs
            if all(
                segment != scan.root and len(scan.segments[segment]) >= FEWEST
                for scan, segment in zip(scans, pair, strict=True)
            )
        }

    @cached_property
    def _shapes(self) -> tuple[Shapes, Shapes]:
        first, second = self.match.first, self.match.second
        return (
            Shapes(self.clouds[0], first, self.bases[0]),
            Shapes(self.clouds[1], second, self.bases[1]),
        )

    @cached_property
    def _borne(self) -> dict[int, list[int]]:
        borne: dict[int, list[int]] = {}
        for child in self.match.second.from_the_root():
            borne.setdefault(self.match.second.parents[child], []).append(child)
        return borne


def _track(moved: Moved) -> int:
    return int(moved.movers.tracks[0]) if len(moved.movers) else -1


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

    assert moved.start_points is not None
    # Movers that start at one point follow one another.
    another = np.diff(moved.start_points, prepend=-1) != 0
    starts = clouds[0].take(moved.start_points[another], axis=0)
    bow = motion.bow(starts).take(np.cumsum(another) - 1, axis=0)
    way = moved.movers.curve[-1].astype(float) - moved.movers.curve[0]
    if (bow**2).sum() > MOST**2 * (way**2).sum():
        return None
    bearer = cKDTree(motion.warped)
    touched: dict[int, int] = {}
    for segment, members in borne.items():
        if len(members):
            asked = members[:: max(1, len(members) // ASKED)]
            own = clouds[1].take(asked, axis=0).astype(np.float64)
            gaps, nearest = bearer.query(own)
            touched[segment] = int(nearest[np.argmin(gaps)])
    shifts = at_levels(motion.bows, motion.along[[*touched.values()]])
    return Bend(bow, dict(zip(touched, shifts, strict=True)))


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
