"""The movers between two successive scans, and their buffers in a file."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.errors import ClipError
from gclip.file import Container
from gclip.morton import extent
from gclip.schema import MAX_NUMBER, Box, Group, IntervalEntry, SegmentPair


@dataclass(frozen=True)
class Interval:
    """The movers between two successive scans, as buffers ready for upload."""

    start: float  #: time of the first scan
    end: float  #: and of the second
    box: Box | None  #: how to read quantised positions; None where they are float32
    groups: tuple[Group, ...]  #: runs of movers that cover the buffers in order, MOVE first
    start_positions: NDArray[Any]  #: (N, 3) uint16, or float32 about the clip's origin
    end_positions: NDArray[Any]
    control_positions: tuple[NDArray[Any], ...]  #: degree - 1 arrays of the same kind
    tracks: NDArray[Any]  #: (N,) uint16 or uint32 track ids
    start_colors: NDArray[np.uint8] | None = None  #: (N, 4) sRGB and alpha, None for the tracks'
    end_colors: NDArray[np.uint8] | None = None
    segments: tuple[SegmentPair, ...] = ()  #: how the transport was solved

    @property
    def degree(self) -> int:
        return 1 + len(self.control_positions)

    @property
    def curve(self) -> tuple[NDArray[Any], ...]:
        """The Bézier points from start to end: degree + 1 arrays of (N, 3)."""
        return (self.start_positions, *self.control_positions, self.end_positions)

    @property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lowest and highest corner of the box that holds all its curves."""
        if self.box is not None:
            return np.asarray(self.box.low, float), np.asarray(self.box.high, float)
        low, high = extent(*self.curve)
        return low.astype(float), high.astype(float)

    def buffers(self, index: int) -> dict[str, NDArray[Any]]:
        """Its arrays by their names in a file where it is interval number `index`."""
        found = dict(zip(_curve_names(index, self.degree), self.curve, strict=True))
        found[f"{index:04d}/track"] = self.tracks
        if self.start_colors is not None and self.end_colors is not None:
            found[f"{index:04d}/start_color"] = self.start_colors
            found[f"{index:04d}/end_color"] = self.end_colors
        return found

    def __len__(self) -> int:
        return len(self.tracks)


def read_interval(container: Container, index: int, entry: IntervalEntry, tracks: int) -> Interval:
    """The interval of a number, its buffers checked. Raises ClipError."""
    count = entry.groups[-1].stop
    names = _curve_names(index, entry.degree)
    if entry.box is None:
        curve = [read_positions(container, name, count) for name in names]
    else:
        curve = [container.take(name, (count, 3), np.uint16) for name in names]
    ids = container.take(f"{index:04d}/track", (count,), np.uint16, np.uint32)
    if int(ids.max()) >= tracks:
        which = f'its buffer "{index:04d}/track" names track {int(ids.max())}'
        raise ClipError(f"{which}; only {tracks} tracks are named")
    colors: Any = [None, None]
    names = [f"{index:04d}/{end}_color" for end in ("start", "end")]
    if not container.unread.isdisjoint(names):
        colors = [container.take(name, (count, 4), np.uint8) for name in names]
    return Interval(
        start_positions=curve[0],
        end_positions=curve[-1],
        control_positions=tuple(curve[1:-1]),
        tracks=ids,
        start_colors=colors[0],
        end_colors=colors[1],
        **{name: getattr(entry, name) for name in ("start", "end", "box", "groups", "segments")},
    )


def read_positions(container: Container, name: str, count: int) -> NDArray[np.float32]:
    """(count, 3) positions that are numbers; the lowest and the highest tell, also of NaN."""
    points = container.take(name, (count, 3), np.float32)
    if count and not (points.min() >= -MAX_NUMBER and points.max() <= MAX_NUMBER):
        what = f"a position that is not finite, or beyond {MAX_NUMBER:g}"
        raise ClipError(f'its buffer "{name}" holds {what}')
    return points


def _curve_names(index: int, degree: int) -> list[str]:
    """The names of an interval's position buffers, from start to end."""
    controls = [f"{index:04d}/control{i}" for i in range(1, degree)]
    return [f"{index:04d}/start", *controls, f"{index:04d}/end"]
