"""Which organs of a clip look wrong in which interval."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.verdict.doubt import MIN_SHARE, Doubt, provenance_of
from baker.verdict.identity import FollowedOrgans, doubtful_identities
from baker.verdict.motion import SampledMotion, sampled_motions
from gclip import Clip

# From these values on an organ's motion is doubtful (docs/method.md, "The verdict").
MIN_TORN, MAX_ORDER, MIN_SIZE_CHANGE = 0.05, 0.5, 0.2

Attachments = Mapping[int, NDArray[np.floating]]
"""By organ, the points (c, 3) by which it touches its parent."""


def judged(
    clip: Clip,
    attachments: Sequence[tuple[Attachments, Attachments]],
    followed: FollowedOrgans | None,
    map: MapLike = map,
) -> Clip:
    """Judge a clip without knowing the truth.

    Parameters
    ----------
    clip : gclip.Clip
    attachments : sequence of (Attachments, Attachments)
        Of each interval, in both of its scans.
    followed : FollowedOrgans, optional
        What the clip was made of, where labels don't name its organs.
    map : MapLike
        Over the intervals.

    Returns
    -------
    gclip.Clip
        With the verdict in its provenance: by interval, in each the organs' motion first.
    """
    judge = partial(_doubts_in, clip, followed)
    doubts = map(judge, range(len(clip.intervals)), attachments)
    verdict = provenance_of(clip, [doubt for own in doubts for doubt in own])
    return replace(clip, provenance={**clip.provenance, "verdict": verdict})


def _doubts_in(
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
            what, strength = max(_wrong(motion, contacts), key=lambda each: each[1])
            if strength >= 1.0:
                said = what.format(name=called(clip, track))
                doubts.append(Doubt(interval.start, interval.end, track, said, strength))
    if followed is not None:
        for track, what, strength, other in doubtful_identities(followed, index):
            names = sorted([track] if other is None else [track, other])
            name, *others = (called(clip, organ) for organ in names)
            said = what.format(name=name, other=others and others[0])
            doubts.append(Doubt(interval.start, interval.end, track, said, strength, identity=True))
    return doubts


def _wrong(
    motion: SampledMotion, contacts: Sequence[NDArray[np.floating]]
) -> Iterator[tuple[str, float]]:
    """What may be wrong with the motion of an organ called {name}, and how strongly each is."""
    yield "{name} tears", motion.torn / MIN_TORN
    change = motion.size_change
    changes = "swells" if change > 0 else "shrinks"
    yield f"{{name}} {changes} between the scans", abs(change) / MIN_SIZE_CHANGE
    if len(contacts) == 2:
        order = motion.order_kept(contacts)
        turned = "the tip and the base of {name} change places"
        what = turned if order < 0 else "parts of {name} change places"
        yield what, (1.0 - order) / (1.0 - MAX_ORDER)


def called(clip: Clip, track: int) -> str:
    """The name of an organ in a sentence."""
    named = clip.track_table[track]
    if named.kind != "stem":
        return named.name
    return "the stem" if named.name == "stem" else f"the stem ({named.name})"
