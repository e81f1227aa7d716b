"""An interval's movers as few bytes, for the page that `web/clip.js` unpacks.

Neighbours in a clip's buffers are neighbours on the plant, so differences between them are small.
Byte by byte, all of one buffer's low bytes together, they deflate well.
"""

import zlib
from typing import Any

import numpy as np
from msgspec import to_builtins
from numpy.typing import NDArray

from gclip import Interval

FINE = 1 / 32  # largest step of the positions, as a share of the point spacing, where 16 bits allow
LEVELS = 65535


def pack(interval: Interval, spacing: float) -> tuple[bytes, dict[str, Any]]:
    """Quantise and compress one interval's movers; they keep their order.

    Returns the bytes, deflated, and what `web/clip.js` knows of them: position = low + step ×
    number, the bytes of a track's number, and whether there are colours and normals.
    Positions move by 1/64 of the clip's point spacing at most along each axis, or by 1/131070 of
    the interval's side where that is more.
    """
    curve, low, step = _quantised(interval, spacing)
    steps = np.diff(curve, axis=0, prepend=np.zeros_like(curve[:1]))
    parts = [_planes(points.astype(np.uint16)) for points in steps]
    parts.append(_planes(np.asarray(interval.tracks)[:, None]))
    if interval.start_colors is not None and interval.end_colors is not None:
        paint, last = interval.start_colors[:, :3], interval.end_colors[:, :3]
        parts += [_planes(paint), _planes(last - paint)]
    if interval.normals is not None:
        parts.append(_planes(interval.normals))
    layout = {
        "start": interval.start,
        "end": interval.end,
        "count": len(interval),
        "degree": interval.degree,
        "groups": to_builtins(interval.groups),
        "low": low.tolist(),
        "step": step.tolist(),
        "track_bytes": interval.tracks.itemsize,
        "colored": interval.start_colors is not None,
        "aligned": interval.normals is not None,
    }
    return zlib.compress(b"".join(parts), 9), layout


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


def _planes(values: NDArray[Any]) -> bytes:
    """What each row of (N, k) unsigned numbers adds to the one before it: column by column, all
    low bytes first. Differences wrap round, and their sign is kept in the lowest bit (zigzag).
    """
    steps = np.diff(values, axis=0, prepend=np.zeros_like(values[:1]))
    signed = steps.view(f"i{steps.itemsize}")
    zigzag = np.ascontiguousarray(((signed << 1) ^ (signed >> (8 * steps.itemsize - 1))).T)
    planes = zigzag.view(np.uint8).reshape(len(zigzag), -1, steps.itemsize)
    return planes.transpose(0, 2, 1).tobytes()
