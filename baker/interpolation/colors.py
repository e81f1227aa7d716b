"""What colours the points carry from scan to scan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.movers import Keyframe
from baker.interpolation.palette import organ_colors
from baker.scans import Scan
from baker.segmentation.hierarchy import Hierarchy


def painted(
    keyframes: Sequence[Keyframe],
    scans: Sequence[Scan],
    hierarchies: Sequence[Hierarchy],
    colors: str,
) -> list[Keyframe]:
    """The keyframes in the colours to carry: "scan", "segment" or "none".

    "segment" gives every scan's segments colours by their own numbers in that scan (its labels,
    where it has some): matched segments blend from one to the other over time, which shows the
    matching (the paper's Figure 8).
    """
    if colors == "scan":
        return list(keyframes)
    if colors == "none":
        return [replace(frame, colors=None) for frame in keyframes]
    return [
        replace(
            frame, colors=_by_number(hierarchy.numbers() if scan.labels is None else scan.labels)
        )
        for frame, scan, hierarchy in zip(keyframes, scans, hierarchies, strict=True)
    ]


def _by_number(numbers: NDArray[np.integer]) -> NDArray[np.uint8]:
    """(N, 4) sRGB and alpha, one colour for each of the numbers, in ascending order."""
    values, rank = np.unique(numbers, return_inverse=True)
    palette = np.array([(*color, 255) for color in organ_colors(len(values))], np.uint8)
    return palette[rank]
