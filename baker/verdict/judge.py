"""Judge which organs of a clip look wrong in which interval."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.interpolation.organ_shapes import Attachments
from baker.verdict.doubt import MIN_SHARE, Doubt, verdict_provenance
from baker.verdict.identity import FollowedOrgans, doubtful_identities
from baker.verdict.motion import SampledMotion, sampled_motions
from gclip import Clip

# Beyond these thresholds the motion of an organ is doubtful (docs/method.md, "The verdict").
MAX_TORN_SHARE, MIN_ORDER_CORRELATION, MAX_SIZE_CHANGE = 0.05, 0.5, 0.2


def judge_clip(
    clip: Clip,
    attachments: Sequence[tuple[Attachments, Attachments]],
    followed: FollowedOrgans | None,
    map: MapLike = map,
) -> Clip:
    """Add the verdict to the provenance of a clip, judged without knowing the true growth.

    Parameters
    ----------
    clip : Clip
    attachments : sequence of tuple
        For each interval, those in its first and in its second scan.
    followed : FollowedOrgans or None
        The organs, where they were tracked by their shape and not by labels.
    map : map-like callable
        Maps over the intervals.
    """
    judge = partial(_interval_doubts, clip, followed)
    doubts = chain.from_iterable(map(judge, range(len(clip.intervals)), attachments))
    verdict = verdict_provenance(clip, list(doubts))
    return replace(clip, provenance={**clip.provenance, "verdict": verdict})


def _interval_doubts(
    clip: Clip,
    followed: FollowedOrgans | None,
    index: int,
    attachments: tuple[Attachments, Attachments],
) -> list[Doubt]:
    interval = clip.intervals[index]
    matched = {pair.track for pair in interval.segments if pair.event == "match"}
    doubts = []
    for track, motion in sampled_motions(interval).items():
        if track in matched and motion.share >= MIN_SHARE and motion.is_measurable:
            contacts = [side[track] for side in attachments if track in side]
            what, strength = max(_motion_faults(motion, contacts), key=lambda fault: fault[1])
            if strength >= 1.0:
                clause = what.format(organ_name(clip, track))
                doubts.append(Doubt(interval.start, interval.end, track, clause, strength))
    if followed is not None:
        for what, strength, organs in doubtful_identities(followed, index):
            clause = what.format(*(organ_name(clip, organ) for organ in sorted(organs)))
            doubt = Doubt(interval.start, interval.end, organs[0], clause, strength, identity=True)
            doubts.append(doubt)
    return doubts


def _motion_faults(
    motion: SampledMotion, contacts: Sequence[NDArray[np.floating]]
) -> Iterator[tuple[str, float]]:
    """Yield possible faults of the motion: a clause with {} for the organ, and the strength."""
    yield "{} tears", motion.torn_share / MAX_TORN_SHARE
    verb = "swells" if motion.size_change > 0 else "shrinks"
    yield f"{{}} {verb} between the scans", abs(motion.size_change) / MAX_SIZE_CHANGE
    if len(contacts) == 2:
        order = motion.order_correlation(contacts)
        parts = "the tip and the base" if order < 0 else "parts"
        yield f"{parts} of {{}} change places", (1.0 - order) / (1.0 - MIN_ORDER_CORRELATION)


def organ_name(clip: Clip, track: int) -> str:
    """The name of an organ in a sentence, such as "the stem"."""
    organ = clip.track_table[track]
    if organ.kind != "stem":
        return organ.name
    return "the stem" if organ.name == "stem" else f"the stem ({organ.name})"
