"""Are the labels of successive scans names of organs, or numbers given anew in every scan?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.interval import Keyframe
from baker.scans.scan import Scan
from baker.segment.hierarchy import split_by_label

SAMPLE = 500


@dataclass(frozen=True)
class LabelUse:
    """used: the labels segment the scans; consistent: they also name organs over time."""

    used: bool
    consistent: bool
    sentence: str


def use_of_labels(scans: Sequence[Scan], keyframes: Sequence[Keyframe], wanted: str) -> LabelUse:
    """Decide how labels are used; `wanted` is auto, consistent, independent or ignore.

    auto: consistent if, from scan to scan, more organs lie nearest to the organ of their own label
    than to any other one (aligned positions are needed). Raises InputError where labels are asked
    for and the scans have none.
    """
    if wanted == "ignore":
        return LabelUse(False, False, "labels ignored, as asked")
    if any(scan.labels is None for scan in scans):
        if wanted != "auto":
            without = next(scan.name for scan in scans if scan.labels is None)
            raise InputError(f"{without} has no labels; --labels {wanted} needs them.")
        return LabelUse(False, False, "the scans have no labels")
    if wanted == "consistent":
        return LabelUse(True, True, "labels name the same organs in all scans, as asked")
    if wanted == "independent":
        return LabelUse(True, False, "labels are matched anew from scan to scan, as asked")
    share = _share_in_place(scans, keyframes)
    if share > 0.5:
        return LabelUse(
            True, True, f"labels taken as consistent: {share:.0%} of the organs stay in place"
        )
    return LabelUse(
        True, False, f"labels taken as independent: only {share:.0%} of the organs stay in place"
    )


def _share_in_place(scans: Sequence[Scan], keyframes: Sequence[Keyframe]) -> float:
    """Of the organs whose label the next scan has too, how many are nearest to their namesake."""
    stays = []
    clouds = [_organs(s, k) for s, k in zip(scans, keyframes, strict=True)]
    for first, second in pairwise(clouds):
        for label, points in first.items():
            if label in second:
                nearest = min(second, key=lambda other: _apart(points, second[other]))
                stays.append(nearest == label)
    return float(np.mean(stays)) if stays else 0.0


def _organs(scan: Scan, keyframe: Keyframe) -> dict[int, NDArray[np.float32]]:
    assert scan.labels is not None
    names, members = split_by_label(scan.labels)
    return {
        name: keyframe.positions[own[:: -(-len(own) // SAMPLE)]]
        for name, own in zip(names, members, strict=True)
    }


def _apart(a: NDArray[np.float32], b: NDArray[np.float32]) -> float:
    """Mean distance between two organs' points, both ways."""
    from scipy.spatial import cKDTree

    return float(cKDTree(a).query(b)[0].mean() + cKDTree(b).query(a)[0].mean())
