"""Find organs, tracked by their shape, that may have been matched with the wrong organ."""

from collections.abc import Collection, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.interval_job import IntervalJob
from baker.matching.descriptors import OrganDescriptors, describe_organs
from baker.matching.plant_motion import ANGLE_PENALTY, candidate_motions, rotation_angles
from baker.matching.score import best_pairs, match_scores
from baker.segmentation.hierarchy import Hierarchy
from baker.verdict.doubt import MIN_SHARE
from traits.doubts import Doubt

# Beyond these thresholds an organ's identity is doubtful (docs/method.md, "The verdict").
# Of the total score over that without a pair; a turn by 40 degrees costs 0.2. With labels, another
# pairing has to be better, as it is in 3 of 157 real intervals, and if two labels are exchanged.
MIN_MARGIN, MIN_MARGIN_OF_LABELS = 0.2, -0.5
MAX_SAMPLE = 10_000  # number of points of a scan by which its organs are described
MAX_GROWTH, MAX_SHRINKAGE = 4.0, 3.0  # of an organ's size relative to the plant's other organs
MIN_SIZE = 1e-3  # relative size, so that growth is finite


def doubtful_identities(
    job: IntervalJob, names: Sequence[str], confirmed: Collection[int | None], by_label: bool
) -> Iterator[Doubt]:
    """Yield doubts about the matches and losses of large organs in an interval.

    names: of the organs, by track id. confirmed: labels in the first scan of the organs that are
    not in doubt. by_label: whether labels identify organs; then only exchanged ones are doubted.
    """
    first, second = job.match.first, job.match.second
    organs, share, size = _describe(first, job.start.positions, job.bases[0])
    end_organs, end_share, end_size = _describe(second, job.end.positions, job.bases[1])
    certain = {first.root, *(a for a, label in enumerate(first.labels) if label in confirmed)}
    judged = [
        (a, b)
        for a, b in job.match.pairs
        if min(size[a], end_size[b]) > 0.0 and max(share[a], end_share[b]) >= MIN_SHARE
        if a not in certain
    ]
    tracks = np.array(first.organs)[size > 0.0], np.array(second.organs)[end_size > 0.0]
    compared = organs, end_organs, *tracks, [first.organs[a] for a, _ in judged]
    # Labels are rarely wrong: rotations are only searched for if some match badly without one.
    rivals = _rivals(*compared, MIN_MARGIN_OF_LABELS, np.eye(4)[None]) if by_label else {}
    if rivals or not by_label:
        motions, _ = candidate_motions(organs.largest(), end_organs.largest())
        rivals = _rivals(*compared, MIN_MARGIN_OF_LABELS if by_label else MIN_MARGIN, motions)
    for a, b in judged:
        organ, growth = first.organs[a], float(end_size[b] / size[a])
        if organ in rivals:
            names_of_two = " and ".join(names[track] for track in sorted((organ, rivals[organ])))
            yield Doubt(*job.times, organ, f"{names_of_two} may be mixed up", 1.0, identity=True)
        if by_label:
            continue
        what, strength = "may be two organs (suddenly much larger)", growth / MAX_GROWTH
        if growth < 1.0:
            what, strength = "may lack a part (suddenly much smaller)", 1 / (growth * MAX_SHRINKAGE)
        if strength > 1.0:
            yield Doubt(*job.times, organ, f"{names[organ]} {what}", strength, identity=True)
    for a in () if by_label else job.match.losses:
        organ, strength = first.organs[a], float(share[a]) / MIN_SHARE
        if strength >= 1.0:
            what = f"{names[organ]} is large but vanishes"
            yield Doubt(*job.times, organ, what, strength, identity=True)


def _rivals(
    first: OrganDescriptors,
    second: OrganDescriptors,
    tracks: NDArray[np.integer],
    end_tracks: NDArray[np.integer],
    judged: Sequence[int],
    margin: float,
    motions: NDArray[np.float64],
) -> dict[int, int]:
    """The organ with which each organ may be mixed up, if there is one, by track id.

    Two organs may be mixed up if the interval by itself can be matched otherwise for a total score
    that is lower by less than the margin, with the plant moved as a whole.

    tracks, end_tracks: (n,) and (m,) track ids of the organs. judged: those that are compared.
    motions: (k, 4, 4) possible motions of the plant.
    """
    matched = np.intersect1d(tracks, end_tracks, return_indices=True)
    penalties = min(len(first), len(second)) * ANGLE_PENALTY * rotation_angles(motions)
    first, second, pairs = first.about_stem(), second.about_stem(), np.column_stack(matched[1:])
    scores = [match_scores(first.transformed(motion), second, pairs) for motion in motions]
    gains = np.maximum(scores, 0.0)
    least = (gains[:, *matched[1:]].sum(axis=1) - penalties).max() - margin
    rivals = dict[int, int]()
    for track, row, column in np.column_stack(matched)[np.isin(matched[0], judged)].tolist():
        gains_without = gains.copy()
        gains_without[:, row, column] = 0.0
        for gain, penalty in zip(gains_without, penalties, strict=True):
            others, total = best_pairs(gain)
            starts, ends = others.T
            found = [*tracks[starts[ends == column]], *end_tracks[ends[starts == row]]]
            if found and total - penalty > least:
                rivals.setdefault(track, found[0])
    return rivals


def _describe(
    hierarchy: Hierarchy, cloud: NDArray[np.floating], base: NDArray[np.floating]
) -> tuple[OrganDescriptors, NDArray[np.float64], NDArray[np.float64]]:
    """Describe the organs of a scan, the segments that have points in a sample of the scan.

    Also return each segment's share, and its size relative to their root mean square, or 0.
    """
    share = np.array(list(map(len, hierarchy.segments))) / len(cloud)
    step = -(-len(cloud) // MAX_SAMPLE)
    sample, numbers = cloud[::step], hierarchy.numbers()[::step]
    root_point = int(((sample - base) ** 2).sum(axis=1).argmin())
    organs = describe_organs(sample, numbers, root_point)
    size, mean = np.zeros(len(share)), float(np.sqrt((organs.sizes**2).mean()))
    size[np.unique(numbers)] = np.maximum(organs.sizes / (mean or 1.0), MIN_SIZE)
    return organs, share, size
