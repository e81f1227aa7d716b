"""What movers carry besides their places: colours, and the scans' own scalar fields (NDVI, ...)."""

from __future__ import annotations

from collections.abc import Sequence
from colorsys import hls_to_rgb
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.alignment.keyframes import Keyframe
from baker.scans import Scan
from baker.segmentation.hierarchy import Hierarchy
from gclip import Clip, Motion, PointField
from gclip.evaluate import positions_on_curve

STEM_COLOR = (122, 158, 72)  # a plant's own green, which doesn't compete with the organs' colours
GOLDEN_ANGLE = 0.381966  # of a turn: neighbours in age get hues that lie far apart
FIRST_HUE = 0.095


def organ_colors(count: int) -> list[tuple[int, int, int]]:
    """`count` sRGB colours for the tracks, the root's first.

    Hues go round by the golden angle; each round is a little lighter or darker than the last one.
    """
    colors = [STEM_COLOR]
    for index in range(count - 1):
        lightness = (0.56, 0.66, 0.46)[index // 8 % 3]
        rgb = hls_to_rgb((FIRST_HUE + GOLDEN_ANGLE * index) % 1.0, lightness, 0.72)
        colors.append((round(255 * rgb[0]), round(255 * rgb[1]), round(255 * rgb[2])))
    return colors[:count]


def painted(
    keyframes: Sequence[Keyframe],
    scans: Sequence[Scan],
    hierarchies: Sequence[Hierarchy],
    colors: str,
) -> list[Keyframe]:
    """The keyframes in the colours that the clip is to carry.

    Parameters
    ----------
    keyframes : sequence of Keyframe
    scans : sequence of Scan
        The same scans as they were read, with their colours.
    hierarchies : sequence of Hierarchy
    colors : {"scan", "segment", "none"}
        "segment" gives every scan's segments colours by their own numbers in that scan (its labels,
        where it has some): matched segments blend over time, which shows the matching.

    Returns
    -------
    list of Keyframe

    References
    ----------
    Figure 8 of the paper, for "segment".
    """
    if colors == "scan":
        return list(keyframes)
    if colors == "none":
        return [replace(frame, colors=None) for frame in keyframes]
    found = []
    for frame, scan, hierarchy in zip(keyframes, scans, hierarchies, strict=True):
        numbers = hierarchy.numbers() if scan.labels is None else scan.labels
        values, rank = np.unique(numbers, return_inverse=True)
        palette = np.array([(*color, 255) for color in organ_colors(len(values))], np.uint8)
        found.append(replace(frame, colors=palette[rank]))
    return found


def with_fields(clip: Clip, clouds: Sequence[NDArray[np.float32]], scans: Sequence[Scan]) -> Clip:
    """The clip with its scans' fields on the movers: at both ends, those of the points there.

    Parameters
    ----------
    clip : Clip
        An organ that is born, or lost, has the values of the one scan that shows it throughout.
    clouds : sequence of (N, 3) float32 ndarray
        The scans about the clip's origin.
    scans : sequence of Scan
        With fields (`scalars`) of the same names.
    """
    from scipy.spatial import cKDTree

    scalars = [scan.scalars for scan in scans]
    if not scalars[0]:
        return clip
    trees, born = [cKDTree(cloud) for cloud in clouds], np.array([t.born for t in clip.track_table])
    values: dict[str, list[NDArray[np.float32]]] = {name: [] for name in scalars[0]}
    for k, interval in enumerate(clip.intervals):
        first, last = (
            trees[k + u].query(positions_on_curve(interval, slice(None), u))[1] for u in (0, 1)
        )
        newborn = born[np.asarray(interval.tracks)] > interval.start
        lost = np.zeros(len(interval), bool)
        for group in interval.groups:
            lost[group.first : group.stop] = group.motion is not Motion.MOVE
        for name, found in values.items():
            start, end = scalars[k][name][first], scalars[k + 1][name][last]
            ends = np.where(newborn, end, start), np.where(lost, start, end)
            found.append(np.stack(ends, axis=1))
    fields = tuple(PointField(name, tuple(found)) for name, found in values.items())
    return replace(clip, fields=fields)
