"""From float movers to an interval's buffers: grouped, ordered for the GPU, quantised."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.interval import Interval
from gclip.morton import block_shuffle, extent
from gclip.schema import Box, Group, Motion, SegmentPair

LEVELS = 65535  # quantisation levels along each axis of the box
MAX_STEP = 0.01  # of quantisation, as a share of the point spacing


@dataclass(frozen=True)
class Movers:
    """Movers of one motion before packing."""

    motion: Motion
    curve: tuple[NDArray[np.floating], ...]  #: start, controls, end: (N, 3) about the origin
    tracks: NDArray[np.integer]  #: (N,) track ids
    start_colors: NDArray[np.uint8] | None = None  #: (N, 4) sRGB and alpha
    end_colors: NDArray[np.uint8] | None = None

    def __len__(self) -> int:
        return len(self.tracks)


def pack_interval(
    start: float,
    end: float,
    movers: Sequence[Movers],
    *,
    spacing: float,
    precision: str = "auto",
    segments: tuple[SegmentPair, ...] = (),
) -> Interval:
    """Pack an interval's movers; curves of lower degree are raised to the highest there is.

    Each group is sorted along a Morton curve, then shuffled in blocks (see `block_shuffle`).

    Parameters
    ----------
    start, end : float
        Times of its ends.
    movers : sequence of Movers
        At least one mover.
    spacing : float
        The point spacing. Positions become 16-bit integers in the interval's box, unless one step
        of these is longer than a hundredth of it.
    precision : {"auto", "float32"}
        "float32" leaves positions as they are.
    segments : tuple of SegmentPair
        How the transport was solved.
    """
    degree = max((len(m.curve) - 1 for m in movers), default=1)
    movers = [replace(m, curve=raised(m.curve, degree)) for m in movers if len(m)]
    alike = [[m for m in movers if m.motion is motion] for motion in Motion]
    groups = [_joined(some) for some in alike if some]
    packed = _joined(groups)
    stops = np.cumsum([len(m) for m in groups]).tolist()
    order = np.concatenate(
        [
            block_shuffle(m.curve[0] + m.curve[-1]) + (stop - len(m))
            for m, stop in zip(groups, stops, strict=True)
        ]
    )
    corners = np.array([extent(points) for points in packed.curve], float)
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    box = None
    if precision != "float32" and (high - low).max() / LEVELS <= MAX_STEP * spacing:
        box = Box(tuple(low), tuple(high))

    def ordered(array: NDArray[Any] | None) -> Any:
        return None if array is None else np.take(array, order, axis=0)

    curve = [
        ordered(points.astype(np.float32) if box is None else _quantised(points, box))
        for points in packed.curve
    ]
    narrow = np.uint16 if packed.tracks.max() <= 0xFFFF else np.uint32
    return Interval(
        start=start,
        end=end,
        box=box,
        groups=tuple(
            Group(stop - len(m), len(m), m.motion) for m, stop in zip(groups, stops, strict=True)
        ),
        start_positions=curve[0],
        end_positions=curve[-1],
        control_positions=tuple(curve[1:-1]),
        tracks=ordered(packed.tracks.astype(narrow)),
        start_colors=ordered(packed.start_colors),
        end_colors=ordered(packed.end_colors),
        segments=segments,
    )


def packed_alike(interval: Interval, spacing: float, precision: str) -> bool:
    """Whether packing the same movers with this point spacing gives this interval.

    False where that is a matter of rounding.
    """
    if precision == "float32":
        return interval.box is None
    step, finest = float(np.subtract(*interval.bounds[::-1]).max()) / LEVELS, MAX_STEP * spacing
    return abs(step - finest) > 1e-6 * finest and (interval.box is not None) == (step <= finest)


def raised(curve: tuple[NDArray[Any], ...], degree: int) -> tuple[NDArray[Any], ...]:
    """The same Bézier curves with the control points of a higher degree (Farin 2002, 6.1)."""
    for low in range(len(curve) - 1, degree):
        inner = [
            (curve[i - 1] * i + curve[i] * (low + 1 - i)) / (low + 1) for i in range(1, low + 1)
        ]
        curve = (curve[0], *inner, curve[-1])
    return curve


def _joined(movers: Sequence[Movers]) -> Movers:
    def joined(arrays: Iterable[Any]) -> Any:
        found = list(arrays)
        return None if any(array is None for array in found) else np.concatenate(found)

    return Movers(
        motion=movers[0].motion,
        curve=tuple(joined(points) for points in zip(*(m.curve for m in movers), strict=True)),
        tracks=joined(m.tracks for m in movers),
        start_colors=joined(m.start_colors for m in movers),
        end_colors=joined(m.end_colors for m in movers),
    )


def _quantised(points: NDArray[np.floating], box: Box) -> NDArray[np.uint16]:
    steps = points - np.asarray(box.low)
    steps /= np.where(box.step > 0, box.step, 1.0)
    return np.round(steps, out=steps).astype(np.uint16)
