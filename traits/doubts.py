"""The doubts about a clip in its provenance (docs/format.md, `provenance.verdict`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from gclip import Clip


@dataclass(frozen=True)
class Doubt:
    """One organ that looks wrong between two scans."""

    start: float  #: times of the scans
    end: float
    track: int
    what: str  #: a clause: "organ 3 tears"
    strength: float = 1.0  #: the measured value over the threshold above which it is doubtful
    identity: bool = False  #: whether the organ may be another one, rather than move wrongly

    def concerns(self, time: float) -> bool:
        """Whether the organ's traits at a time may be wrong.

        A doubt about its motion concerns the interval, one about its identity all later times.
        """
        return self.start < time and (self.identity or time < self.end)


@dataclass(frozen=True)
class _Verdict:
    """The part of `provenance.verdict` that is read."""

    doubts: tuple[Doubt, ...]


def doubts_of(clip: Clip) -> tuple[Doubt, ...]:
    """The doubts in a clip's provenance, sorted by time; empty if it has no valid verdict."""
    try:
        doubts = msgspec.convert(clip.provenance.get("verdict"), _Verdict).doubts
    except msgspec.ValidationError:
        return ()
    valid = (d for d in doubts if {d.start, d.end} <= {*clip.times} and d.start < d.end)
    return tuple(sorted(valid, key=lambda doubt: doubt.start))
