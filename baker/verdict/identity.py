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
from baker.matching.descriptors import OrganDescriptors, describe_organs
from baker.matching.score import match_scores
from baker.segmentation.hierarchy import Hierarchy

# From these values on it is doubtful which organ one is (docs/method.md, "The verdict").
MIN_MARGIN = 0.4  # of the score: what a turn by 75 degrees costs
MAX_GROWTH = 2.5  # of an organ's size, over that of the plant's organs; or one by that
MAX_LOST_SHARE = 0.05  # of a scan's points, in an organ that the next scan lacks
MAX_BORN_SHARE = 0.1  # likewise in a new organ


@dataclass(frozen=True)
class FollowedOrgans:
    """A series whose organs were not named by labels, but followed by their shape."""

    clouds: Sequence[NDArray[np.floating]]  # (N, 3), of each scan
    bases: Sequence[int]  # index of the point at each plant base
    matches: Sequence[Match]  # of each interval
    tracks: Sequence[IntervalOrgans]
    stem: bool  # whether the organ at the plant base is known to be the stem


class IdentityDoubt(NamedTuple):
    """One organ that may be another."""

    track: int
    #: What is said of its {name}, and of the {other} organ that it may be.
    what: str
    strength: float
    other: int | None = None


def doubtful_identities(series: FollowedOrgans, index: int) -> Iterator[IdentityDoubt]:
    """Judge the matches, births and losses of an interval."""
    match, tracks = series.matches[index], series.tracks[index]
    sides = zip((match.first, match.second), (index, index + 1), strict=True)
    first, second = (
        describe_organs(series.clouds[k], hierarchy, series.bases[k], stem=series.stem)
        for hierarchy, k in sides
    )
    row, column = _places(match.first), _places(match.second)
    pairs = [(a, b) for a, b in match.pairs if a in row and b in column and a != match.first.root]
    rows, columns = [row[a] for a, _ in pairs], [column[b] for _, b in pairs]
    lost, born = [s for s in match.losses if s in row], [s for s in match.births if s in column]
    organs = [tracks.first[a] for a, _ in pairs]
    others = [*organs, *(tracks.first[s] for s in lost), *(tracks.second[s] for s in born)]
    gone, new = [row[s] for s in lost], [column[s] for s in born]
    margins, rival = second_best(match_scores(first, second), rows, columns, gone, new)
    growth = _growth(first, rows, second, columns)
    for organ, margin, k, factor in zip(organs, margins, rival, growth, strict=True):
        if margin < MIN_MARGIN and k < 0:
            yield IdentityDoubt(organ, "{name} may be a new organ", 2.0 - margin / MIN_MARGIN)
        elif margin < MIN_MARGIN:
            what = "{name} and {other} may be mixed up"
            yield IdentityDoubt(organ, what, 2.0 - margin / MIN_MARGIN, others[k])
        if factor > MAX_GROWTH:
            what = "{name} is suddenly much larger and may be two organs"
            yield IdentityDoubt(organ, what, factor / MAX_GROWTH)
        if factor < 1.0 / MAX_GROWTH:
            what = "{name} is suddenly much smaller and may lack a part"
            yield IdentityDoubt(organ, what, 1.0 / (factor * MAX_GROWTH))
    for segment in lost:
        share = len(match.first.segments[segment]) / len(series.clouds[index])
        if share > MAX_LOST_SHARE:
            what = "{name} vanishes, though it is large"
            yield IdentityDoubt(tracks.first[segment], what, share / MAX_LOST_SHARE)
    for segment in born:
        share = len(match.second.segments[segment]) / len(series.clouds[index + 1])
        if share > MAX_BORN_SHARE:
            what = "{name} is new, though it is large"
            yield IdentityDoubt(tracks.second[segment], what, share / MAX_BORN_SHARE)


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
        Which organ that choice takes instead: of the pairs, then the lost, then the born; -1 where
        it leaves the pair unmatched.
    """
    if not rows:
        return [], []
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


def _growth(
    first: OrganDescriptors, rows: Sequence[int], second: OrganDescriptors, columns: Sequence[int]
) -> list[float]:
    """(P,) factors by which matched organs grow, over the factor by which all organs do."""
    all_organs = [float(np.sqrt((d.sizes**2).mean())) for d in (first, second)]
    tiny = np.finfo(float).tiny
    factors = second.sizes[list(columns)] / np.maximum(first.sizes[list(rows)], tiny)
    return (factors * all_organs[0] / max(all_organs[1], tiny)).tolist()
