"""What a bake did besides the clip: all that a report or a verification needs to know."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from baker.transport.tasks import MIN_ATTACHMENT_POINTS

if TYPE_CHECKING:
    from baker.alignment import Alignment
    from baker.interpolation.movers import Keyframe
    from baker.matching import IntervalOrgans, Match
    from baker.scans import Scan, Series
    from baker.segmentation.hierarchy import Hierarchy


@dataclass(frozen=True)
class HeldOut:
    """A scan that was read and aligned with the others, then left out of the bake."""

    scan: Scan
    keyframe: Keyframe


@dataclass(frozen=True)
class BakeRecord:
    """The stages' results, in the order of the clip's scans and intervals.

    found:       all scans as read, those left out too.
    series:      the scans that were baked; `keyframes` the same, aligned.
    alignment:   of all scans found.
    labels:      how the labels were used, one sentence.
    hierarchies: of each scan as it was segmented, before matching merged any segments.
    matches:     of each interval, with the reasons in their notes.
    organs:      which organ (track) each segment of an interval's match is.
    held_out:    scans left out for verification.
    bud:         how many points organs unfold from, if that was asked for, and how many at least.
    """

    found: Series
    series: Series
    keyframes: tuple[Keyframe, ...]
    alignment: Alignment
    labels: str
    hierarchies: tuple[Hierarchy, ...]
    matches: tuple[Match, ...]
    organs: tuple[IntervalOrgans, ...]
    held_out: tuple[HeldOut, ...] = ()
    bud: tuple[int | None, int] = (None, MIN_ATTACHMENT_POINTS)


def left_out(scans: int, every: int | None) -> tuple[int, ...]:
    """Which of a series' scans `--holdout N` leaves out, by number from 0.

    Counted from one, the scans N, 2 N, 3 N, ...: with 2 every second one, as the paper does
    (section 4, Verification). The first and the last scan always stay: nothing is rebuilt outside
    the series.
    """
    return () if every is None else tuple(range(every - 1, scans - 1, every))
