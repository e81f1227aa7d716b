"""The movers of one interval, and their buffers in a file."""

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from gclip.errors import ClipError
from gclip.file import Container
from gclip.morton import extent
from gclip.schema import MAX_NUMBER, IntervalEntry, IntervalHeader, attributes

OPTIONAL = {"start_colors": "start_color", "end_colors": "end_color", "normals": "normals"}
"""Optional fields of an interval, (N, 4) uint8 -> name of the buffer in a file."""
COLORS = {"start_colors", "end_colors"}


@dataclass(frozen=True, kw_only=True)
class Interval(IntervalHeader):
    """The movers between two successive scans, as buffers that a GPU can use."""

    curve: Annotated[tuple[NDArray[Any], ...], Meta(min_length=2, max_length=4)]
    """The Bézier points from start to end: degree + 1 arrays (N, 3), uint16 or, relative to the
    clip's origin, float32."""
    tracks: NDArray[Any]  #: (N,) uint16 or uint32 track ids
    start_colors: NDArray[np.uint8] | None = None  #: (N, 4) sRGB and alpha; None: the tracks'
    end_colors: NDArray[np.uint8] | None = None
    normals: NDArray[np.uint8] | None = None  #: (N, 4) octahedral, at start and end

    @property
    def degree(self) -> int:
        return len(self.curve) - 1

    @property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lower and upper corner of the bounding box of all curves, with control points."""
        if self.box is not None:
            return np.asarray(self.box.low, float), np.asarray(self.box.high, float)
        low, high = extent(*self.curve)
        return low.astype(float), high.astype(float)

    def buffers(self, index: int) -> dict[str, NDArray[Any]]:
        """The arrays by the names of their buffers, for interval number `index`."""
        arrays = dict(zip(_curve_names(index, self.degree), self.curve, strict=True))
        arrays[f"{index:04d}/track"] = self.tracks
        optional = {f"{index:04d}/{name}": getattr(self, f) for f, name in OPTIONAL.items()}
        return arrays | {name: array for name, array in optional.items() if array is not None}

    def __len__(self) -> int:
        return len(self.tracks)


def read_interval(
    container: Container, index: int, entry: IntervalEntry | Interval, tracks: int
) -> Interval:
    """Read the buffers of an interval and check them.

    Parameters
    ----------
    container : Container
    index : int
        Number of the interval, from which its buffers are named.
    entry : IntervalEntry or Interval
    tracks : int
        Number of tracks of the clip.

    Raises
    ------
    ClipError
        If a buffer is missing, has another shape or type, or holds wrong values.
    """
    count = entry.groups[-1].stop
    names = _curve_names(index, entry.degree)
    if entry.box is None:
        curve = [read_positions(container, name, count) for name in names]
    else:
        curve = [container.take(name, (count, 3), np.uint16) for name in names]
    ids = container.take(f"{index:04d}/track", (count,), np.uint16, np.uint32)
    if int(ids.max()) >= tracks:
        found = f'its buffer "{index:04d}/track" names track {int(ids.max())}'
        raise ClipError(f"{found}; only {tracks} tracks are named")
    present = {f for f, name in OPTIONAL.items() if f"{index:04d}/{name}" in container.buffers}
    present |= COLORS if present & COLORS else set()  # both are required if one is present
    optional: dict[str, Any] = {
        field: container.take(f"{index:04d}/{OPTIONAL[field]}", (count, 4), np.uint8)
        for field in sorted(present)
    }
    return Interval(
        curve=tuple(curve),
        tracks=ids,
        **optional,
        **attributes(entry, IntervalHeader),
    )


def read_positions(container: Container, name: str, count: int) -> NDArray[np.float32]:
    """Read a buffer of (count, 3) positions. Raises ClipError unless they are finite."""
    points = container.take(name, (count, 3), np.float32)
    # Comparisons with NaN, which is the minimum and maximum of an array with NaN, are False.
    if count and not (points.min() >= -MAX_NUMBER and points.max() <= MAX_NUMBER):
        found = f"a position that is not finite, or beyond {MAX_NUMBER:g}"
        raise ClipError(f'its buffer "{name}" holds {found}')
    return points


def _curve_names(index: int, degree: int) -> list[str]:
    """The names of an interval's position buffers, from start to end."""
    controls = [f"{index:04d}/control{i}" for i in range(1, degree)]
    return [f"{index:04d}/start", *controls, f"{index:04d}/end"]
