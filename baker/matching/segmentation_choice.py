"""Choose between several segmentations of each scan, such that organs match from scan to scan.

A leaf that is cut in two, or taken for a part of the stem, in one scan alone has no counterpart in
the adjacent scans. The choices by which organs match best over the whole series are found by
dynamic programming.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import best_path
from baker.geometry.parallel import MapLike
from baker.matching.descriptors import OrganDescriptors, describe_organs
from baker.matching.plant_motion import plant_motions
from baker.matching.score import matched_share

Labels = NDArray[np.int64]
Scan = Sequence[OrganDescriptors]  # one for each segmentation


def choose_segmentations(
    clouds: Sequence[NDArray[np.floating]],
    bases: Sequence[int],
    candidates: Sequence[Sequence[Labels]],
    map: MapLike = map,
) -> list[Labels]:
    """Choose the segmentation of each scan.

    clouds, bases: for each scan its (N, 3) aligned points, and the index of the one at the plant
    base. candidates: for each scan the (N,) labels of several segmentations, of which the first is
    preferred where all match as well. map: maps over scans and intervals.
    """

    def describe(cloud: NDArray[np.floating], base: int, segmentations: Sequence[Labels]) -> Scan:
        return [describe_organs(cloud, labels, base) for labels in segmentations]

    organs = list(map(describe, clouds, bases, candidates))
    motions = plant_motions([scan[0] for scan in organs], map)
    path = best_path(map(_matched_shares, organs, organs[1:], motions))
    return [labels[k] for labels, k in zip(candidates, path, strict=True)]


def _matched_shares(first: Scan, second: Scan, motion: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, m) shares by which n segmentations of a scan, moved, match m of the next one."""
    moved = [organs.transformed(motion) for organs in first]
    return np.array([[matched_share(organs, later) for later in second] for organs in moved])
