"""Movers pass through the scans at one speed: cubic paths across intervals (`--paths smooth`).

Where two intervals meet, their paths have different velocities and the plant would jerk. Each point
of a scan gets the velocity that both sides agree on, and paths take it as their slope there. It is
the harmonic mean of the two speeds, so that nothing overshoots, and nothing where they oppose each
other (F. N. Fritsch and J. Butland, A Method for Constructing Local Monotone Piecewise Cubic
Interpolants, SIAM Journal on Scientific and Statistical Computing 5, 1984).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.movers import Keyframe, Moved
from gclip.pack import raised

NEIGHBORS = 12  # of the same organ, over which a velocity is averaged: organs move as sheets
Velocity = NDArray[np.float64]


def smooth_through(
    tasks: Sequence[Moved], before: Velocity, after: Velocity, span: float
) -> list[Moved]:
    """An interval's solved tasks on cubic curves.

    before, after: (N, 3) the velocities at its two scans, from `velocity_at`.
    span: the time between them. What is lost keeps its path.
    """
    return [_on_cubic(moved, before, after, span) for moved in tasks]


def velocity_at(
    frame: Keyframe,
    before: Sequence[Moved],
    after: Sequence[Moved],
    span_before: float,
    span_after: float,
) -> Velocity:
    """(N, 3) of each point of a scan, in lengths per time, as both sides agree on it.

    before, after: the solved tasks of the intervals that end and begin at the scan, none where
    there is no such interval; span_before, span_after: how long these are.

    Organs that are born start with the speed of what they grow from.
    """
    arriving = _arriving(len(frame.positions), before, span_before)
    departing = _departing(len(frame.positions), after, span_after)
    agreed = _agreed(arriving, departing, span_before, span_after)
    return _averaged(frame.positions, _organs(len(frame.positions), before, after), agreed)


def _arriving(count: int, tasks: Sequence[Moved], span: float) -> Velocity:
    """NaN where no mover ends."""
    moving = [moved for moved in tasks if moved.end_points is not None]
    slopes = [
        (len(m.movers.curve) - 1) * (m.movers.curve[-1] - m.movers.curve[-2]) / span for m in moving
    ]
    return _mean_at(count, [m.end_points for m in moving if m.end_points is not None], slopes)


def _departing(count: int, tasks: Sequence[Moved], span: float) -> Velocity:
    """NaN where no mover starts; what unfolds from a bud says nothing of its speed."""
    moving = [moved for moved in tasks if moved.start_points is not None and not moved.born]
    slopes = [
        (len(m.movers.curve) - 1) * (m.movers.curve[1] - m.movers.curve[0]) / span for m in moving
    ]
    return _mean_at(count, [m.start_points for m in moving if m.start_points is not None], slopes)


def _mean_at(
    count: int, points: Sequence[NDArray[np.intp]], slopes: Sequence[NDArray[np.floating]]
) -> Velocity:
    if not points:
        return np.full((count, 3), np.nan)
    home, slope = np.concatenate(points), np.concatenate(slopes)
    number = np.bincount(home, minlength=count)
    total = np.stack([np.bincount(home, axis, count) for axis in slope.T], axis=1)
    with np.errstate(invalid="ignore"):
        return total / np.where(number > 0, number, np.nan)[:, None]


def _agreed(before: Velocity, after: Velocity, span_before: float, span_after: float) -> Velocity:
    """The velocity between two: the weighted harmonic mean of the speeds, in the mean direction."""
    speeds = [np.linalg.norm(v, axis=1) for v in (before, after)]
    with np.errstate(invalid="ignore", divide="ignore"):
        heading = before / speeds[0][:, None] + after / speeds[1][:, None]
        heading /= np.linalg.norm(heading, axis=1, keepdims=True)
        first, second = span_before + 2 * span_after, 2 * span_before + span_after
        speed = (first + second) / (first / speeds[0] + second / speeds[1])
        agree = (before * after).sum(axis=1) > 0
    between = np.where(agree[:, None], heading * speed[:, None], 0.0)
    one_sided = np.where(np.isnan(before), after, before)
    alone = np.isnan(before[:, 0]) | np.isnan(after[:, 0])
    return np.nan_to_num(np.where(alone[:, None], one_sided, between))


def _organs(count: int, before: Sequence[Moved], after: Sequence[Moved]) -> NDArray[np.int64]:
    """(N,) the organ of each point."""
    organs = np.full(count, -1)
    for moved in before:
        if moved.end_points is not None:
            organs[moved.end_points] = moved.movers.tracks
    for moved in after:
        if moved.start_points is not None and not moved.born:
            organs[moved.start_points] = moved.movers.tracks
    return organs


def _averaged(
    points: NDArray[np.float32], organs: NDArray[np.int64], velocity: Velocity
) -> Velocity:
    """Each point's mean over its neighbours in the organ."""
    from scipy.spatial import cKDTree

    mean = velocity.copy()
    order = np.argsort(organs, kind="stable")
    for own in np.split(order, np.flatnonzero(np.diff(organs[order])) + 1):
        k = min(NEIGHBORS, len(own))
        near = cKDTree(points[own]).query(points[own], k=k)[1].reshape(len(own), k)
        mean[own] = velocity[own][near].mean(axis=1)
    return mean


def _on_cubic(moved: Moved, before: Velocity, after: Velocity, span: float) -> Moved:
    if moved.start_points is None or moved.end_points is None:
        return moved
    start, *_, end = raised(moved.movers.curve, 3)
    leaving = before[moved.start_points] * span / 3
    coming = after[moved.end_points] * span / 3
    curve = (start, start + leaving, end - coming, end)
    return replace(moved, movers=replace(moved.movers, curve=curve))
