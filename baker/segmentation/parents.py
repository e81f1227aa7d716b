"""Parents of organs, decided by all scans of a series together.

In a dense crown leaves touch branches that they don't grow from, and in a single scan they may be
nearer to those than a branch is to its own parent. An organ's parent touches it in every scan.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.adjacency import MAX_GAP, Gaps


def agreed_gaps(
    labels: Sequence[NDArray[np.integer]], adjacency: Sequence[Gaps], spacings: Sequence[float]
) -> Gaps:
    """Mean gaps between an organ and what it may grow from, over all scans that show both.

    Parameters
    ----------
    labels : sequence of (N,) int
        Of each scan; the same organ has the same label in all.
    adjacency : sequence of Gaps
        `segment_adjacency` of each scan.
    spacings : sequence of float
        Point spacing of each scan.

    Returns
    -------
    dict
        From (organ, possible parent) to the mean gap in point spacings, of all that touch in some
        scan; where they don't, they are as far apart as what barely touches. Nothing grows from
        what is younger.
    """
    shown = [set(np.unique(names).tolist()) for names in labels]
    first = {label: scan for scan in reversed(range(len(shown))) for label in shown[scan]}
    pairs = sorted({pair for gaps in adjacency for pair in gaps})
    return {
        pair: float(
            np.mean(
                [
                    gaps.get(pair, MAX_GAP * spacing) / spacing
                    for gaps, spacing, present in zip(adjacency, spacings, shown, strict=True)
                    if present.issuperset(pair)
                ]
            )
        )
        for pair in pairs
        if first[pair[1]] <= first[pair[0]]
    }
