"""Smooth the directions of organs over the series (`--smooth`).

Plants sway from scan to scan, and scanners have errors. Every organ is rotated about its attachment
point, with its children, so that its direction follows a robust smooth curve over time. The clip
then does not reproduce the scans exactly.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.rigid import rotations_between
from baker.interpolation.organ_shapes import Attachments
from baker.interpolation.spine import local_lines, unit
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

MIN_SCANS = 4  # with an organ; in fewer, swaying can't be distinguished from growth
WINDOW = 9  # number of scans to which a local line is fitted
ROBUST_ITERATIONS, OUTLIER_RATIO = 4, 6.0  # ratio of a residual of weight 0 to the median


def smooth_organs(
    clouds: Sequence[NDArray[np.float32]],
    hierarchies: Sequence[Hierarchy],
    attachments: Sequence[Attachments],
    times: Sequence[float],
) -> list[NDArray[np.float32]]:
    """Rotate every organ about its attachment to its smoothed direction.

    Organs in fewer than `MIN_SCANS` scans, and those without an attachment, only move with their
    parent. Takes and returns the (N, 3) points of each scan. times: of the scans, in days.
    """
    middles = [{n: contact.mean(axis=0) for n, contact in scan.items()} for scan in attachments]
    rotations: list[dict[int, NDArray[np.float64]]] = [{} for _ in clouds]
    for organ in set().union(*middles):
        scans = [k for k, contacts in enumerate(middles) if organ in contacts]
        if len(scans) >= MIN_SCANS:
            segments = [hierarchies[k].segments[hierarchies[k].organs.index(organ)] for k in scans]
            centroids = [clouds[k][s].mean(axis=0) for k, s in zip(scans, segments, strict=True)]
            directions = unit(np.array(centroids) - [middles[k][organ] for k in scans])
            targets = unit(local_regression(np.array([times[k] for k in scans]), directions))
            for k, rotation in zip(scans, rotations_between(directions, targets), strict=True):
                rotations[k][organ] = rotation
    smoothed = [cloud.copy() for cloud in clouds]
    for cloud, hierarchy, middle, organ_rotations in zip(
        smoothed, hierarchies, middles, rotations, strict=True
    ):
        motions = {NO_PARENT: (np.eye(3), np.zeros(3))}
        for segment in hierarchy.parents_first():
            rotation, shift = motions[hierarchy.parents[segment]]
            organ, members = hierarchy.organs[segment], hierarchy.segments[segment]
            if organ in organ_rotations:
                shift = shift + (rotation - organ_rotations[organ]) @ middle[organ]
                rotation = organ_rotations[organ]
            cloud[members] = cloud[members] @ rotation.T + shift
            motions[segment] = rotation, shift
    return smoothed


def local_regression(
    times: NDArray[np.float64], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Smooth (n, d) values over (n,) times by robust local linear regression (LOWESS).

    References
    ----------
    W. S. Cleveland (1979), Robust Locally Weighted Regression and Smoothing Scatterplots.
    """
    lag = times - times[:, None]
    radius = np.sort(np.abs(lag), axis=1)[:, [min(WINDOW, len(times)) - 1]] * 1.01 + 1e-12
    tricube = np.maximum(1 - (np.abs(lag) / radius) ** 3, 0) ** 3
    robustness = np.ones(len(times))
    for _ in range(ROBUST_ITERATIONS):
        fitted, _ = local_lines(tricube * robustness, lag, values, 1e-300)
        residual = np.linalg.norm(values - fitted, axis=1)
        scale = OUTLIER_RATIO * np.median(residual) + 1e-12
        robustness = np.maximum(1 - (residual / scale) ** 2, 0) ** 2 + 1e-6
    return fitted
