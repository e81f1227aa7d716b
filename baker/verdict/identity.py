"""Whether organs that were followed by their shape are the same organs in the next scan.

The matching's own score tells how much better its choice is than the second best.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.matching import IntervalOrgans, Match
from baker.matching.descriptors import describe_organs
from baker.matching.score import match_scores
from baker.segmentation.hierarchy import Hierarchy

# From these values on it is doubtful which organ one is (docs/method.md, "The verdict").
MIN_MARGIN = 0.4  # of the score: what a turn by 75 degrees costs
OUT_OF_THE_QUESTION = -1.0  # the least score that counts; a pair may be matched for other reasons
MIN_SIZE = 1e-100  # of an organ: its square is still a number
MAX_GROWTH = 2.5  # of an organ's size, over that of the plant's organs; or one by that
MAX_LOST_SHARE = 0.05  # of a scan's points, in an organ that the next scan lacks
MAX_BORN_SHARE = 0.1  # likewise in a new organ


@dataclass(frozen=True)
class FollowedOrgans:
    """A series whose organs were followed by their shape."""

    clouds: Sequence[NDArray[np.floating]]  # (N, 3), of each scan
    bases: Sequence[int]  # index of the point at each plant base
    matches: Sequence[Match]  # of each interval
    tracks: Sequence[IntervalOrgans]
    stem: bool  # whether the organ at the plant base is known to be the stem


class IdentityDoubt(NamedTuple):
    """One organ that may be another."""

    track: int
    what: str  #: of its {name}, and of the {other} organ that it may be
    strength: float
    other: int | None = None


def doubtful_identities(series: FollowedOrgans, index: int) -> Iterator[IdentityDoubt]:
    """Judge the matches, births and losses of an interval."""
    match, tracks = series.matches[index], series.tracks[index]
    first, second = (
        describe_organs(series.clouds[k], hierarchy, series.bases[k], stem=series.stem)
        for k, hierarchy in ((index, match.first), (index + 1, match.second))
    )
    row, column = _places(match.first), _places(match.second)
    pairs = [(a, b) for a, b in match.pairs if a in row and b in column and a != match.first.root]
    lost, born = [s for s in match.losses if s in row], [s for s in match.births if s in column]
    rows, columns = [row[a] for a, _ in pairs], [column[b] for _, b in pairs]
    gone, new = [row[s] for s in lost], [column[s] for s in born]
    margins, rivals = second_best(match_scores(first, second), rows, columns, gone, new)
    sizes = [np.maximum(organs.sizes, MIN_SIZE) for organs in (first, second)]
    before, after = (own / np.linalg.norm(own) * np.sqrt(len(own)) for own in sizes)
    growth = after[columns] / before[rows]
    organs = [*(tracks.first[a] for a, _ in pairs), *(tracks.first[s] for s in lost)]
    organs += [tracks.second[s] for s in born]
    for organ, margin, rival, factor in zip(organs, margins, rivals, growth.tolist(), strict=False):
        if margin < MIN_MARGIN and rival >= 0:
            what = "{name} and {other} may be mixed up"
            yield IdentityDoubt(organ, what, 2.0 - margin / MIN_MARGIN, organs[rival])
        if factor > MAX_GROWTH:
            what = "{name} is suddenly much larger and may be two organs"
            yield IdentityDoubt(organ, what, factor / MAX_GROWTH)
        if factor * MAX_GROWTH < 1.0:
            what = "{name} is suddenly much smaller and may lack a part"
            yield IdentityDoubt(organ, what, 1.0 / (max(factor, 1e-3) * MAX_GROWTH))
    count, next_count = (len(series.clouds[k]) for k in (index, index + 1))
    for segment in lost:
        strength = len(match.first.segments[segment]) / count / MAX_LOST_SHARE
        if strength > 1.0:
            what = "{name} vanishes, though it is large"
            yield IdentityDoubt(tracks.first[segment], what, strength)
    for segment in born:
        strength = len(match.second.segments[segment]) / next_count / MAX_BORN_SHARE
        if strength > 1.0:
            what = "{name} is new, though it is large"
            yield IdentityDoubt(tracks.second[segment], what, strength)


def second_best(
    scores: NDArray[np.float64],
    rows: Sequence[int],
    columns: Sequence[int],
    lost: Sequence[int],
    born: Sequence[int],
) -> tuple[list[float], list[int]]:
    """By how much each matched pair is better than the best other choice that changes it.

    Parameters
    ----------
    scores : (n, m) float64
        Of matching each organ of one scan to each of the next, 0 for a loss and a birth.
    rows, columns : sequence of int
        The P matched pairs.
    lost, born : sequence of int
        Rows and columns that are not matched.

    Returns
    -------
    margins : list of float
        Below 0 where the other choice is better in this interval alone.
    rivals : list of int
        The organ that this choice takes instead, one of the pairs, then the lost, then the born; -1
        where it leaves the pair unmatched.
    """
    if not rows:
        return [], []
    scores = np.maximum(scores, OUT_OF_THE_QUESTION)
    crossed = scores[np.ix_(rows, columns)]
    own = np.diagonal(crossed)
    # Two pairs exchange their partners; or one takes the other's, and what is left is unmatched.
    exchanged = np.maximum(np.maximum(crossed, crossed.T), crossed + crossed.T)
    margin = own[:, None] + own - exchanged
    np.fill_diagonal(margin, np.inf)
    came_from = own[:, None] - scores[np.ix_(lost, columns)].T
    became = own[:, None] - scores[np.ix_(rows, born)]
    choices = np.hstack([margin, came_from, became, own[:, None]])
    best = choices.argmin(axis=1)
    rivals = np.where(best == choices.shape[1] - 1, -1, best)
    return choices.min(axis=1).tolist(), rivals.tolist()


def _places(hierarchy: Hierarchy) -> dict[int, int]:
    """The place among a scan's descriptors of each segment that has points."""
    found = [segment for segment, own in enumerate(hierarchy.segments) if len(own)]
    return {segment: place for place, segment in enumerate(found)}
