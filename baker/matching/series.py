"""All scans of a series matched, each to the next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from baker.matching.hierarchical import GreedyRules, match_greedily
from baker.matching.match import Match, match_by_label
from baker.segmentation.hierarchy import Hierarchy


def match_series(
    clouds: Sequence[NDArray[np.floating]],
    hierarchies: Sequence[Hierarchy],
    *,
    by_label: bool,
    rules: GreedyRules,
    tell: Callable[[int, int], None],
) -> list[Match]:
    """Match each scan to the next: by label, or down the hierarchies where there are none.

    What is merged in a scan for the interval before it stays merged in the interval after it.

    tell: called with how many segments are matched, and of how many.
    """
    from baker.transport.wasserstein import least_distance, wasserstein

    matches: list[Match] = []
    sizes = [len(hierarchy.segments) for hierarchy in hierarchies[1:]]
    tell(0, sum(sizes))
    for k, following in enumerate(hierarchies[1:]):
        current = matches[-1].second if matches else hierarchies[0]
        if by_label:
            match = match_by_label(current, following)
        else:
            pair = clouds[k], clouds[k + 1]
            match = match_greedily(
                pair,
                (current, following),
                wasserstein,
                rules,
                bound=least_distance,
                done=partial(_tell_on, tell, sum(sizes[:k]), sum(sizes)),
            )
        matches.append(match)
        tell(sum(sizes[: k + 1]), sum(sizes))
    return matches


def _tell_on(tell: Callable[[int, int], None], before: int, total: int, here: int) -> None:
    tell(before + here, total)
