"""Where an organ is near what bears it, and what keeps both together between two scans.

All movers are looked at where they start, half-way and where they end, and the gap in between only
where it is narrow then.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from baker.interval import Moved
from gclip.evaluate import bernstein
from gclip.pack import morton_codes, raised

DRAWN, TIED = 0.5, 0.25  # point spacings from which a gap that widens is narrowed, and spanned
LEFT = 0.2  # point spacings that a gap is drawn to
KEY_INSTANTS = (0.0, 0.5, 1.0)  # at which all points are looked at
INSTANTS = tuple(k / 16 for k in range(17))  # at which those are that are nearest at the ones above
MARGIN = 6.0  # point spacings beyond the gap that are near
NEAREST = 100  # movers of either side that are looked at in between, for every key instant
ROUNDS = 6  # of drawing, one instant at a time
GENTLE = 0.375  # of a shift half-way, at least, is what an instant may ask for: 2 u (1 - u)
REACH = 0.5  # of an organ, in its root mean square radii, that follows its base

Points = NDArray[np.floating]
Indices = NDArray[np.integer]
Curve = tuple[Points, ...]
Tie = tuple[Moved, Moved]  # one mover of the organ, and one of its bearer


@dataclass(frozen=True)
class _Cloud:
    """Moving points, neighbours side by side: at each instant where they are, and balls around.

    positions: (instants, n, 3) float64; balls: as `closest.balls` finds them.
    """

    positions: Points
    balls: Points

    @classmethod
    def along(cls, curve: Curve, instants: tuple[float, ...]) -> _Cloud:
        from baker.motion.closest import balls

        positions = _along(curve, instants)
        return cls(positions, balls(positions))

    def only(self, points: Indices) -> _Cloud:
        """Some of the points, in their order."""
        from baker.motion.closest import balls

        positions = self.positions[:, points]
        return _Cloud(positions, balls(positions))

    def within(self, other: _Cloud, instant: int, reach: float) -> Indices:
        """The points within reach of the other cloud, the nearest ones where they are many."""
        from baker.motion.closest import distances

        away = distances(
            self.positions[instant], other.positions[instant],
            self.balls[instant], other.balls[instant], reach,
        )  # fmt: skip
        found = np.flatnonzero(np.isfinite(away))
        if len(found) <= NEAREST:
            return found
        return np.sort(found[np.argpartition(away[found], NEAREST)[:NEAREST]])


@dataclass(frozen=True)
class Organ:
    """An organ or what bears it, as it moves.

    order: its movers in the order of a Morton curve half-way, as they are in `keys`.
    """

    moved: Moved
    order: Indices
    keys: _Cloud

    @classmethod
    def of(cls, moved: Moved) -> Organ:
        curve = moved.movers.curve
        order = np.argsort(morton_codes(_at(curve, 0.5)), kind="stable")
        return cls(moved, order, _Cloud.along(_of(curve, order), KEY_INSTANTS))

    def met_by(self, other: Organ, spacing: float) -> Meeting:
        """Where another organ's movers and these come near each other."""
        from baker.motion.closest import closest

        mine, theirs = other.keys, self.keys
        gaps = closest(mine.positions, theirs.positions, mine.balls, theirs.balls)[0]
        near, nearby = np.zeros(len(other.order), bool), np.zeros(len(self.order), bool)
        for k, gap in enumerate(gaps):
            reach = (1.0 + 1e-9) * float(gap) + MARGIN * spacing
            beside = mine.within(theirs, k, reach)
            near[beside] = True
            nearby[theirs.within(mine.only(beside), k, reach)] = True
        return Meeting(
            bearer=self.moved,
            mine=other.order[near],
            theirs=self.order[nearby],
            gap=float(max(gaps[0], gaps[-1])),
            spacing=spacing,
        )


@dataclass(frozen=True)
class Meeting:
    """Where an organ and its bearer are near each other in an interval.

    mine, theirs: the movers of either that are nearest to the other at some key instant. All
                  others are left out, which can make a gap between seem wider, never narrower.
    gap:          the larger one of those at the scans.
    """

    bearer: Moved
    mine: Indices
    theirs: Indices
    gap: float
    spacing: float

    def drawn(self, moved: Moved) -> Moved:
        """The organ drawn to its bearer, the worst instant first."""
        curve, bearer = moved.movers.curve, self.bearer.movers.curve
        best, least = moved, np.inf
        for _ in range(ROUNDS + 1):
            gaps, mine, theirs = self._gaps(curve)
            worst = int(np.argmax(gaps))
            gap, base, touched = float(gaps[worst]), int(mine[worst]), int(theirs[worst])
            if gap < least:
                best, least = (
                    on_curve(moved, curve) if curve is not moved.movers.curve else moved,
                    gap,
                )
            if gap <= self.gap + DRAWN * self.spacing:
                break
            u = INSTANTS[worst]
            points = _at(curve, u)
            way = _at(_of(bearer, [touched]), u)[0] - points[base]
            way *= 1.0 - (self.gap + LEFT * self.spacing) / gap
            curve = _shifted(curve, u, way * _followers(points, points[base]))
        return best

    def tied(self, moved: Moved) -> Tie | None:
        """A mover of the organ and one of its bearer that are never farther apart than at a scan.

        None where the organ does not part from its bearer by more anyway.

        Both go between the points that are nearest to each other at the scans, with the bow that
        their surroundings have; were they to part by it, they meet half-way.
        """
        gaps, own, touched = self._gaps(moved.movers.curve)
        if gaps.max() <= self.gap + TIED * self.spacing:
            return None
        a, b, p, q = own[0], own[-1], touched[0], touched[-1]
        degree = max(len(moved.movers.curve), len(self.bearer.movers.curve)) - 1
        mine = _link(raised(moved.movers.curve, degree), a, b)
        theirs = _link(raised(self.bearer.movers.curve, degree), p, q)
        # A Bézier curve stays within the ball that holds its control points.
        for k in range(1, degree):
            way = mine[k] - theirs[k]
            beyond = max(0.0, 1.0 - self.gap / max(float(np.linalg.norm(way)), 1e-30))
            mine[k], theirs[k] = mine[k] - beyond / 2 * way, theirs[k] + beyond / 2 * way
        return _tie(moved, a, b, mine), _tie(self.bearer, p, q, theirs)

    def _gaps(self, curve: Curve) -> tuple[Points, Indices, Indices]:
        """At each instant the gap, and the movers that are nearest to each other there."""
        from baker.motion.closest import closest

        own, other = _Cloud.along(_of(curve, self.mine), INSTANTS), self._beside
        gaps, a, b = closest(own.positions, other.positions, own.balls, other.balls)
        return gaps, self.mine[a], self.theirs[b]

    @cached_property
    def _beside(self) -> _Cloud:
        """Where the bearer's movers are."""
        return _Cloud.along(_of(self.bearer.movers.curve, self.theirs), INSTANTS)


def _at(curve: Curve, u: float) -> Points:
    """(N, 3) positions on Bézier curves."""
    return np.tensordot(bernstein(len(curve) - 1, u), np.stack(curve), axes=1)


def _along(curve: Curve, instants: tuple[float, ...]) -> Points:
    """(instants, N, 3) positions on Bézier curves, in double precision."""
    return np.tensordot(_weights(len(curve) - 1, instants), np.stack(curve).astype(float), axes=1)


@cache
def _weights(degree: int, instants: tuple[float, ...]) -> Points:
    """(instants, degree + 1) the weight of each control point."""
    return np.array([bernstein(degree, u) for u in instants])


def _of(curve: Curve, movers: Indices | list[int]) -> Curve:
    return tuple(points[movers] for points in curve)


def _followers(points: Points, base: Points) -> NDArray[np.float64]:
    """(N, 1) how far points follow their base: 1 at the base, less the farther from it."""
    size = ((points - points.mean(axis=0)) ** 2).sum(axis=1).mean()
    away = ((points - base) ** 2).sum(axis=1, keepdims=True)
    return np.exp(-away / max(REACH**2 * size, 1e-30))


def _shifted(curve: Curve, u: float, way: Points) -> Curve:
    """Curves whose movers are `way` aside at u, nowhere at their ends, and near these less."""
    first, *control, last = raised(curve, max(2, len(curve) - 1))
    weight = max(float(bernstein(len(control) + 1, u)[1:-1].sum()), GENTLE)
    return (first, *((inner + way / weight).astype(np.float32) for inner in control), last)


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
    )
