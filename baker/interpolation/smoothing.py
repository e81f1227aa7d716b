"""Smooth the directions of organs over the series (`--smooth`).

A plant sways from scan to scan, and scanners err. Every organ keeps its shape and is turned about
its attachment point so that its direction follows a robust smooth curve over the real times; its
children go along. The scans are then no longer met exactly.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.alignment.keyframes import Keyframe
from baker.geometry.rigid import rotations_between
from baker.interpolation.spine import unit
from baker.matching import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

MIN_SCANS = 4  # that show an organ, below which nothing tells swaying from growing
WINDOW = 9  # scans that a local line is fitted to
ROBUST_ITERATIONS, OUTLIER_RATIO = 4, 6.0  # median residuals at which a scan no longer counts


def smooth_organs(
    keyframes: Sequence[Keyframe],
    matches: Sequence[Match],
    times: Sequence[float],
) -> list[Keyframe]:
    """The keyframes with every organ turned about its attachment point onto its smooth direction.

    Organs that fewer than four scans show, and those without a parent, are only carried along.
    """
    scans = [matches[0].first, *(match.second for match in matches)]
    attached = [_bases(frame.positions, scan) for frame, scan in zip(keyframes, scans, strict=True)]
    arms: dict[int, dict[int, NDArray[np.float64]]] = {}  # by organ and scan
    for k, (frame, hierarchy) in enumerate(zip(keyframes, scans, strict=True)):
        for segment, base in attached[k].items():
            middle = frame.positions[hierarchy.segments[segment]].mean(axis=0)
            arms.setdefault(hierarchy.organs[segment], {})[k] = middle - base
    turns: dict[tuple[int, int], NDArray[np.float64]] = {}
    for organ, course in arms.items():
        if len(course) >= MIN_SCANS:
            when = np.asarray([times[k] for k in course])
            directions = unit(np.array([*course.values()]))
            smooth = unit(local_regression(when, directions))
            rotations = rotations_between(directions, smooth)
            turns |= {(organ, k): turn for k, turn in zip(course, rotations, strict=True)}
    smoothed = []
    for k, (frame, hierarchy) in enumerate(zip(keyframes, scans, strict=True)):
        positions = frame.positions.astype(np.float64)
        carried = {NO_PARENT: (np.eye(3), np.zeros(3))}
        for segment in hierarchy.from_the_root():
            turn, shift = carried[hierarchy.parents[segment]]
            organ = hierarchy.organs[segment]
            if (organ, k) in turns:
                base = attached[k][segment]
                shift, turn = turn @ base + shift, turns[organ, k]
                shift = shift - turn @ base
            members = hierarchy.segments[segment]
            positions[members] = positions[members] @ turn.T + shift
            carried[segment] = turn, shift
        smoothed.append(replace(frame, positions=positions.astype(np.float32)))
    return smoothed


def _bases(cloud: NDArray[np.floating], hierarchy: Hierarchy) -> dict[int, NDArray[np.floating]]:
    """By segment that has points, its point nearest to its parent: where it is attached."""
    from scipy.spatial import KDTree

    clouds = [cloud[members] for members in hierarchy.segments]
    pairs = enumerate(zip(clouds, hierarchy.parents, strict=True))
    return {
        segment: own[KDTree(clouds[parent]).query(own)[0].argmin()]
        for segment, (own, parent) in pairs
        if parent != NO_PARENT and len(own) and len(clouds[parent])
    }


def local_regression(
    times: NDArray[np.float64], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(n, d) values on robust local lines over uneven times, (n,).

    References
    ----------
    W. S. Cleveland (1979), Robust Locally Weighted Regression and Smoothing Scatterplots.
    """
    lag = times - times[:, None]
    radius = np.sort(np.abs(lag), axis=1)[:, min(WINDOW, len(times)) - 1] * 1.01 + 1e-12
    tricube = np.maximum(1 - (np.abs(lag) / radius[:, None]) ** 3, 0) ** 3
    trust = np.ones(len(times))
    for _ in range(ROBUST_ITERATIONS):
        weights = tricube * trust
        weights /= weights.sum(axis=1, keepdims=True)
        mean_lag = (weights * lag).sum(axis=1, keepdims=True)
        centered = weights * (lag - mean_lag)
        slope = centered @ values / np.maximum((centered * lag).sum(axis=1, keepdims=True), 1e-300)
        fitted = weights @ values - mean_lag * slope
        residual = np.linalg.norm(values - fitted, axis=1)
        usual = float(np.median(residual))
        if usual <= 1e-12 * (1 + np.abs(values).max()):
            break
        trust = np.maximum(1 - (residual / (OUTLIER_RATIO * usual)) ** 2, 0) ** 2 + 1e-6
    return fitted
