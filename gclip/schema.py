"""What a clip's document may say (docs/format.md, "The document"), as types that msgspec checks.

What types can't express, such as fields that contradict each other, `__post_init__` checks: its
ValueError becomes msgspec's, which names the place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from typing import Annotated, Any, Literal, get_args

import numpy as np
from msgspec import Meta, Struct
from numpy.typing import NDArray

MAX_NUMBER = 1e18  # its square is still a float32, which is what a GPU calculates with
MIN_DURATION = 1e-9  # of an interval
MAX_DEPTH = 32  # objects and lists within each other in `provenance`

Text = Annotated[str, Meta(max_length=1000)]
Number = Annotated[float, Meta(ge=-MAX_NUMBER, le=MAX_NUMBER)]
Count = Annotated[int, Meta(ge=0, lt=2**48)]
Channel = Annotated[int, Meta(ge=0, le=255)]
Digest = Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]
Event = Annotated[str, Meta(pattern="^(match|birth|loss)$")]
Vector = tuple[Number, Number, Number]
UpAxis = Literal["x", "y", "z", "-x", "-y", "-z"]
TimeUnit = Literal["days", "scans"]
Degree = Literal[1, 2, 3]
UP_AXES: tuple[str, ...] = get_args(UpAxis)


class Motion(StrEnum):
    """How a group of movers goes through its interval (paper section 3.3, growth and decay)."""

    MOVE = "move"  # from its start to its end
    FALL = "fall"  # lost: falls to the floor with gravity's ease; its litter then fades
    FADE = "fade"  # lost: stays and fades
    REMOVE = "remove"  # lost: gone as soon as the interval begins


@dataclass(frozen=True)
class ScanMark:
    """One scan of the series."""

    name: Text  #: of its file
    time: Number  #: in the clip's unit of time
    date: Text = ""  #: the time as people write it
    points: Count = 0


@dataclass(frozen=True)
class Group:
    """A run of movers, `first` to `first + count`, that share a motion."""

    first: Count
    count: Count
    motion: Motion

    @property
    def stop(self) -> int:
        return self.first + self.count


@dataclass(frozen=True)
class SegmentPair:
    """How one segment's transport was solved, kept for the report."""

    track: Count
    event: Event
    start_points: Count
    end_points: Count
    movers: Count
    solver: Text = ""
    cost: Number = 0.0  #: root mean square (or mean) distance travelled, in the clip's length unit
    marginal_error: Number = 0.0  #: L1 distance of the plan's marginals from the uniform ones
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Box:
    """Dequantisation of an interval: position = low + (high - low) * quantised / 65535."""

    low: Vector
    high: Vector

    def __post_init__(self) -> None:
        if any(low > high for low, high in zip(self.low, self.high, strict=True)):
            raise ValueError("its low corner lies above its high corner")

    @property
    def step(self) -> NDArray[np.float64]:
        """(3,) the length of one quantisation step along each axis."""
        return (np.asarray(self.high, float) - np.asarray(self.low, float)) / 65535.0


class TrackEntry(Struct, frozen=True):
    """One organ from birth to loss; its id is its place in the list."""

    name: Text
    color: tuple[Channel, Channel, Channel]
    parent: Count | None = None
    born: Number = 0.0
    lost: Number | None = None
    kind: Text = "organ"


class IntervalEntry(Struct, frozen=True):
    """What the document says of an interval before its buffers are looked at."""

    start: Number
    end: Number
    degree: Degree
    groups: tuple[Group, ...]
    box: Box | None = None
    segments: tuple[SegmentPair, ...] = ()

    def __post_init__(self) -> None:
        if self.end - self.start < MIN_DURATION:
            raise ValueError(
                f"it lasts from {self.start:g} to {self.end:g}; it must end {MIN_DURATION:g} or "
                "more after its start"
            )
        stops = [0, *(group.stop for group in self.groups)]
        if [group.first for group in self.groups] != stops[:-1]:
            raise ValueError("its groups do not cover the movers one after the other")
        if stops[-1] == 0:
            raise ValueError("it holds no movers; at least one is needed")


class Document(Struct, frozen=True):
    """All that a clip says but its buffers."""

    version: Text
    up: UpAxis
    scans: Annotated[tuple[ScanMark, ...], Meta(min_length=2)]
    tracks: Annotated[tuple[TrackEntry, ...], Meta(min_length=1)]
    intervals: tuple[IntervalEntry, ...]
    unit: Text = ""
    time_unit: TimeUnit = "days"
    origin: Vector = (0.0, 0.0, 0.0)
    floor: Number = 0.0
    spacing: Annotated[float, Meta(ge=0, le=MAX_NUMBER)] = 0.0
    held_out: tuple[ScanMark, ...] = ()
    sha256: dict[str, Digest] = {}
    provenance: dict[str, Any] = {}

    def __post_init__(self) -> None:
        _check_times(self.scans, self.intervals, self.held_out)
        for index, track in enumerate(self.tracks):
            if track.parent is not None and not index != track.parent < len(self.tracks):
                raise ValueError(
                    f"tracks[{index}].parent is {track.parent}; "
                    f"another track's id below {len(self.tracks)} is needed"
                )
        used = [pair.track for interval in self.intervals for pair in interval.segments]
        if max(used, default=0) >= len(self.tracks):
            raise ValueError(
                f"a segment's track is {max(used)}; only {len(self.tracks)} tracks are named"
            )
        if _depth(self.provenance) > MAX_DEPTH:
            raise ValueError(f"provenance is nested more than {MAX_DEPTH} levels deep")


def _check_times(
    scans: Sequence[ScanMark], intervals: Sequence[IntervalEntry], held_out: Sequence[ScanMark]
) -> None:
    times = [scan.time for scan in scans]
    starts = [interval.start for interval in intervals]
    ends = [interval.end for interval in intervals]
    out = [scan.time for scan in held_out]
    for name, ascending in (("scans", times), ("held_out", out)):
        if any(a >= b for a, b in pairwise(ascending)):
            raise ValueError(f"the times of {name} do not ascend")
    if not intervals or starts[0] != times[0] or ends[-1] != times[-1]:
        raise ValueError("the intervals do not span the scans' times")
    if starts[1:] != ends[:-1]:
        raise ValueError("the intervals do not follow one another without a gap")
    if not {*times} <= {*starts, ends[-1]}:
        raise ValueError("a scan's time lies inside an interval")
    if out and not times[0] <= out[0] <= out[-1] <= times[-1]:
        raise ValueError("a time in held_out lies outside the series")


def _depth(value: Any) -> int:
    """How many objects and lists hold one another; 0 for other values."""
    inner = value.values() if isinstance(value, dict) else value
    return 1 + max(map(_depth, inner), default=0) if isinstance(value, dict | list) else 0
