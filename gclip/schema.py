"""The parts of a clip's document (docs/format.md, "The document"), as types for msgspec.

Rules that types can't express, such as attributes that contradict each other, are checked in
`__post_init__`; msgspec adds the location to the ValueError.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

MAX_NUMBER = 1e18  # its square is finite in float32, the precision of a GPU
MIN_DURATION = 1e-9  # of an interval

CURVES = {
    1: ("start", "end"),
    2: ("start", "control1", "end"),
    3: ("start", "control1", "control2", "end"),
}
"""Degree of curves -> names of the buffers of their points in a file."""
OPTIONAL = {"start_colors": "start_color", "end_colors": "end_color", "normals": "normals"}
"""Optional attributes of an interval, (N, 4) uint8 -> names of their buffers."""
FIELD = "field%d"  # name of a buffer, by the index of the field
BLOCK = 128  # movers that stay together when the blocks of a group are shuffled

Text = Annotated[str, Meta(max_length=1000)]
Number = Annotated[float, Meta(ge=-MAX_NUMBER, le=MAX_NUMBER)]
Count = Annotated[int, Meta(ge=0, lt=2**48)]
Channel = Annotated[int, Meta(ge=0, le=255)]
Event = Annotated[str, Meta(pattern="^(match|birth|loss)$")]
Vector = tuple[Number, Number, Number]


class Motion(StrEnum):
    """How a group of movers moves in its interval (section 3.3 of the paper, growth and decay)."""

    MOVE = "move"  # from its start to its end
    FALL = "fall"  # a lost organ falls to the floor with constant acceleration, then fades
    FADE = "fade"  # a lost organ stays in place and fades
    REMOVE = "remove"  # a lost organ disappears at the start of the interval


@dataclass(frozen=True)
class ScanMark:
    """One scan of the series."""

    name: Text  #: of its file
    time: Number  #: in the clip's unit of time
    date: Text = ""  #: the time as text
    points: Count = 0  #: how many it has
    positions: NDArray[np.float32] = field(
        default_factory=lambda: np.zeros((0, 3), np.float32), compare=False
    )
    """(points, 3) relative to the clip's origin, if the scan was left out of the bake."""


@dataclass(frozen=True)
class Group:
    """Movers `first` to ``first + count - 1``, which have the same motion."""

    first: Count
    count: Count
    motion: Motion

    @property
    def stop(self) -> int:
        return self.first + self.count


@dataclass(frozen=True)
class SegmentPair:
    """How the transport of one pair of segments was solved, for the report."""

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
    """The range of quantised positions: position = low + (high - low) * quantised / 65535."""

    low: Vector
    high: Vector

    def __post_init__(self) -> None:
        is_ordered = all(low <= high for low, high in zip(self.low, self.high, strict=True))
        _require(is_ordered, "its low corner lies above its high corner")

    @property
    def step(self) -> NDArray[np.float64]:
        """(3,) the length of one quantisation step along each axis."""
        return (np.asarray(self.high, float) - np.asarray(self.low, float)) / 65535.0


@dataclass(frozen=True)
class Track:
    """One organ from birth to loss."""

    id: Count  #: index in the clip's table of tracks
    name: Text
    color: tuple[Channel, Channel, Channel]  #: sRGB, 0 to 255
    parent: Count | None = None  #: id of the track it grows from, None for the root
    born: Number = 0.0  #: time of the first scan with the organ
    lost: Number | None = None  #: time of the first later scan without it
    kind: Text = "organ"  #: "root", "organ", or more specific ("stem", "leaf")


@dataclass(frozen=True, kw_only=True)
class Interval:
    """The movers between two successive scans, as buffers that a GPU can use.

    A document has the attributes up to `segments`; the others are buffers of the file.
    """

    start: Number  #: time of the first scan
    end: Number  #: time of the second scan
    degree: Annotated[int, Meta(ge=1, le=3)]  #: of the Bézier curves
    groups: tuple[Group, ...]  #: consecutive runs of movers, MOVE first
    box: Box | None = None  #: the range of quantised positions; None if they are float32
    segments: tuple[SegmentPair, ...] = ()  #: how the transport was solved
    curve: tuple[NDArray[Any], ...] = ()
    """The Bézier points from start to end: degree + 1 arrays (N, 3), uint16 or, relative to the
    clip's origin, float32."""
    tracks: NDArray[Any] = field(default_factory=lambda: np.zeros(0, np.uint16))
    """(N,) uint16 or uint32 track ids."""
    start_colors: NDArray[np.uint8] | None = None  #: (N, 4) sRGB and alpha; None: the tracks'
    end_colors: NDArray[np.uint8] | None = None
    normals: NDArray[np.uint8] | None = None  #: (N, 4) octahedral, at start and end
    fields: tuple[NDArray[np.float32], ...] = ()
    """For each of the clip's fields (N, 2): values at start and end, NaN where unknown."""

    def __post_init__(self) -> None:
        stops = [0, *(group.stop for group in self.groups)]
        _require(self.end - self.start >= MIN_DURATION, "it must end later than it starts")
        _require([g.first for g in self.groups] == stops[:-1], "its groups do not cover its movers")
        _require(stops[-1] > 0, "it holds no movers; at least one is needed")
        if not self.curve:
            return
        _require(len(self.curve) == self.degree + 1, "its curves are of another degree")
        points = (3,), np.float32 if self.box is None else np.uint16
        layouts: dict[str, Any] = dict.fromkeys(CURVES[self.degree], points)
        layouts["track"] = (), np.uint16, np.uint32
        layouts |= {FIELD % i: ((2,), np.float32) for i in range(len(self.fields))}
        for name, buffer in self.buffers().items():
            columns, *dtypes = layouts.get(name, ((4,), np.uint8))
            check_buffer(name, buffer, (stops[-1], *columns), *dtypes)
        has_both = (self.start_colors is None) == (self.end_colors is None)
        _require(has_both, "one of its buffers start_color and end_color is missing")

    @cached_property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lower and upper corner of the bounding box of all curves, with control points."""
        corners = extent(*self.curve) if self.box is None else (self.box.low, self.box.high)
        return np.array(corners[0], float), np.array(corners[1], float)

    def buffers(self) -> dict[str, NDArray[Any]]:
        """The arrays by the names of their buffers, after the number of the interval."""
        arrays = {"track": self.tracks, **dict(zip(CURVES[self.degree], self.curve, strict=True))}
        arrays |= {FIELD % i: values for i, values in enumerate(self.fields)}
        optional = {name: getattr(self, field) for field, name in OPTIONAL.items()}
        return arrays | {name: array for name, array in optional.items() if array is not None}

    def __len__(self) -> int:
        return len(self.tracks)


@dataclass(frozen=True, kw_only=True)
class Document:
    """The attributes of a clip; those of its intervals and scans that are arrays are buffers."""

    scans: Annotated[tuple[ScanMark, ...], Meta(min_length=2)]  #: sorted by time
    intervals: Annotated[tuple[Interval, ...], Meta(min_length=1)]  #: between successive scans
    track_table: Annotated[tuple[Track, ...], Meta(min_length=1)]  #: by id
    up: Annotated[str, Meta(pattern="^-?[xyz]$")] = "z"
    """x, y, z, -x, -y or -z: the direction of growth in the frame of the input."""
    unit: Text = ""  #: length unit of the positions, "" where unknown
    time_unit: Annotated[str, Meta(pattern="^(days|scans)$")] = "days"
    """"days", or "scans" where only their order is known."""
    origin: Vector = (0.0, 0.0, 0.0)  #: world position of local zero
    floor: Number = 0.0  #: local height along `up` at which lost organs come to rest
    spacing: Annotated[float, Meta(ge=0, le=MAX_NUMBER)] = 0.0
    """Median distance between neighbouring points."""
    provenance: dict[str, Any] = field(default_factory=dict)
    """Options, versions, input digests."""
    fields: tuple[Text, ...] = ()
    """Names of the scans' scalars, such as NDVI, whose values the intervals have."""
    held_out: tuple[ScanMark, ...] = ()
    """Scans left out of the bake, sorted by time, with positions."""

    def __post_init__(self) -> None:
        """Raise ValueError where attributes contradict each other."""
        times, held_out = [[s.time for s in scans] for scans in (self.scans, self.held_out)]
        _require(times == sorted({*times}), "the scans' times do not ascend")
        _require(held_out == sorted({*held_out}), "the times in held_out do not ascend")
        is_inside = all(times[0] <= time <= times[-1] for time in held_out)
        _require(is_inside, "a time in held_out lies outside the series")
        bounds = [self.intervals[0].start, *(interval.end for interval in self.intervals)]
        is_gapless = [interval.start for interval in self.intervals] == bounds[:-1]
        _require(is_gapless, "the intervals do not follow one another without a gap")
        is_spanned = {*times} <= {*bounds} and (times[0], times[-1]) == (bounds[0], bounds[-1])
        _require(is_spanned, "the intervals do not span the series from scan to scan")
        count = len(self.track_table)
        for index, track in enumerate(self.track_table):
            is_valid = track.parent is None or index != track.parent < count
            _require(is_valid, f"tracks[{index}].parent is {track.parent}, no other track's id")
        used = max((p.track for i in self.intervals for p in i.segments), default=0)
        _require(used < count, f"a segment's track is {used}; only {count} tracks are named")


def extent(*clouds: NDArray[np.floating]) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """The lower and upper corner, (3,) each, of the bounding box of (N, 3) points, N > 0.

    Equivalent to ``points.min(axis=0), points.max(axis=0)``, but thirty times as fast.
    """
    low = np.min([[x.min() for x in points.T] for points in clouds], axis=0)
    return low, np.max([[x.max() for x in points.T] for points in clouds], axis=0)


def check_buffer(name: str, buffer: Any, shape: tuple[int, ...], *dtypes: type) -> None:
    """Raise ValueError unless a buffer has this shape, one of the dtypes, and finite positions."""
    needed = f"{' or '.join(np.dtype(dtype).name for dtype in dtypes)} {shape}"
    found = "missing" if buffer is None else f"{buffer.dtype.name} {buffer.shape}"
    is_fitting = buffer is not None and buffer.shape == shape and buffer.dtype.type in dtypes
    _require(is_fitting, f'its buffer "{name}" is {found}; the document needs {needed}')
    if shape[1:] == (3,) and np.float32 in dtypes and len(buffer):
        # Comparisons with NaN, which is the minimum and maximum of an array with NaN, are False.
        is_bounded = buffer.min() >= -MAX_NUMBER and buffer.max() <= MAX_NUMBER
        found = f"a position that is not finite, or beyond {MAX_NUMBER:g}"
        _require(is_bounded, f'its buffer "{name}" holds {found}')


def _require(condition: bool, message: str) -> None:
    """Raise ValueError with this message unless the condition holds."""
    if not condition:
        raise ValueError(message)
