"""What the bake of a clip doubts (docs/format.md, `provenance.verdict`)."""

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
    what: str  #: "organ 3 tears"
    identity: bool  #: whether it may be another organ than before

    def concerns(self, time: float) -> bool:
        """Whether what the organ measures at a time may be wrong.

        Its motion matters between the two scans; which organ it is, from the first scan on.
        """
        return self.start < time and (self.identity or time < self.end)


@dataclass(frozen=True)
class _Verdict:
    doubts: tuple[Doubt, ...]


def doubts_of(clip: Clip) -> tuple[Doubt, ...]:
    """The doubts in a clip's provenance, by time; none where it has no verdict that we can read."""
    try:
        doubts = msgspec.convert(clip.provenance.get("verdict"), _Verdict).doubts
    except msgspec.ValidationError:
        return ()
    known = (d for d in doubts if {d.start, d.end} <= {*clip.times} and d.start < d.end)
    return tuple(sorted(known, key=lambda doubt: doubt.start))
