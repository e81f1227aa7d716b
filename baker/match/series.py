"""All scans of a series matched, each to the next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

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
    if by_label:
        return [match_by_label(a, b) for a, b in pairwise(hierarchies)]

    from baker.transport.distance import wasserstein

    matches: list[Match] = []
    current = hierarchies[0]
    for k, following in enumerate(hierarchies[1:]):
        match = match_greedily((clouds[k], clouds[k + 1]), (current, following), wasserstein, rules)
        matches.append(match)
        current = match.second
        done(k + 1)
    return matches
