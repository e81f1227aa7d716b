"""Find organs, tracked by their shape, that may have been matched with the wrong organ."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.matching import Match
from baker.matching.descriptors import OrganDescriptors, describe_organs
from baker.matching.score import best_pairs, match_scores
from baker.segmentation.hierarchy import Hierarchy
from baker.verdict.doubt import MIN_SHARE

# Beyond these thresholds an organ's identity is doubtful (docs/method.md, "The verdict").
MIN_MARGIN = 0.1  # of a pair's score to the next best pairing; a turn by 20 degrees costs as much
MAX_GROWTH, MAX_SHRINKAGE = 6.0, 3.0  # of an organ's size relative to the plant's other organs
MAX_BORN_SHARE = 0.2  # of a scan's points that are in one new organ
MIN_SIZE = 1e-100  # of an organ, so that its square is not 0


@dataclass(frozen=True)
class FollowedOrgans:
    """A series whose organs were tracked by their shape."""

    clouds: Sequence[NDArray[np.floating]]  # (N, 3), of each scan
    bases: Sequence[int]  # index of the point at the plant base, of each scan
    matches: Sequence[Match]  # of each interval
    stem: bool  # whether the organ at the plant base is known to be the stem
    confirmed: Collection[tuple[int, int | None]] = ()  # (interval, label) that users corrected


@dataclass(frozen=True)
class _Organs:
    """The organs of a scan: segments of its hierarchy, some of which may have no points."""

    segments: NDArray[np.intp]  # indices of the segments that have points
    descriptors: OrganDescriptors  # of these segments
    share: NDArray[np.float64]  # of the scan's points, of each segment
    size: NDArray[np.float64]  # of each segment, relative to the root mean square of all


def doubtful_identities(
    series: FollowedOrgans, index: int
) -> Iterator[tuple[str, float, list[int]]]:
    """Yield doubts about the matches, births and losses of the interval `index`.

    Each is a clause with {} for the names of organs, a strength, and the ids of these organs, of
    which the first may be another one.
    """
    match = series.matches[index]
    tracks, end_tracks = match.first.organs, match.second.organs
    first, second = _organs(series, index, match.first), _organs(series, index + 1, match.second)
    starts, ends = first.segments.tolist(), second.segments.tolist()
    known = [(starts.index(a), ends.index(b)) for a, b in match.pairs if a in starts and b in ends]
    scores = np.zeros((len(first.share), len(second.share)))
    scores[np.ix_(starts, ends)] = match_scores(first.descriptors, second.descriptors, known)
    for pair in match.pairs:
        scores[pair] -= MIN_MARGIN
    # As the interval would be matched without the rest of the series.
    successor = dict(best_pairs(scores)[0].tolist())
    predecessor = {b: a for a, b in successor.items()}
    for a, b in match.pairs:
        shares = first.share[a], second.share[b]
        if (index, match.first.labels[a]) in series.confirmed:
            continue
        if a == match.first.root or min(shares) == 0.0 or max(shares) < MIN_SHARE:
            continue
        organ, growth = tracks[a], float(second.size[b] / first.size[a])
        if successor.get(a) != b and (a in successor or b in predecessor):
            rival = tracks[predecessor[b]] if b in predecessor else end_tracks[successor[a]]
            yield "{} and {} may be mixed up", 1.0, [organ, rival]
        if growth > MAX_GROWTH:
            what = "{} may be two organs (suddenly much larger)"
            yield what, growth / MAX_GROWTH, [organ]
        if growth * MAX_SHRINKAGE < 1.0:
            what = "{} may lack a part (suddenly much smaller)"
            yield what, 1.0 / (max(growth, 1e-3) * MAX_SHRINKAGE), [organ]
    for a in match.losses:
        if (strength := float(first.share[a]) / MIN_SHARE) >= 1.0:
            yield "{} is large but vanishes", strength, [tracks[a]]
    for b in match.births:
        if (strength := float(second.share[b]) / MAX_BORN_SHARE) >= 1.0:
            yield "{} is large but new", strength, [end_tracks[b]]


def _organs(series: FollowedOrgans, scan: int, hierarchy: Hierarchy) -> _Organs:
    cloud, base = series.clouds[scan], series.bases[scan]
    descriptors = describe_organs(cloud, hierarchy, base, stem=series.stem)
    counts = np.array(list(map(len, hierarchy.segments)))
    size = np.zeros(len(counts))
    size[counts > 0] = np.maximum(descriptors.sizes, MIN_SIZE)
    size /= np.sqrt((size[counts > 0] ** 2).mean())
    return _Organs(np.flatnonzero(counts), descriptors, counts / len(cloud), size)
