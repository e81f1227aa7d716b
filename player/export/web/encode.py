"""An interval's movers as few bytes, for the page that `web/clip.js` unpacks.

Neighbours in a clip's buffers are neighbours on the plant, so differences between them are small.
Byte by byte, all of one buffer's low bytes together, they deflate well.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gclip.file import check_whole

if TYPE_CHECKING:
    from gclip import Interval

FINE = 1 / 32  # largest step of the positions, as a share of the point spacing, where 16 bits allow
LEVELS = 65535


@dataclass(frozen=True)
class Packed:
    """The bytes, deflated, and how to read them: position = low + step × number."""

    data: bytes
    low: tuple[float, float, float]
    step: tuple[float, float, float]
    track_bytes: int
    colored: bool


def pack(interval: Interval, spacing: float) -> Packed:
    """Quantise and compress one interval's movers; they keep their order.

    spacing: the clip's point spacing. Positions move by 1/64 of it at most along each axis, or by
             1/131070 of the interval's side where that is more.
    Raises ClipError where the clip's file was cut short after it was opened.
    """
    check_whole(interval.tracks)
    points, low, step = _quantised(interval, spacing)
    start, *controls, end = points
    planes = [_differences(start), _differences(end - start)]
    for j, control in enumerate(controls, start=1):
        straight = (start * (interval.degree - j) + end * j) // interval.degree
        planes.append(_differences(control - straight))
    tracks = np.ascontiguousarray(interval.tracks)
    planes.append(tracks.view(np.uint8).reshape(len(tracks), tracks.itemsize).T)
    colored = interval.start_colors is not None and interval.end_colors is not None
    if interval.start_colors is not None and interval.end_colors is not None:
        paint, last = interval.start_colors[:, :3], interval.end_colors[:, :3]
        planes += [_steps(paint), _steps(last - paint)]
    data = b"".join(np.ascontiguousarray(plane).tobytes() for plane in planes)
    return Packed(zlib.compress(data, 9), _triple(low), _triple(step), tracks.itemsize, colored)


def _quantised(
    interval: Interval, spacing: float
) -> tuple[list[NDArray[np.int32]], NDArray[np.float64], NDArray[np.float64]]:
    """The curve's points as whole steps from 0 to 65535 above the lowest corner."""
    box = interval.box
    low = np.min([p.min(axis=0) for p in interval.curve], axis=0).astype(np.float64)
    high = np.max([p.max(axis=0) for p in interval.curve], axis=0).astype(np.float64)
    unit, origin = (np.ones(3), np.zeros(3)) if box is None else (box.step, np.asarray(box.low))
    step = np.maximum((high - low) * unit / LEVELS, FINE * spacing)
    step = np.where(step > 0, step, 1.0)
    levels = [np.round((p - low) * unit / step).astype(np.int32) for p in interval.curve]
    return levels, origin + unit * low, step


def _differences(values: NDArray[np.int32]) -> NDArray[np.uint8]:
    """(6, N) of (N, 3): low and high bytes, axis by axis, of what each adds to the one before it.

    Sums of two's complements wrap round, and the sign is kept in the lowest bit (zigzag).
    """
    steps = np.diff(values, axis=0, prepend=np.zeros((1, 3), np.int32)).astype(np.int16)
    zigzag = ((steps << 1) ^ (steps >> 15)).astype(np.uint16)
    return np.stack([zigzag & 0xFF, zigzag >> 8]).astype(np.uint8).transpose(2, 0, 1).reshape(6, -1)


def _steps(values: NDArray[Any]) -> NDArray[np.uint8]:
    """(3, N) of (N, 3) bytes: what each adds to the one before it, modulo 256."""
    return np.diff(values, axis=0, prepend=np.zeros((1, 3), np.uint8)).T


def _triple(vector: NDArray[np.float64]) -> tuple[float, float, float]:
    return float(vector[0]), float(vector[1]), float(vector[2])
