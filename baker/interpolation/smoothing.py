"""Smooth the directions of organs over the series (`--smooth`).

Plants sway from scan to scan, and scanners have errors. Every organ is rotated about its attachment
point, with its children, so that its direction follows a robust smooth curve over time. The clip
then does not reproduce the scans exactly.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.alignment.keyframes import Keyframe
from baker.geometry.rigid import rotations_between
from baker.interpolation.spine import local_lines, unit
from baker.matching import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

MIN_SCANS = 4  # with an organ; in fewer, swaying can't be distinguished from growth
WINDOW = 9  # number of scans that a local line is fitted to
ROBUST_ITERATIONS, OUTLIER_RATIO = 4, 6.0  # residual : median, at which the weight is 0


def smooth_organs(
    keyframes: Sequence[Keyframe], matches: Sequence[Match], times: Sequence[float]
) -> list[Keyframe]:
    """Rotate every organ about its attachment point to its smoothed direction.

    Organs in fewer than `MIN_SCANS` scans, and those without a parent, only move with their parent.

    Parameters
    ----------
    keyframes : sequence of Keyframe
    matches : sequence of Match
        Of successive intervals, with organs.
    times : sequence of float
        Of the scans.
    """
    scans = [matches[0].first, *(match.second for match in matches)]
    attachments = list(map(_attachments, [frame.positions for frame in keyframes], scans))
    offsets: dict[int, dict[int, NDArray[np.float64]]] = {}  # of centroids, by organ and scan
    for k, (frame, hierarchy) in enumerate(zip(keyframes, scans, strict=True)):
        for segment, point in attachments[k].items():
            centroid = frame.positions[hierarchy.segments[segment]].mean(axis=0)
            offsets.setdefault(hierarchy.organs[segment], {})[k] = centroid - point
    rotations: dict[tuple[int, int], NDArray[np.float64]] = {}
    for organ, by_scan in offsets.items():
        if len(by_scan) >= MIN_SCANS:
            directions = unit(np.array([*by_scan.values()]))
            organ_times = np.asarray([times[k] for k in by_scan])
            smooth = unit(local_regression(organ_times, directions))
            organ_rotations = rotations_between(directions, smooth)
            rotations |= {(organ, k): r for k, r in zip(by_scan, organ_rotations, strict=True)}
    smoothed = []
    for k, (frame, hierarchy) in enumerate(zip(keyframes, scans, strict=True)):
        positions = frame.positions.astype(np.float64)
        motions = {NO_PARENT: (np.eye(3), np.zeros(3))}
        for segment in hierarchy.from_the_root():
            rotation, shift = motions[hierarchy.parents[segment]]
            organ = hierarchy.organs[segment]
            if (organ, k) in rotations:
                point = attachments[k][segment]
                shift, rotation = rotation @ point + shift, rotations[organ, k]
                shift = shift - rotation @ point
            members = hierarchy.segments[segment]
            positions[members] = positions[members] @ rotation.T + shift
            motions[segment] = rotation, shift
        smoothed.append(replace(frame, positions=positions.astype(np.float32)))
    return smoothed


def _attachments(
    cloud: NDArray[np.floating], hierarchy: Hierarchy
) -> dict[int, NDArray[np.floating]]:
    """Segment -> its point nearest to its parent, for segments with points."""
    from scipy.spatial import KDTree

    clouds = [cloud[members] for members in hierarchy.segments]
    pairs = enumerate(zip(clouds, hierarchy.parents, strict=True))
    return {
        segment: points[KDTree(clouds[parent]).query(points)[0].argmin()]
        for segment, (points, parent) in pairs
        if parent != NO_PARENT and len(points) and len(clouds[parent])
    }


def local_regression(
    times: NDArray[np.float64], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Smooth (n, d) values over (n,) times by robust local linear regression (LOWESS).

    References
    ----------
    W. S. Cleveland (1979), Robust Locally Weighted Regression and Smoothing Scatterplots.
    """
    lag = times - times[:, None]
    radius = np.sort(np.abs(lag), axis=1)[:, min(WINDOW, len(times)) - 1] * 1.01 + 1e-12
    tricube = np.maximum(1 - (np.abs(lag) / radius[:, None]) ** 3, 0) ** 3
    robustness = np.ones(len(times))
    for _ in range(ROBUST_ITERATIONS):
        fitted, _ = local_lines(tricube * robustness, lag, values, 1e-300)
        residual = np.linalg.norm(values - fitted, axis=1)
        median = float(np.median(residual))
        if median <= 1e-12 * (1 + np.abs(values).max()):
            break
        robustness = np.maximum(1 - (residual / (OUTLIER_RATIO * median)) ** 2, 0) ** 2 + 1e-6
    return fitted
