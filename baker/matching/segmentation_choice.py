"""Choose between several segmentations of each scan, such that organs match from scan to scan.

A leaf that is cut in two, or taken for a part of the stem, in one scan alone has no counterpart in
the adjacent scans. The choices by which organs match best over the whole series are found by
dynamic programming (Viterbi 1967).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.matching.descriptors import OrganDescriptors, describe_organs
from baker.matching.plant_motion import plant_motion
from baker.matching.score import matched_share
from baker.segmentation.from_labels import coarse_hierarchies

Labels = NDArray[np.int64]


def choose_segmentations(
    clouds: Sequence[NDArray[np.floating]],
    bases: Sequence[int],
    candidates: Sequence[Sequence[Labels]],
    stem: bool = True,
    map: MapLike = map,
) -> list[Labels]:
    """Choose the segmentation of each scan.

    clouds, bases: for each scan its (N, 3) aligned points, and the index of the one at the plant
    base. candidates: for each scan the (N,) labels of several segmentations, of which the first is
    preferred where all match as well. stem: whether the organ at the plant base is known to be the
    stem of all others. map: maps over scans and intervals.
    """

    def describe(
        cloud: NDArray[np.floating], base: int, segmentations: Sequence[Labels]
    ) -> list[OrganDescriptors]:
        scan = [cloud] * len(segmentations), segmentations, [base] * len(segmentations)
        return [describe_organs(cloud, h, base, stem=stem) for h in coarse_hierarchies(*scan)]

    organs = list(map(describe, clouds, bases, candidates))
    total, best_before = np.zeros(len(candidates[0])), []
    for shares in map(_matched_shares, organs, organs[1:]):
        totals = total[:, None] + shares
        best_before.append(totals.argmax(axis=0))
        total = totals.max(axis=0)
    chosen = [int(total.argmax())]
    for best in reversed(best_before):
        chosen.append(int(best[chosen[-1]]))
    return [labels[k] for labels, k in zip(candidates, reversed(chosen), strict=True)]


def _matched_shares(
    first: Sequence[OrganDescriptors], second: Sequence[OrganDescriptors]
) -> NDArray[np.float64]:
    """(n, m) shares by which n segmentations of a scan match m of the next one."""
    motion = plant_motion(first[0], second[0])
    moved = [organs.transformed(motion) for organs in first]
    return np.array([[matched_share(organs, later) for later in second] for organs in moved])
