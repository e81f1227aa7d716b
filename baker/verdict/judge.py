"""Judge which organs of a clip look wrong in which interval."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

from baker.geometry.parallel import MapLike
from baker.interpolation.organ_shapes import Attachments
from baker.verdict.doubt import Doubt, verdict_provenance
from baker.verdict.identity import FollowedOrgans, doubtful_identities
from baker.verdict.motion import doubtful_motions
from gclip import Clip, Track


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
    interval, names = clip.intervals[index], list(map(_name, clip.track_table))
    found = [(each, False) for each in doubtful_motions(interval, attachments)]
    if followed is not None:
        found += [(each, True) for each in doubtful_identities(followed, index)]
    doubts = []
    for (what, strength, organs), identity in found:
        clause = what.format(*(names[organ] for organ in sorted(organs)))
        doubts.append(Doubt(interval.start, interval.end, organs[0], clause, strength, identity))
    return doubts


def _name(organ: Track) -> str:
    """The name of an organ in a sentence, such as "the stem"."""
    if organ.kind != "stem":
        return organ.name
    return "the stem" if organ.name == "stem" else f"the stem ({organ.name})"
