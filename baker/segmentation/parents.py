"""Who grows from whom, as all scans of a series agree on it.

In a dense crown leaves touch branches that don't bear them, and in a single scan they may be nearer
to those than a branch is to its own bearer. What bears an organ touches it in every scan.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.contacts import REACH, Gaps


def agreed_gaps(
    labels: Sequence[NDArray[np.integer]], touching: Sequence[Gaps], spacings: Sequence[float]
) -> Gaps:
    """How far what may bear an organ is from it in all scans, by their labels.

    labels:   (N,) of each scan; the same organ has the same label in all.
    touching: of each scan, as `baker.geometry.contacts` finds them.
    spacings: of each scan's points.

    Of two that touch in some scan the mean over those that show both, in point spacings; where they
    don't touch they are as far apart as what barely does. Nothing grows from what is younger.
    """
    shown = [set(np.unique(names).tolist()) for names in labels]
    first = {label: scan for scan in reversed(range(len(shown))) for label in shown[scan]}
    pairs = sorted({pair for gaps in touching for pair in gaps})
    return {
        pair: float(
            np.mean(
                [
                    gaps.get(pair, REACH * spacing) / spacing
                    for gaps, spacing, there in zip(touching, spacings, shown, strict=True)
                    if there.issuperset(pair)
                ]
            )
        )
        for pair in pairs
        if first[pair[1]] <= first[pair[0]]
    }
