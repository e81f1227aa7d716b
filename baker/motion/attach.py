"""Organs stay on what bears them: between two scans no base comes farther off than at the scans.

Transport takes points of a base to points farther on, and the bearer bends in its own way, so that
half-way the base itself may be away from its bearer. First the organ is drawn to it, what is near
the base as far as the base, the rest the less the farther it is. A path of low degree can't follow
every way. What gap is left is spanned by two movers more: one of the organ, from where it touches
its bearer at the first scan to where it does at the second, and one of the bearer along with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from baker.interval import Moved
from baker.match import IntervalOrgans, Match
from baker.segment.hierarchy import NO_PARENT
from gclip.evaluate import bernstein
from gclip.pack import morton_codes, raised

DRAWN, TIED = 0.5, 0.25  # point spacings from which a gap that widens is narrowed, and spanned
LEFT = 0.2  # point spacings that a gap is drawn to
KEY_INSTANTS = (0.0, 0.5, 1.0)  # at which all points are looked at
INSTANTS = np.linspace(0.0, 1.0, 17)  # at which those are that are nearest at the ones above
MARGIN = 6.0  # point spacings beyond the gap that are near
NEAREST, PARTNERS = 200, 24  # movers of an organ, and of its bearer to each, looked at in between
ROUNDS = 6  # of drawing, one instant at a time
GENTLE = 0.375  # of a shift half-way, at least, is what an instant may ask for: 2 u (1 - u)
SAMPLED = 200  # points of an organ that are searched without a bound
REACH = 0.5  # of an organ, in its root mean square radii, that follows its base

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

Points = NDArray[np.floating]
Curve = tuple[Points, ...]


def attached(
    tasks: Sequence[Moved],
    match: Match,
    organs: IntervalOrgans,
    spacing: float,
    bend: bool = True,
) -> list[Moved]:
    """The solved tasks of an interval, organs' bases kept by what bears them.

    spacing: the point spacing, which no gap may widen by.
    bend:    whether paths may be bent for it; straight ones are only tied.
    """
    done = list(tasks)
    place = {
        int(moved.movers.tracks[0]): index
        for index, moved in enumerate(tasks)
        if len(moved.movers) and moved.end_points is not None
    }
    meetings = [
        (place[organ], place[bearer])
        for organ, found in _bearers(match, organs).items()
        for bearer in found
        if organ in place and bearer in place and organ != bearer
    ]
    known: dict[int, _Bearer] = {}
    bases = []
    for own, bearer in meetings:
        if bearer not in known or known[bearer].moved is not done[bearer]:
            known[bearer] = _Bearer(done[bearer])
        bases.append(known[bearer].met_by(done[own], spacing))
        if bend:
            done[own] = bases[-1].drawn(done[own])
    ties: list[tuple[int, Moved]] = []
    for (own, bearer), base in zip(meetings, bases, strict=True):
        last = base
        if base.bearer is not done[bearer]:  # which was itself drawn after what it bears
            last = _Bearer(done[bearer]).met_by(done[own], spacing)
        if last.widens(done[own]):
            here, there = last.tied(done[own])
            ties += [(own, here), (bearer, there)]
    for index, tie in ties:
        done[index] = _joined(done[index], tie)
    return done


def _bearers(match: Match, organs: IntervalOrgans) -> dict[int, list[int]]:
    """What each organ grows from, parents first: in the second scan, and when it was seen first."""
    bearers: dict[int, list[int]] = {}
    for segment in match.second.from_the_root():
        organ, parent = organs.second[segment], match.second.parents[segment]
        found = [organs.second[parent]] if parent != NO_PARENT else []
        first = organs.bearers.get(organ)
        if first is not None and first not in found:
            found.append(first)
        bearers[organ] = found
    return bearers


@dataclass(frozen=True)
class _Bearer:
    """What bears organs, as it moves."""

    moved: Moved

    @cached_property
    def trees(self) -> list[cKDTree]:
        """Of all its points at the key instants."""
        from scipy.spatial import cKDTree

        return [cKDTree(_at(self.moved.movers.curve, u)) for u in KEY_INSTANTS]

    def met_by(self, moved: Moved, spacing: float) -> _Base:
        """Where an organ's movers and these come near each other."""
        mine, theirs, gaps = [], [], []
        for u, tree in zip(KEY_INSTANTS, self.trees, strict=True):
            points = _at(moved.movers.curve, u)
            # A sample bounds the gap, and the search ends a little beyond: most points are farther.
            some = points[:: max(1, len(points) // SAMPLED)]
            reach = float(tree.query(some)[0].min()) + MARGIN * spacing
            apart = tree.query(points, distance_upper_bound=reach)[0]
            near = np.argsort(apart, kind="stable")[: min(NEAREST, int((apart < reach).sum()) or 1)]
            mine.append(near)
            theirs.append(tree.query(points[near], k=np.arange(1, min(PARTNERS, tree.n) + 1))[1])
            gaps.append(float(apart[near[0]]))
        return _Base(
            bearer=self.moved,
            mine=np.unique(np.concatenate(mine)),
            theirs=self._side_by_side(np.unique(np.concatenate([p.ravel() for p in theirs]))),
            gap=max(gaps[0], gaps[-1]),
            spacing=spacing,
        )

    def _side_by_side(self, movers: NDArray[np.intp]) -> NDArray[np.intp]:
        """The movers in the order of a Morton curve half-way."""
        half_way = _at(_of(self.moved.movers.curve, movers), 0.5)
        return movers[np.argsort(morton_codes(half_way), kind="stable")]


@dataclass(frozen=True)
class _Base:
    """Where an organ and its bearer are near each other in an interval.

    mine, theirs: the movers of either that are nearest to the other at some key instant. All
                  others are left out, which can make a gap between seem wider, never narrower.
    gap:          the larger one of those at the scans.
    """

    bearer: Moved
    mine: NDArray[np.intp]
    theirs: NDArray[np.intp]
    gap: float
    spacing: float

    @cached_property
    def beside(self) -> Points:
        """(instants, n, 3) where the bearer's movers are."""
        return _along(_of(self.bearer.movers.curve, self.theirs))

    def gaps(self, curve: Curve) -> list[tuple[float, int, int]]:
        """At each instant the gap, and the movers that are nearest to each other there."""
        from baker.motion.closest import closest

        found = closest(_along(_of(curve, self.mine)), self.beside)
        return [
            (float(gap), self.mine[a], self.theirs[b]) for gap, a, b in zip(*found, strict=True)
        ]

    def widens(self, moved: Moved) -> bool:
        """Whether it may part from its bearer by more than it does at the scans."""
        widest = max(gap for gap, _, _ in self.gaps(moved.movers.curve))
        return widest > self.gap + TIED * self.spacing

    def drawn(self, moved: Moved) -> Moved:
        """The organ drawn to its bearer, the worst instant first."""
        curve, bearer = moved.movers.curve, self.bearer.movers.curve
        best, least = moved, np.inf
        for _ in range(ROUNDS + 1):
            found = self.gaps(curve)
            worst = int(np.argmax([gap for gap, _, _ in found]))
            gap, base, touched = found[worst]
            if gap < least:
                best, least = _on(moved, curve) if curve is not moved.movers.curve else moved, gap
            if gap <= self.gap + DRAWN * self.spacing:
                break
            u = float(INSTANTS[worst])
            points = _at(curve, u)
            way = _at(_of(bearer, [touched]), u)[0] - points[base]
            way *= 1.0 - (self.gap + LEFT * self.spacing) / gap
            curve = _shifted(curve, u, way * _followers(points, points[base]))
        return best

    def tied(self, moved: Moved) -> tuple[Moved, Moved]:
        """A mover of the organ and one of its bearer that are never farther apart than at a scan.

        Both go between the points that are nearest to each other at the scans, with the bow that
        their surroundings have; were they to part by it, they meet half-way.
        """
        found = self.gaps(moved.movers.curve)
        (_, a, p), (_, b, q) = found[0], found[-1]
        degree = max(len(moved.movers.curve), len(self.bearer.movers.curve)) - 1
        mine = _link(raised(moved.movers.curve, degree), a, b)
        theirs = _link(raised(self.bearer.movers.curve, degree), p, q)
        # A Bézier curve stays within the ball that holds its control points.
        for k in range(1, degree):
            way = mine[k] - theirs[k]
            beyond = max(0.0, 1.0 - self.gap / max(float(np.linalg.norm(way)), 1e-30))
            mine[k], theirs[k] = mine[k] - beyond / 2 * way, theirs[k] + beyond / 2 * way
        return _tie(moved, a, b, mine), _tie(self.bearer, p, q, theirs)


def _at(curve: Curve, u: float) -> Points:
    """(N, 3) positions on Bézier curves."""
    return np.tensordot(bernstein(len(curve) - 1, u), np.stack(curve), axes=1)


def _along(curve: Curve) -> Points:
    """(instants, N, 3) positions on Bézier curves, in double precision."""
    weights = np.array([bernstein(len(curve) - 1, u) for u in INSTANTS])
    return np.tensordot(weights, np.stack(curve).astype(float), axes=1)


def _of(curve: Curve, movers: NDArray[np.intp] | list[int]) -> Curve:
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


def _on(moved: Moved, curve: Curve) -> Moved:
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


def _joined(moved: Moved, tie: Moved) -> Moved:
    """The movers of both."""
    degree = max(len(moved.movers.curve), len(tie.movers.curve)) - 1
    ours, more = (raised(m.movers.curve, degree) for m in (moved, tie))
    return replace(
        moved,
        movers=replace(
            moved.movers,
            curve=tuple(np.concatenate(points) for points in zip(ours, more, strict=True)),
            tracks=np.concatenate([moved.movers.tracks, tie.movers.tracks]),
            start_colors=_both(moved.movers.start_colors, tie.movers.start_colors),
            end_colors=_both(moved.movers.end_colors, tie.movers.end_colors),
        ),
        surface=_both(moved.surface, tie.surface),
        start_points=_both(moved.start_points, tie.start_points),
        end_points=_both(moved.end_points, tie.end_points),
    )


def _both(ours: NDArray[Any] | None, more: NDArray[Any] | None) -> NDArray[Any] | None:
    return None if ours is None or more is None else np.concatenate([ours, more])
