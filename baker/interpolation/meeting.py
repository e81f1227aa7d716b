"""Where an organ parts from what bears it, and what keeps both together between two scans."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from baker.geometry.nearby import along_curve
from baker.interpolation.movers import Moved
from gclip.evaluate import bernstein
from gclip.pack import raised

DRAWN, TIED = 0.5, 0.25  # point spacings from which a gap that widens is narrowed, and spanned
LEFT = 0.2  # point spacings that a gap is drawn to
INSTANTS = tuple(k / 16 for k in range(17))  # of an interval that are looked at
ROUNDS = 6  # of drawing, one instant at a time
GENTLE = 0.375  # of a shift half-way, at least, is what an instant may ask for: 2 u (1 - u)
REACH = 0.5  # of an organ, in its root mean square radii, that follows its base

Points = NDArray[np.floating]
Indices = NDArray[np.integer]
Curve = tuple[Points, ...]
Tie = tuple[Moved, Moved]  # one mover of the organ, and one of its bearer


@dataclass(frozen=True)
class Organ:
    """An organ or what bears it, as it moves.

    order:  its movers in the order of a Morton curve half-way.
    moving: their (degree + 1, n, 3) float32 control points in that order, the balls around them,
            and the control points' weights at each instant.
    """

    moved: Moved
    order: Indices
    moving: tuple[Points, Points, Points]

    @classmethod
    def of(cls, moved: Moved) -> Organ:
        from baker.interpolation.beside import balls

        curve = np.stack(moved.movers.curve).astype(np.float32, copy=False)
        half_way = np.tensordot(bernstein(len(curve) - 1, 0.5), curve, axes=1)
        order = along_curve(half_way)
        curve = np.take(curve, order, axis=1)
        return cls(moved, order, (curve, balls(curve), _weights(len(curve))))

    def met_by(self, other: Organ, spacing: float) -> Meeting | None:
        """Where another organ's movers and these are nearest to each other.

        None where they don't part on the way by more than they are apart at the scans.
        """
        from baker.interpolation.beside import gaps_of

        gaps, first, second = gaps_of(other.moving, self.moving, TIED * spacing)
        gap = float(max(gaps[0], gaps[-1]))
        if gaps.max() <= gap + TIED * spacing:
            return None
        return Meeting(other, self, gaps, first, second, gap, spacing)


@dataclass(frozen=True)
class Meeting:
    """An organ and its bearer that are farther apart at some instant than at both scans.

    gaps:   (I,) between them at each instant, or where it is not larger than may be some more.
    mine, theirs: (I,) movers of either, by their places in `order`, that are so far apart.
    gap:    the larger one of those at the scans.
    """

    own: Organ
    bearer: Organ
    gaps: Points
    mine: Indices
    theirs: Indices
    gap: float
    spacing: float

    def settled(self, draw: bool) -> tuple[Curve | None, Tie | None]:
        """The organ's paths where it has to be drawn to its bearer, and the tie between both.

        draw: whether paths may be bent for it.
        """
        from baker.interpolation.follow import follow

        allowed, fine, left = (self.gap + share * self.spacing for share in (DRAWN, TIED, LEFT))
        if not draw or self.gaps.max() <= allowed:
            return None, self._tie(self.own.moved)
        curve = self.own.moving[0]
        curve = _of_degree(curve, max(len(curve), 3) - 1)
        drawn, least = follow(
            curve,
            _weights(len(curve)),
            self.bearer.moving,
            (self.gaps, self.mine, self.theirs),
            allowed,
            fine,
            left,
            ROUNDS,
            GENTLE,
            REACH,
        )
        if drawn is curve:
            return None, self._tie(self.own.moved)
        paths = np.empty_like(drawn)
        paths[:, self.own.order] = drawn
        tie = self._tie(on_curve(self.own.moved, tuple(paths))) if least > fine else None
        return tuple(paths), tie

    def _tie(self, moved: Moved) -> Tie:
        """A mover of the organ and one of its bearer that are never farther apart than at a scan.

        Both go between the points that are nearest to each other at the scans, with the bow that
        their surroundings have; were they to part by it, they meet half-way.
        """
        bearer = self.bearer.moved
        a, b = self.own.order[self.mine[[0, -1]]]
        p, q = self.bearer.order[self.theirs[[0, -1]]]
        degree = max(len(moved.movers.curve), len(bearer.movers.curve)) - 1
        mine = _link(raised(moved.movers.curve, degree), a, b)
        theirs = _link(raised(bearer.movers.curve, degree), p, q)
        # A Bézier curve stays within the ball that holds its control points.
        for k in range(1, degree):
            way = mine[k] - theirs[k]
            beyond = max(0.0, 1.0 - self.gap / max(float(np.linalg.norm(way)), 1e-30))
            mine[k], theirs[k] = mine[k] - beyond / 2 * way, theirs[k] + beyond / 2 * way
        return _tie(moved, a, b, mine), _tie(bearer, p, q, theirs)


@cache
def _weights(points: int) -> Points:
    """(instants, points) the weight of each control point."""
    return np.array([bernstein(points - 1, u) for u in INSTANTS])


def _of_degree(curve: Points, degree: int) -> Points:
    return curve if len(curve) == degree + 1 else np.stack(raised(tuple(curve), degree))


def on_curve(moved: Moved, curve: Curve) -> Moved:
    return replace(moved, movers=replace(moved.movers, curve=curve))


def _link(curve: Curve, a: int, b: int) -> NDArray[np.float64]:
    """(degree + 1, 3) from mover a's start to mover b's end, with the mean bow of both."""
    points = np.stack([inner[[a, b]] for inner in curve]).astype(float)
    share = np.linspace(0.0, 1.0, len(points))[:, None]
    chords = (1 - share[..., None]) * points[0] + share[..., None] * points[-1]
    return (1 - share) * points[0, 0] + share * points[-1, 1] + (points - chords).mean(axis=1)


def _tie(moved: Moved, a: int, b: int, path: NDArray[np.float64]) -> Moved:
    """One mover on `path`, from the point where mover a starts to the one where b ends."""
    movers, start, end = moved.movers, moved.start_points, moved.end_points
    from_color, to_color = movers.start_colors, movers.end_colors
    return replace(
        moved,
        movers=replace(
            movers,
            curve=tuple(path[:, None].astype(np.float32)),
            tracks=movers.tracks[[a]],
            start_colors=None if from_color is None else from_color[[a]],
            end_colors=None if to_color is None else to_color[[b]],
        ),
        surface=None if moved.surface is None else moved.surface[[a, b]].min(keepdims=True),
        start_points=None if start is None else start[[a]],
        end_points=None if end is None else end[[b]],
        reach=None if moved.reach is None else moved.reach[[a, b]].min(keepdims=True),
    )
