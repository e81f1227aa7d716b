"""All scans of a series matched, each to the next."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.match.greedy import GreedyRules, match_greedily
from baker.match.match import Match, match_by_label
from baker.segment.hierarchy import Hierarchy


def match_series(
    clouds: Sequence[NDArray[np.floating]],
    hierarchies: Sequence[Hierarchy],
    *,
    by_label: bool,
    rules: GreedyRules,
    done: Callable[[int], None],
) -> list[Match]:
    """Match each scan to the next: by label, or down the hierarchies where there are none.

    What is merged in a scan for the interval before it stays merged in the interval after it.
    """
    from baker.transport.distance import wasserstein

    matches: list[Match] = []
    for k, following in enumerate(hierarchies[1:]):
        current = matches[-1].second if matches else hierarchies[0]
        if by_label:
            match = match_by_label(current, following)
        else:
            pair = clouds[k], clouds[k + 1]
            match = match_greedily(pair, (current, following), wasserstein, rules)
        matches.append(match)
        done(k + 1)
    return matches
