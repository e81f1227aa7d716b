"""Judge which organs of a clip look wrong in which interval."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from itertools import chain

from baker.geometry.parallel import MapLike
from baker.interpolation.interval_job import IntervalJob
from baker.matching.labels import LabelUse
from baker.verdict.doubt import verdict_provenance
from baker.verdict.identity import doubtful_identities
from baker.verdict.motion import doubtful_motions
from gclip import Clip
from traits.doubts import Doubt


def judge_clip(
    clip: Clip,
    jobs: Sequence[IntervalJob],
    labels: LabelUse,
    confirmed: Collection[tuple[int, int]],
    map: MapLike = map,
) -> Clip:
    """Add the verdict to the provenance of a clip, judged without knowing the true growth.

    jobs: of each interval. labels: whether they identify organs.
    confirmed: (index of the interval, label) of the organs that corrections confirm to be the same.
    map: maps over the intervals.
    """
    names = ["the stem" if organ.kind == "stem" else organ.name for organ in clip.track_table]

    parents = [organ.parent for organ in clip.track_table]

    def doubts_in(index: int, job: IntervalJob) -> list[Doubt]:
        motions = doubtful_motions(clip.intervals[index], job.attachments, names, parents)
        confirmed_labels = {label for interval, label in confirmed if interval == index}
        return [*motions, *doubtful_identities(job, names, confirmed_labels, labels.are_names)]

    doubts = [*chain.from_iterable(map(doubts_in, range(len(jobs)), jobs))]
    return replace(
        clip, provenance={**clip.provenance, "verdict": verdict_provenance(clip, doubts)}
    )
