"""Organs stay on what bears them: half-way a base may come no farther off than at the scans."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.interval import Moved
from baker.match import IntervalOrgans, Match
from baker.segment.hierarchy import NO_PARENT
from gclip.evaluate import bernstein
from gclip.pack import raised

INSTANTS = (0.5, 0.25, 0.75)
SLACK = 0.5  # point spacings that a gap may widen
SAMPLED = 200  # points of an organ that are searched without a bound
REACH = 0.5  # of an organ, in its root mean square radii, that follows its base

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

Curve = tuple[NDArray[np.floating], ...]


def attached(
    solved: Sequence[Sequence[Moved]],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    spacing: float,
) -> list[list[Moved]]:
    """The solved tasks of each interval, organs' bases drawn to their parents where they left them.

    Transport takes points of a base to points farther on, so that half-way the base itself may be
    away from its parent. What is near the base follows it, the less the farther it is.
    """
    return [
        _interval(tasks, match, named, spacing)
        for tasks, match, named in zip(solved, matches, organs, strict=True)
    ]


def _interval(
    tasks: Sequence[Moved], match: Match, organs: IntervalOrgans, spacing: float
) -> list[Moved]:
    from scipy.spatial import cKDTree

    done = list(tasks)
    place = {
        int(moved.movers.tracks[0]): index
        for index, moved in enumerate(tasks)
        if len(moved.movers) and moved.end_points is not None
    }
    trees: dict[int, list[cKDTree]] = {}
    for segment in match.second.from_the_root():
        parent = match.second.parents[segment]
        own = place.get(organs.second[segment])
        bearer = None if parent == NO_PARENT else place.get(organs.second[parent])
        if own is None or bearer is None:
            continue
        if bearer not in trees:
            curve = done[bearer].movers.curve
            trees[bearer] = [cKDTree(_at(curve, u)) for u in (0.0, 1.0, *INSTANTS)]
        done[own] = _drawn(done[own], trees[bearer], SLACK * spacing)
    return done


def _at(curve: Curve, u: float) -> NDArray[np.floating]:
    """(N, 3) positions on Bézier curves."""
    return np.tensordot(bernstein(len(curve) - 1, u), np.stack(curve), axes=1)


def _drawn(moved: Moved, bearer: Sequence[cKDTree], slack: float) -> Moved:
    """The movers with their base within reach of the bearer, whose trees are those of the ends
    and of the instants between."""
    curve = moved.movers.curve
    ends = [_closest(tree, _at(curve, u))[2] for u, tree in enumerate(bearer[:2])]
    allowed = max(ends) + slack
    for u, tree in zip(INSTANTS, bearer[2:], strict=True):
        points = _at(curve, u)
        base, touched, gap = _closest(tree, points)
        if gap > allowed:
            way = (tree.data[touched] - points[base]) * (1.0 - allowed / gap)
            curve = _shifted(curve, u, way * _followers(points, points[base]))
    return moved if curve is moved.movers.curve else _on(moved, curve)


def _closest(tree: cKDTree, points: NDArray[np.floating]) -> tuple[int, int, float]:
    """The point nearest to a tree's, the tree's point there, and how far they are apart.

    A sample bounds the distance, and the search ends there: most points are farther.
    """
    sample = points[:: max(1, len(points) // SAMPLED)]
    bound = float(tree.query(sample)[0].min())
    apart, near = tree.query(points, distance_upper_bound=np.nextafter(bound, np.inf))
    first = int(np.argmin(apart))
    return first, int(near[first]), float(apart[first])


def _followers(points: NDArray[np.floating], base: NDArray[np.floating]) -> NDArray[np.float64]:
    """(N, 1) how far points follow their base: 1 at the base, less the farther from it."""
    size = ((points - points.mean(axis=0)) ** 2).sum(axis=1).mean()
    away = ((points - base) ** 2).sum(axis=1, keepdims=True)
    return np.exp(-away / max(REACH**2 * size, 1e-30))


def _shifted(curve: Curve, u: float, way: NDArray[np.floating]) -> Curve:
    """Curves whose movers are `way` aside at u, and nowhere at their ends."""
    first, *control, last = raised(curve, max(2, len(curve) - 1))
    weight = float(bernstein(len(control) + 1, u)[1:-1].sum())
    return (first, *((inner + way / weight).astype(np.float32) for inner in control), last)


def _on(moved: Moved, curve: Curve) -> Moved:
    return replace(moved, movers=replace(moved.movers, curve=curve))
