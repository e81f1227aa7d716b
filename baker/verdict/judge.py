"""Which organs of a clip look wrong in which interval."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from baker.geometry.parallel import MapLike
from baker.verdict.doubt import Doubt, provenance_of
from baker.verdict.identity import FollowedOrgans, doubtful_identities
from baker.verdict.motion import SampledMotion, sampled_motions
from gclip import Clip

# From these values on an organ's motion is doubtful (docs/method.md, "The verdict").
MIN_TORN, MAX_ORDER, MIN_SIZE_CHANGE = 0.02, 0.85, 0.2


def judged(clip: Clip, followed: FollowedOrgans | None, map: MapLike = map) -> Clip:
    """The clip with its verdict in the provenance; see `find_doubts`."""
    verdict = provenance_of(clip, find_doubts(clip, followed, map))
    return replace(clip, provenance={**clip.provenance, "verdict": verdict})


def find_doubts(
    clip: Clip, followed: FollowedOrgans | None = None, map: MapLike = map
) -> list[Doubt]:
    """Judge a clip without knowing the truth.

    Parameters
    ----------
    clip : gclip.Clip
    followed : FollowedOrgans, optional
        What the clip was made of, where labels don't name its organs.
    map : MapLike
        Over the intervals.

    Returns
    -------
    list of Doubt
        By interval, in each the organs' motion first.
    """
    found = map(partial(_doubts_in, clip, followed), range(len(clip.intervals)))
    return [doubt for own in found for doubt in own]


def _doubts_in(clip: Clip, followed: FollowedOrgans | None, index: int) -> list[Doubt]:
    interval = clip.intervals[index]
    matched = {pair.track for pair in interval.segments if pair.event == "match"}
    motions = sampled_motions(interval)
    doubts = []
    for track, motion in motions.items():
        if track in matched and motion.is_measurable:
            parent = clip.track_table[track].parent
            found = _wrong(motion, motions.get(parent) if parent is not None else None)
            what, strength = max(found, key=lambda each: each[1])
            if strength >= 1.0:
                said = what.format(name=called(clip, track))
                doubts.append(Doubt(interval.start, interval.end, track, said, strength))
    if followed is not None:
        for track, what, strength, other in doubtful_identities(followed, index):
            names = sorted({track, track if other is None else other})
            name, *others = (called(clip, organ) for organ in names)
            said = what.format(name=name, other="".join(others))
            doubts.append(Doubt(interval.start, interval.end, track, said, strength, identity=True))
    return doubts


def _wrong(motion: SampledMotion, parent: SampledMotion | None) -> Iterator[tuple[str, float]]:
    """What may be wrong with the motion of an organ called {name}, and how strongly each is."""
    yield "{name} tears", motion.torn / MIN_TORN
    change = motion.size_change
    what = "{name} swells on the way" if change > 0 else "{name} shrinks on the way"
    yield what, abs(change) / MIN_SIZE_CHANGE
    if parent is not None:
        order = motion.order_kept(parent)
        turned = "the tip and the base of {name} change places"
        what = turned if order < 0 else "parts of {name} change places"
        yield what, (1.0 - order) / (1.0 - MAX_ORDER)


def called(clip: Clip, track: int) -> str:
    """The name of an organ in a sentence."""
    named = clip.track_table[track]
    return f"the stem ({named.name})" if named.kind == "root" else named.name
