"""The data model of a growth clip: what a `.gclip` file says, as frozen dataclasses.

A **mover** is one animated point of an **interval** between two successive scans. It travels along
a Bézier curve of the interval's degree (1, 2 or 3): start, control points, end. A **track** is one
organ followed through the whole series.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gclip.evaluate import Frame

UP_AXES = ("x", "y", "z", "-x", "-y", "-z")


class Motion(StrEnum):
    """How a group of movers goes through its interval (paper section 3.3, growth and decay)."""

    MOVE = "move"  # from its start to its end
    FALL = "fall"  # lost: falls to the floor with gravity's ease; its litter then fades
    FADE = "fade"  # lost: stays and fades
    REMOVE = "remove"  # lost: gone as soon as the interval begins


@dataclass(frozen=True)
class ScanMark:
    """One scan of the series: `time` in the clip's unit, `date` as people write it."""

    name: str
    time: float
    date: str
    points: int


@dataclass(frozen=True)
class Track:
    """One organ from birth to loss.

    color:  sRGB, (red, green, blue), 0 to 255.
    parent: id of the track it grows from, None for the root.
    born:   time of the first scan that holds it; lost: of the first scan that no longer does.
    kind:   "root", "organ", or a name the baker knows better ("stem", "leaf").
    """

    id: int
    name: str
    color: tuple[int, int, int]
    parent: int | None = None
    born: float = 0.0
    lost: float | None = None
    kind: str = "organ"


@dataclass(frozen=True)
class Group:
    """A run of movers, `first` to `first + count`, that share a motion."""

    first: int
    count: int
    motion: Motion = Motion.MOVE

    @property
    def stop(self) -> int:
        return self.first + self.count


@dataclass(frozen=True)
class SegmentPair:
    """How one segment's transport was solved, kept for the report.

    event:          "match", "birth" or "loss".
    cost:           root mean square (or mean) distance travelled, in the clip's length unit.
    marginal_error: L1 distance of the plan's marginals from the uniform ones.
    """

    track: int
    event: str
    start_points: int
    end_points: int
    movers: int
    solver: str
    cost: float
    marginal_error: float
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Box:
    """Dequantisation of an interval: position = low + (high - low) * quantised / 65535."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    @property
    def step(self) -> NDArray[np.float64]:
        """(3,) the length of one quantisation step along each axis."""
        return (np.asarray(self.high, float) - np.asarray(self.low, float)) / 65535.0


@dataclass(frozen=True)
class Interval:
    """The movers between two successive scans, as buffers ready for upload.

    start, end: times of the two scans.
    box:        how to read the quantised positions; None where positions are float32 already.
    groups:     runs of movers that cover the buffers in order, MOVE first.
    start_positions, end_positions: (N, 3) uint16, or float32 about the clip's origin.
    control_positions: degree - 1 arrays of the same kind.
    tracks:     (N,) uint16 or uint32 track ids.
    start_colors, end_colors: (N, 4) uint8 sRGB and alpha, or None: then the track's colour counts.
    """

    start: float
    end: float
    box: Box | None
    groups: tuple[Group, ...]
    start_positions: NDArray[Any]
    end_positions: NDArray[Any]
    control_positions: tuple[NDArray[Any], ...]
    tracks: NDArray[Any]
    start_colors: NDArray[np.uint8] | None = None
    end_colors: NDArray[np.uint8] | None = None
    segments: tuple[SegmentPair, ...] = ()

    @property
    def degree(self) -> int:
        return 1 + len(self.control_positions)

    @property
    def curve(self) -> tuple[NDArray[Any], ...]:
        """The Bézier points from start to end: degree + 1 arrays of (N, 3)."""
        return (self.start_positions, *self.control_positions, self.end_positions)

    def __len__(self) -> int:
        return len(self.tracks)


@dataclass(frozen=True)
class HeldOutScan:
    """A scan that the clip was baked without, aligned with the others: the truth to compare with.

    positions: (N, 3) float32 about the clip's origin.
    """

    name: str
    time: float
    date: str
    positions: NDArray[np.float32]


@dataclass(frozen=True)
class Clip:
    """A plant's growth, ready to be played.

    origin:     (3,) world position of the local coordinates' zero, float64.
    up:         one of x, y, z, -x, -y, -z: which way the plant grows in the input's own frame.
    unit:       the length unit of the positions, "" where unknown.
    time_unit:  "days", or "scans" where the times are only an order.
    floor:      height along `up` (local coordinates) where lost organs come to rest.
    spacing:    median distance between neighbouring points, in the length unit.
    held_out:   scans that were left out of the bake, by time; empty where none were.
    provenance: options, versions, input names and digests; never paths or dates of the bake.
    """

    scans: tuple[ScanMark, ...]
    intervals: tuple[Interval, ...]
    track_table: tuple[Track, ...]
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    up: str = "z"
    unit: str = ""
    time_unit: str = "days"
    floor: float = 0.0
    spacing: float = 0.0
    held_out: tuple[HeldOutScan, ...] = ()
    provenance: dict[str, Any] = field(default_factory=dict)

    @property
    def times(self) -> list[float]:
        """The scans' times, ascending."""
        return [scan.time for scan in self.scans]

    @property
    def has_colors(self) -> bool:
        """Whether the movers carry the scans' own colours."""
        return any(interval.start_colors is not None for interval in self.intervals)

    @property
    def palette(self) -> NDArray[np.uint8]:
        """(tracks, 4) uint8 sRGB and alpha, the tracks' colours by id."""
        return np.array([(*track.color, 255) for track in self.track_table], np.uint8)

    @property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lowest and highest corner of all movers, control points included, about the origin."""
        lows, highs = zip(*(_extent(interval) for interval in self.intervals), strict=True)
        return np.min(lows, axis=0), np.max(highs, axis=0)

    def at(self, day: float) -> Frame:
        """The plant at a time; times outside the series give its first or last state.

        At a scan's own time the positions are exactly that scan's points, as a set. Within an
        interval the movers come in the same order at every time.
        """
        from gclip.evaluate import frame_at

        return frame_at(self, day)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the clip: whole or not at all. Raises ClipError where `path` can't be written."""
        from gclip.file import save_clip

        save_clip(self, path)


def _extent(interval: Interval) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if interval.box is not None:
        return np.asarray(interval.box.low, float), np.asarray(interval.box.high, float)
    low = np.min([points.min(axis=0) for points in interval.curve], axis=0)
    high = np.max([points.max(axis=0) for points in interval.curve], axis=0)
    return low.astype(float), high.astype(float)
