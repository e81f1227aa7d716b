"""Whether organs that were followed by their shape are the same organs in the next scan."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.matching import Match
from baker.matching.descriptors import OrganDescriptors, describe_organs
from baker.matching.score import match_scores
from baker.segmentation.hierarchy import Hierarchy
from baker.verdict.doubt import MIN_SHARE

# From these values on it is doubtful which organ one is (docs/method.md, "The verdict").
MIN_MARGIN = 0.1  # of a pair's score over that of another choice: what a turn by 20 degrees costs
# Of an organ's size, over that of the plant's organs: young ones grow fast, none shrinks much.
MAX_GROWTH, MAX_SHRINKAGE = 6.0, 3.0
MAX_BORN_SHARE = 0.2  # of a scan's points, in a new organ
MIN_SIZE = 1e-100  # of an organ: its square is still a number


@dataclass(frozen=True)
class FollowedOrgans:
    """A series whose organs were followed by their shape."""

    clouds: Sequence[NDArray[np.floating]]  # (N, 3), of each scan
    bases: Sequence[int]  # index of the point at each plant base
    matches: Sequence[Match]  # of each interval
    stem: bool  # whether the organ at the plant base is known to be the stem
    # (interval, label) of organs that someone said are the same at both ends
    confirmed: Collection[tuple[int, int | None]] = ()


class IdentityDoubt(NamedTuple):
    """One organ that may be another."""

    track: int
    what: str  #: of its {name}, and of the {other} organ that it may be
    strength: float
    other: int | None = None


@dataclass(frozen=True)
class _Organs:
    """The organs of a scan: segments of its hierarchy, some of which may have no points."""

    segments: NDArray[np.intp]  # those that have points
    described: OrganDescriptors  # these
    share: NDArray[np.float64]  # by segment, of the scan's points
    size: NDArray[np.float64]  # by segment, over that of the plant's organs


def doubtful_identities(series: FollowedOrgans, index: int) -> Iterator[IdentityDoubt]:
    """Judge the matches, births and losses of an interval."""
    match = series.matches[index]
    tracks, later_tracks = match.first.organs, match.second.organs
    first, second = _organs(series, index, match.first), _organs(series, index + 1, match.second)
    scores = np.zeros((len(first.share), len(second.share)))
    scores[np.ix_(first.segments, second.segments)] = match_scores(
        first.described, second.described, _matched(first, second, match)
    )
    for pair in match.pairs:
        scores[pair] -= MIN_MARGIN
    became = dict(best_pairs(scores))
    came_from = {b: a for a, b in became.items()}
    for a, b in match.pairs:
        shares = first.share[a], second.share[b]
        if (index, match.first.labels[a]) in series.confirmed:
            continue
        if a == match.first.root or min(shares) == 0.0 or max(shares) < MIN_SHARE:
            continue
        organ, growth = tracks[a], float(second.size[b] / first.size[a])
        if became.get(a) != b and (a in became or b in came_from):
            rival = tracks[came_from[b]] if b in came_from else later_tracks[became[a]]
            yield IdentityDoubt(organ, "{name} and {other} may be mixed up", 1.0, rival)
        if growth > MAX_GROWTH:
            what = "{name} may be two organs (suddenly much larger)"
            yield IdentityDoubt(organ, what, growth / MAX_GROWTH)
        if growth * MAX_SHRINKAGE < 1.0:
            what = "{name} may lack a part (suddenly much smaller)"
            yield IdentityDoubt(organ, what, 1.0 / (max(growth, 1e-3) * MAX_SHRINKAGE))
    for a in match.losses:
        if (strength := float(first.share[a]) / MIN_SHARE) >= 1.0:
            yield IdentityDoubt(tracks[a], "{name} is large but vanishes", strength)
    for b in match.births:
        if (strength := float(second.share[b]) / MAX_BORN_SHARE) >= 1.0:
            yield IdentityDoubt(later_tracks[b], "{name} is large but new", strength)


def best_pairs(scores: NDArray[np.float64]) -> list[tuple[int, int]]:
    """The pairs, by row, of the greatest total (n, m) score; what gains nothing is left alone.

    An interval by itself is matched so, where organs are followed through the whole series.
    """
    from scipy.optimize import linear_sum_assignment

    gains = np.maximum(scores, 0.0)
    pairs = np.column_stack(linear_sum_assignment(gains, maximize=True))
    return [(i, j) for i, j in pairs.tolist() if gains[i, j] > 0.0]


def _matched(first: _Organs, second: _Organs, match: Match) -> list[tuple[int, int]]:
    """The pairs of a match, by index among the organs that have points."""
    starts, ends = (
        {segment: index for index, segment in enumerate(organs.segments.tolist())}
        for organs in (first, second)
    )
    return [(starts[a], ends[b]) for a, b in match.pairs if a in starts and b in ends]


def _organs(series: FollowedOrgans, scan: int, hierarchy: Hierarchy) -> _Organs:
    cloud, base = series.clouds[scan], series.bases[scan]
    described = describe_organs(cloud, hierarchy, base, stem=series.stem)
    counts = np.array([len(own) for own in hierarchy.segments])
    size = np.zeros(len(counts))
    size[counts > 0] = np.maximum(described.sizes, MIN_SIZE)
    size /= np.sqrt((size[counts > 0] ** 2).mean())
    return _Organs(np.flatnonzero(counts), described, counts / len(cloud), size)
