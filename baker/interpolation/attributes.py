"""Attributes of movers besides positions: colours, and scalar fields of the scans (NDVI, ...)."""

from collections.abc import Sequence
from colorsys import hls_to_rgb
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.alignment.keyframes import Keyframe
from baker.scans.scan import Scan
from baker.segmentation.hierarchy import Hierarchy
from gclip import Clip, Motion
from gclip.evaluate import positions_on_curve

STEM_COLOR = (122, 158, 72)  # a muted green, unlike the colours of the organs
GOLDEN_ANGLE = 0.381966  # of a turn, between the hues of successive organs
FIRST_HUE = 0.095  # of a turn: orange
LIGHTNESSES, SATURATION = (0.56, 0.66, 0.46), 0.72  # in HLS


def organ_colors(count: int) -> list[tuple[int, int, int]]:
    """Make `count` 8-bit sRGB colours for tracks, that of the root first.

    Hues advance by the golden angle; the lightness changes after every eight colours.
    """
    colors = [STEM_COLOR]
    for index in range(count - 1):
        lightness = LIGHTNESSES[index // 8 % 3]
        rgb = hls_to_rgb((FIRST_HUE + GOLDEN_ANGLE * index) % 1.0, lightness, SATURATION)
        colors.append((round(255 * rgb[0]), round(255 * rgb[1]), round(255 * rgb[2])))
    return colors[:count]


def with_colors(
    keyframes: Sequence[Keyframe],
    scans: Sequence[Scan],
    hierarchies: Sequence[Hierarchy],
    colors: str,
) -> list[Keyframe]:
    """Set the colours of keyframes.

    scans: as they were read. colors: "scan", "none" or "segment", which colours segments by their
    numbers (or labels) in each scan, so that the colours of matched segments are interpolated over
    time and show the matching (the paper's Figure 8).
    """
    if colors == "scan":
        return list(keyframes)
    if colors == "none":
        return [replace(frame, colors=None) for frame in keyframes]
    result = []
    for frame, scan, hierarchy in zip(keyframes, scans, hierarchies, strict=True):
        numbers = hierarchy.numbers() if scan.labels is None else scan.labels
        values, rank = np.unique(numbers, return_inverse=True)
        palette = np.array([(*color, 255) for color in organ_colors(len(values))], np.uint8)
        result.append(replace(frame, colors=palette[rank]))
    return result


def with_fields(clip: Clip, clouds: Sequence[NDArray[np.float32]], scans: Sequence[Scan]) -> Clip:
    """Add the scalar fields of the scans to a clip: values at the start and end of each mover.

    Movers of an organ that only one of the two scans shows have its values there at both ends.

    clouds: (N, 3) aligned points of each scan, relative to the clip's origin. scans: with `scalars`
    of the same names.
    """
    from scipy.spatial import cKDTree

    scalars = [scan.scalars for scan in scans]
    if not scalars[0]:
        return clip
    trees, born = [cKDTree(cloud) for cloud in clouds], np.array([t.born for t in clip.track_table])
    intervals = []
    for k, interval in enumerate(clip.intervals):
        first, last = (
            trees[k + u].query(positions_on_curve(interval, slice(None), u))[1] for u in (0, 1)
        )
        newborn = born[np.asarray(interval.tracks)] > interval.start
        counts = [group.count for group in interval.groups]
        lost = np.repeat([group.motion is not Motion.MOVE for group in interval.groups], counts)
        fields = []
        for name in scalars[0]:
            start, end = scalars[k][name][first], scalars[k + 1][name][last]
            ends = np.where(newborn, end, start), np.where(lost, start, end)
            fields.append(np.stack(ends, axis=1))
        intervals.append(replace(interval, fields=tuple(fields)))
    return replace(clip, fields=tuple(scalars[0]), intervals=tuple(intervals))
