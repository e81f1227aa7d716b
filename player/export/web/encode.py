"""Compression of an interval's movers for web pages; `web/clip.js` decompresses them.

Neighbours in a clip's buffers are neighbours on the plant, so differences between them are small.
They are stored as byte planes (first all low bytes, then all high bytes), which deflate well.
"""

import zlib
from typing import Any

import numpy as np
from msgspec import to_builtins
from numpy.typing import NDArray

from gclip import Interval

STEP_SHARE = 1 / 32  # smallest step of quantised positions, as a share of the point spacing
MAX_LEVEL = 65535


def pack(interval: Interval, spacing: float) -> tuple[bytes, dict[str, Any]]:
    """Quantise and compress the movers of an interval, in their order.

    Positions change along each axis by at most 1/64 of the point spacing, or by 1/131070 of the
    interval's extent if that is more. Returns deflated byte planes, and their layout for
    `web/clip.js`: position = low + step × level, and what is stored for each mover.
    """
    curve, low, step = _quantised(interval, spacing)
    differences = np.diff(curve, axis=0, prepend=np.zeros_like(curve[:1]))
    parts = [_planes(points.astype(np.uint16)) for points in differences]
    parts.append(_planes(np.asarray(interval.tracks)[:, None]))
    if interval.start_colors is not None and interval.end_colors is not None:
        start, end = interval.start_colors[:, :3], interval.end_colors[:, :3]
        parts += [_planes(start), _planes(end - start)]
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
    """Control points as levels from 0 to 65535, and the offset and step of the levels."""
    box = interval.box
    low = np.min([p.min(axis=0) for p in interval.curve], axis=0).astype(np.float64)
    high = np.max([p.max(axis=0) for p in interval.curve], axis=0).astype(np.float64)
    unit, origin = (np.ones(3), np.zeros(3)) if box is None else (box.step, np.asarray(box.low))
    step = np.maximum((high - low) * unit / MAX_LEVEL, STEP_SHARE * spacing)
    step = np.where(step > 0, step, 1.0)
    levels = [np.round((p - low) * unit / step).astype(np.int32) for p in interval.curve]
    return levels, origin + unit * low, step


def _planes(values: NDArray[Any]) -> bytes:
    """Encode (N, k) unsigned integers as byte planes of differences between rows.

    Differences wrap around, and are zigzag-coded: the lowest bit holds the sign.
    """
    differences = np.diff(values, axis=0, prepend=np.zeros_like(values[:1]))
    signed = differences.view(f"i{differences.itemsize}")
    zigzag = np.ascontiguousarray(((signed << 1) ^ (signed >> (8 * differences.itemsize - 1))).T)
    planes = zigzag.view(np.uint8).reshape(len(zigzag), -1, differences.itemsize)
    return planes.transpose(0, 2, 1).tobytes()
