"""Control points of the movers of organs that deform, and of what grows on these."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.movers import OrganMovers
from baker.interpolation.organ_motion import OrganMotion, fit_motion
from baker.interpolation.spine import MIN_POINTS_FOR_SPINE, OrganShapes, at_levels
from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT
from gclip.pack import raised

MAX_DEVIATION = 0.25  # of the movers' displacement; turning by a right angle takes 0.21
MIN_DEVIATION = 0.25  # point spacings; less is below what a scan shows
POINTS_COMPARED = 100  # of an organ that show where it touches its parent


@dataclass(frozen=True)
class Deviation:
    """Deviations from straight paths at mid-interval."""

    movers: NDArray[np.float64]  # (M, 3), of an organ's movers
    children: dict[int, NDArray[np.float64]]  # (3,), of where each child segment is attached


@dataclass(frozen=True)
class OrganPaths:
    """Finds how the organs of an interval deviate from straight paths.

    Straight go the root, organs of few points, what hardly deforms, and organs with leaflets,
    through which no one spine runs.

    Parameters
    ----------
    clouds : pair of (N, 3) float
        Of the two scans.
    match, organs
        The interval's hierarchies, and which organ each segment is.
    bases : pair of (3,) float
        Plant bases.
    spacing : float
        Point spacing, relative to which deviations matter.
    """

    clouds: Sequence[NDArray[np.floating]]
    match: Match
    organs: IntervalOrgans
    bases: Sequence[NDArray[np.floating]]
    spacing: float

    def deviation(self, moved: OrganMovers) -> Deviation | None:
        """How one task's movers deviate; None where they go straight."""
        segment = self._segments.get(_track(moved))
        if segment is None or segment not in self._partners:
            return None
        if moved.start_points is None or moved.born or moved.divided:
            return None
        source, target = self._shapes[0].of(self._partners[segment]), self._shapes[1].of(segment)
        if source is None or target is None:
            return None
        motion = fit_motion(source, target, MIN_DEVIATION * self.spacing)
        return self._of_motion(motion, moved, segment) if motion else None

    def curved(
        self, solved: Sequence[OrganMovers], deviations: Sequence[Deviation | None]
    ) -> list[OrganMovers]:
        """The solved tasks, carried along by their parents; those that deviate, on curves."""
        segments = [self._segments.get(_track(moved)) for moved in solved]
        of = {s: d for s, d in zip(segments, deviations, strict=True) if d is not None}
        carried: dict[int, NDArray[np.float64]] = {NO_PARENT: np.zeros(3)}
        for child in self.match.second.from_the_root():
            parent = self.match.second.parents[child]
            own = of[parent].children.get(child) if parent in of else None
            carried[child] = carried[parent] + (0.0 if own is None else own)
        done = []
        for moved, segment, deviation in zip(solved, segments, deviations, strict=True):
            if segment is not None and moved.start_points is not None:
                shift = np.broadcast_to(carried[segment], (len(moved.movers), 3))
                if deviation is not None:
                    shift = shift + deviation.movers
                moved = _shifted(moved, shift) if shift.any() else moved
            done.append(moved)
        return done

    def _of_motion(self, motion: OrganMotion, moved: OrganMovers, segment: int) -> Deviation | None:
        """None where it is too large for the movers' displacement: then the spine is wrong."""
        from scipy.spatial import cKDTree

        assert moved.start_points is not None
        starts, mover = np.unique(moved.start_points, return_inverse=True)
        shift = motion.deviation(self.clouds[0].take(starts, axis=0))[mover]
        distance = moved.movers.curve[-1].astype(float) - moved.movers.curve[0]
        if (shift**2).sum() > MAX_DEVIATION**2 * (distance**2).sum():
            return None
        tree, touched = cKDTree(motion.deformed), dict[int, int]()
        scan = self.match.second
        for child, members in enumerate(scan.segments):
            if scan.parents[child] == segment and len(members):
                some = members[:: max(1, len(members) // POINTS_COMPARED)]
                distances, nearest = tree.query(self.clouds[1].take(some, axis=0))
                touched[child] = int(nearest[np.argmin(distances)])
        shifts = at_levels(motion.deviations, motion.along[[*touched.values()]])
        return Deviation(shift, dict(zip(touched, shifts, strict=True)))

    @cached_property
    def _segments(self) -> dict[int, int]:
        """The segment of the second scan that each organ is there."""
        return {self.organs.second[b]: b for b in self.match.second.from_the_root()}

    @cached_property
    def _partners(self) -> dict[int, int]:
        """By segment of the second scan that may deform what it was in the first."""
        scans = self.match.first, self.match.second
        return {
            pair[1]: pair[0]
            for pair in self.match.pairs
            if all(
                segment != scan.root and len(scan.segments[segment]) >= MIN_POINTS_FOR_SPINE
                for scan, segment in zip(scans, pair, strict=True)
            )
        }

    @cached_property
    def _shapes(self) -> tuple[OrganShapes, OrganShapes]:
        scans = self.match.first, self.match.second
        first, second = map(OrganShapes, self.clouds, scans, self.bases)
        return first, second


def _track(moved: OrganMovers) -> int:
    return int(moved.movers.tracks[0]) if len(moved.movers) else -1


def _shifted(moved: OrganMovers, shift: NDArray[np.floating]) -> OrganMovers:
    """Movers whose middle is shifted: the control point of degree 2 counts half there."""
    origin, control, target = raised(moved.movers.curve, 2)
    curve = (origin, (control + 2.0 * shift).astype(np.float32), target)
    return replace(moved, movers=replace(moved.movers, curve=curve))
