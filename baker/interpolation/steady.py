"""Organs that only seem to move back and forth, steadied over the series (`--smooth`).

What a plant sways and a scanner errs from scan to scan is mirrored in the animation (the paper's
limitations, section 5). Here every organ keeps its shape and is turned about its attachment, so
that its direction follows a robust smooth course over the real times; what grows from it is carried
along. The keyframes are then no longer exactly the scans.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.up_axis import Vertical
from baker.interpolation.movers import Keyframe
from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

FEWEST = 4  # scans that hold an organ, below which nothing tells sway from growth
WINDOW = 9  # scans that a smooth course follows at a time, the farthest for nothing
ROUNDS, OUTLYING = 4, 6.0  # of robust weights; median deviations at which a scan no longer counts


@dataclass(frozen=True)
class _Pose:
    """Where an organ of a scan is attached and where its middle is, (3,) each."""

    base: NDArray[np.float64]
    middle: NDArray[np.float64]


def steadied(
    keyframes: Sequence[Keyframe],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    times: Sequence[float],
    vertical: Vertical,
) -> list[Keyframe]:
    """The keyframes with every organ turned about its attachment onto its smooth course."""
    scans = _organs_of_scans(matches, organs)
    poses = [
        _poses(frame.positions, hierarchy, named, vertical)
        for frame, (hierarchy, named) in zip(keyframes, scans, strict=True)
    ]
    courses = _courses(poses, np.asarray(times, float))
    return [
        replace(frame, positions=_posed(frame.positions, hierarchy, named, poses[k], courses, k))
        for k, (frame, (hierarchy, named)) in enumerate(zip(keyframes, scans, strict=True))
    ]


def smooth_course(times: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, d) values on robust local lines over uneven times.

    Source: W. S. Cleveland, Robust Locally Weighted Regression and Smoothing Scatterplots,
    Journal of the American Statistical Association 74, 1979.
    """
    trust = np.ones(len(times))
    fitted = values
    for _ in range(ROUNDS):
        fitted = np.stack([_local_line(times, values, trust, t) for t in times])
        away = np.linalg.norm(values - fitted, axis=1)
        usual = float(np.median(away))
        if usual <= 1e-12 * (1 + np.abs(values).max()):
            break
        trust = np.maximum(1 - (away / (OUTLYING * usual)) ** 2, 0) ** 2 + 1e-6
    return fitted


def _local_line(
    times: NDArray[np.float64], values: NDArray[np.float64], trust: NDArray[np.float64], at: float
) -> NDArray[np.float64]:
    away = times - at
    reach = np.sort(np.abs(away))[min(WINDOW, len(times)) - 1] * 1.01 + 1e-12
    weight = np.maximum(1 - (np.abs(away) / reach) ** 3, 0) ** 3 * trust
    total = weight.sum()
    mean_time, mean = (weight @ away) / total, (weight @ values) / total
    spread = weight @ (away - mean_time) ** 2
    slope = ((weight * (away - mean_time)) @ values) / spread if spread > 0 else 0.0
    return mean - mean_time * slope


def _organs_of_scans(
    matches: Sequence[Match], organs: Sequence[IntervalOrgans]
) -> list[tuple[Hierarchy, dict[int, int]]]:
    scans = [(matches[0].first, organs[0].first)]
    return scans + [(m.second, o.second) for m, o in zip(matches, organs, strict=True)]


def _poses(
    points: NDArray[np.float32], hierarchy: Hierarchy, named: dict[int, int], vertical: Vertical
) -> dict[int, _Pose]:
    return {
        organ: _pose(points, hierarchy, segment, vertical)
        for segment, organ in named.items()
        if len(hierarchy.segments[segment])
    }


def _pose(
    points: NDArray[np.float32], hierarchy: Hierarchy, segment: int, vertical: Vertical
) -> _Pose:
    from scipy.spatial import cKDTree

    own = points[hierarchy.segments[segment]].astype(float)
    parent = hierarchy.parents[segment]
    if parent == NO_PARENT:
        lowest = np.argsort(vertical.height(own), kind="stable")[: max(1, len(own) // 50)]
        base = own[lowest].mean(axis=0)
    elif not len(hierarchy.segments[parent]):
        base = own[np.argmin(((own - np.median(points, axis=0)) ** 2).sum(axis=1))]
    else:
        bearer = cKDTree(points[hierarchy.segments[parent]])
        base = own[np.argsort(bearer.query(own)[0])[: max(1, len(own) // 50)]].mean(axis=0)
    return _Pose(base, own.mean(axis=0))


def _courses(
    poses: Sequence[dict[int, _Pose]], times: NDArray[np.float64]
) -> dict[int, dict[int, NDArray[np.float64]]]:
    """By organ and scan: the smooth direction from its attachment to its middle, and its base's."""
    courses: dict[int, dict[int, NDArray[np.float64]]] = {}
    for organ in {organ for scan in poses for organ in scan}:
        held = [k for k, scan in enumerate(poses) if organ in scan]
        if len(held) < FEWEST:
            continue
        arms = np.array([poses[k][organ].middle - poses[k][organ].base for k in held])
        bases = np.array([poses[k][organ].base for k in held])
        # In arms, so that bases count by the organ's size and not by the unit of the scans.
        size = float(np.median(np.linalg.norm(arms, axis=1))) or 1.0
        smooth = smooth_course(times[held], np.hstack([_unit(arms), bases / size]))
        courses[organ] = dict(zip(held, smooth * [1, 1, 1, size, size, size], strict=True))
    return courses


def _posed(
    points: NDArray[np.float32],
    hierarchy: Hierarchy,
    named: dict[int, int],
    poses: dict[int, _Pose],
    courses: dict[int, dict[int, NDArray[np.float64]]],
    scan: int,
) -> NDArray[np.float32]:
    """The scan's points, organ by organ from the root on, each carried by what it grows from."""
    posed = points.astype(float)
    carried: dict[int, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
    for segment in hierarchy.from_the_root():
        organ, parent = named[segment], hierarchy.parents[segment]
        turn, shift = carried.get(parent, (np.eye(3), np.zeros(3)))
        members = hierarchy.segments[segment]
        if organ in poses and scan in courses.get(organ, {}):
            pose, course = poses[organ], courses[organ][scan]
            adrift = not len(hierarchy.segments[parent]) if parent != NO_PARENT else True
            base = course[3:] if adrift else turn @ pose.base + shift
            swing = _between(_unit(pose.middle - pose.base), _unit(course[:3]))
            turn, shift = swing, base - swing @ pose.base
        posed[members] = points[members] @ turn.T + shift
        carried[segment] = (turn, shift)
    return posed.astype(np.float32)


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(length, 1e-300)


def _between(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3) the smallest rotation of one unit vector onto another."""
    from scipy.spatial.transform import Rotation

    axis = np.cross(first, second)
    sine, cosine = float(np.linalg.norm(axis)), float(first @ second)
    if sine < 1e-12:
        return np.eye(3)
    return Rotation.from_rotvec(axis / sine * np.arctan2(sine, cosine)).as_matrix()
