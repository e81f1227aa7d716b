"""The movers between two successive scans, and their buffers in a file."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.errors import ClipError
from gclip.file import Container
from gclip.morton import extent
from gclip.schema import MAX_NUMBER, Box, Group, IntervalEntry, SegmentPair

OPTIONAL: dict[str, tuple[str, int, type]] = {
    "start_colors": ("start_color", 4, np.uint8),
    "end_colors": ("end_color", 4, np.uint8),
    "normals": ("normals", 4, np.uint8),
}
"""Of buffers that an interval may lack the field, the name in a file, the width and the type."""
COLORS = {"start_colors", "end_colors"}


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
    normals: NDArray[np.uint8] | None = None  #: (N, 4) octahedral, at the start and at the end
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
        optional = {name: getattr(self, field) for field, (name, *_) in OPTIONAL.items()}
        return found | {f"{index:04d}/{k}": v for k, v in optional.items() if v is not None}

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
    there = {f for f, (name, *_) in OPTIONAL.items() if f"{index:04d}/{name}" in container.buffers}
    there |= COLORS if there & COLORS else set()  # both, or none
    optional: dict[str, Any] = {
        field: container.take(f"{index:04d}/{name}", (count, width), dtype)
        for field, (name, width, dtype) in OPTIONAL.items()
        if field in there
    }
    return Interval(
        start_positions=curve[0],
        end_positions=curve[-1],
        control_positions=tuple(curve[1:-1]),
        tracks=ids,
        **optional,
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
