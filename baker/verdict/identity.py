"""Find organs, tracked by their shape, that may have been matched with the wrong organ."""

from collections.abc import Collection, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.interval_job import IntervalJob
from baker.matching.descriptors import OrganDescriptors, describe_organs
from baker.matching.score import best_pairs, match_scores
from baker.segmentation.hierarchy import Hierarchy
from baker.verdict.doubt import MIN_SHARE
from traits.doubts import Doubt

# Beyond these thresholds an organ's identity is doubtful (docs/method.md, "The verdict").
MIN_MARGIN = 0.1  # of a pair's score over that of another pairing; a turn by 20 degrees costs it
MAX_GROWTH, MAX_SHRINKAGE = 6.0, 3.0  # of an organ's size relative to the plant's other organs
MIN_SIZE = 1e-3  # relative size, so that growth is finite


def doubtful_identities(
    job: IntervalJob, names: Sequence[str], confirmed: Collection[int | None]
) -> Iterator[Doubt]:
    """Yield doubts about the matches and losses of large organs in an interval.

    names: of the organs, by track id. confirmed: labels in the first scan of the organs that are
    not in doubt.
    """
    first, second = job.match.first, job.match.second
    organs, share, size = _describe(first, job.start.positions, job.bases[0])
    end_organs, end_share, end_size = _describe(second, job.end.positions, job.bases[1])
    starts, ends = np.flatnonzero(share).tolist(), np.flatnonzero(end_share).tolist()
    pairs = [(a, b) for a, b in job.match.pairs if a in starts and b in ends]
    matched = [(starts.index(a), ends.index(b)) for a, b in pairs]
    scores = np.zeros((len(first.segments), len(second.segments)))
    scores[np.ix_(starts, ends)] = match_scores(organs, end_organs, matched)
    for pair in pairs:
        scores[pair] -= MIN_MARGIN
    # How the interval would be matched without the rest of the series.
    successor = dict(best_pairs(scores)[0].tolist())
    predecessor = {b: a for a, b in successor.items()}
    for a, b in pairs:
        if max(share[a], end_share[b]) < MIN_SHARE:
            continue
        if a == first.root or first.labels[a] in confirmed:
            continue
        organ, growth = first.organs[a], float(end_size[b] / size[a])
        if successor.get(a) != b and (a in successor or b in predecessor):
            is_taken = b in predecessor
            rival = first.organs[predecessor[b]] if is_taken else second.organs[successor[a]]
            names_of_two = " and ".join(names[track] for track in sorted((organ, rival)))
            yield Doubt(*job.times, organ, f"{names_of_two} may be mixed up", 1.0, identity=True)
        what, strength = "may be two organs (suddenly much larger)", growth / MAX_GROWTH
        if growth < 1.0:
            what, strength = "may lack a part (suddenly much smaller)", 1 / (growth * MAX_SHRINKAGE)
        if strength > 1.0:
            yield Doubt(*job.times, organ, f"{names[organ]} {what}", strength, identity=True)
    for a in job.match.losses:
        organ, strength = first.organs[a], float(share[a]) / MIN_SHARE
        if strength >= 1.0:
            what = f"{names[organ]} is large but vanishes"
            yield Doubt(*job.times, organ, what, strength, identity=True)


def _describe(
    hierarchy: Hierarchy, cloud: NDArray[np.floating], base: NDArray[np.floating]
) -> tuple[OrganDescriptors, NDArray[np.float64], NDArray[np.float64]]:
    """Describe the organs of a scan, the segments that have points.

    Also return each segment's share of the scan's points, and its size relative to the root mean
    square of all sizes; both are 0 for segments without points.
    """
    root_point = int(((cloud - base) ** 2).sum(axis=1).argmin())
    organs = describe_organs(cloud, hierarchy.numbers(), root_point).about_stem()
    share = np.array(list(map(len, hierarchy.segments))) / len(cloud)
    size, mean = np.zeros(len(share)), float(np.sqrt((organs.sizes**2).mean()))
    size[share > 0] = np.maximum(organs.sizes / (mean or 1.0), MIN_SIZE)
    return organs, share, size
