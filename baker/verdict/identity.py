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
MIN_SIZE = 1e-100  # of an organ, so that its square is not 0


@dataclass(frozen=True)
class FollowedOrgans:
    """A series whose organs were tracked by their shape."""

    clouds: Sequence[NDArray[np.floating]]  # (N, 3), of each scan
    bases: Sequence[int]  # index of the point at the plant base, of each scan
    matches: Sequence[Match]  # of each interval
    stem: bool  # whether the organ at the plant base is known to be the stem
    confirmed: Collection[tuple[int, int | None]] = ()  # (interval, label) that users corrected

    def describe(
        self, scan: int, hierarchy: Hierarchy
    ) -> tuple[OrganDescriptors, NDArray[np.float64], NDArray[np.float64]]:
        """Describe the organs of a scan that have points.

        Also return the share of the scan's points that each organ has, and its size relative to
        the root mean square of all; both are 0 for organs without points.
        """
        cloud = self.clouds[scan]
        descriptors = describe_organs(cloud, hierarchy, self.bases[scan], stem=self.stem)
        share = np.array(list(map(len, hierarchy.segments))) / len(cloud)
        size = np.zeros(len(share))
        size[share > 0] = np.maximum(descriptors.sizes, MIN_SIZE)
        return descriptors, share, size / np.sqrt((size[share > 0] ** 2).mean())


def doubtful_identities(
    series: FollowedOrgans, index: int
) -> Iterator[tuple[str, float, list[int]]]:
    """Yield doubts about the matches and losses of the interval `index`.

    Each is a clause with {} for the names of organs, a strength, and the ids of these organs, of
    which the first may be another one.
    """
    match = series.matches[index]
    tracks, end_tracks = match.first.organs, match.second.organs
    first, share, size = series.describe(index, match.first)
    second, end_share, end_size = series.describe(index + 1, match.second)
    starts, ends = np.flatnonzero(share).tolist(), np.flatnonzero(end_share).tolist()
    known = [(starts.index(a), ends.index(b)) for a, b in match.pairs if a in starts and b in ends]
    scores = np.zeros((len(share), len(end_share)))
    scores[np.ix_(starts, ends)] = match_scores(first, second, known)
    for pair in match.pairs:
        scores[pair] -= MIN_MARGIN
    # As the interval would be matched without the rest of the series.
    successor = dict(best_pairs(scores)[0].tolist())
    predecessor = {b: a for a, b in successor.items()}
    for a, b in match.pairs:
        if (index, match.first.labels[a]) in series.confirmed:
            continue
        shares = share[a], end_share[b]
        if a == match.first.root or min(shares) == 0.0 or max(shares) < MIN_SHARE:
            continue
        organ, growth = tracks[a], float(end_size[b] / size[a])
        if successor.get(a) != b and (a in successor or b in predecessor):
            rival = tracks[predecessor[b]] if b in predecessor else end_tracks[successor[a]]
            yield "{} and {} may be mixed up", 1.0, [organ, rival]
        if growth > MAX_GROWTH:
            yield "{} may be two organs (suddenly much larger)", growth / MAX_GROWTH, [organ]
        if growth * MAX_SHRINKAGE < 1.0:
            strength = 1.0 / (max(growth, 1e-3) * MAX_SHRINKAGE)
            yield "{} may lack a part (suddenly much smaller)", strength, [organ]
    for a in match.losses:
        if (strength := float(share[a]) / MIN_SHARE) >= 1.0:
            yield "{} is large but vanishes", strength, [tracks[a]]
