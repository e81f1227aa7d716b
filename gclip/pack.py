"""From float movers to an interval's buffers: grouped, ordered for the GPU, quantised."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.interval import OPTIONAL, Interval
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
    normals: NDArray[np.uint8] | None = None  #: (N, 4) octahedral, at the start and at the end

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
    movers : sequence of Movers
        At least one mover.
    spacing : float
        The point spacing. Positions become 16-bit integers in the interval's box, unless one step
        of these is longer than a hundredth of it, or `precision` is "float32".
    """
    degree = max(len(m.curve) - 1 for m in movers)
    alike = [[m for m in movers if m.motion is motion and len(m)] for motion in Motion]
    movers = [m for some in alike for m in some]
    stops = np.cumsum([sum(map(len, some)) for some in alike]).tolist()
    groups = [
        Group(first, stop - first, motion)
        for motion, first, stop in zip(Motion, [0, *stops], stops, strict=False)
        if stop > first
    ]
    curve = [_joined(p) for p in zip(*(raised(m.curve, degree) for m in movers), strict=True)]
    middle = curve[0] + curve[-1]
    order = np.concatenate([g.first + block_shuffle(middle[g.first : g.stop]) for g in groups])
    low, high = extent(*curve)
    coarse = precision == "float32" or (high - low).max() / LEVELS > MAX_STEP * spacing
    box = None if coarse else Box(tuple(low.tolist()), tuple(high.tolist()))
    curve = [p.astype(np.float32) if box is None else _quantised(p, box) for p in curve]
    tracks = _joined([m.tracks for m in movers])
    optional = {name: _joined([getattr(m, name) for m in movers]) for name in OPTIONAL}
    return Interval(
        start=start,
        end=end,
        box=box,
        groups=tuple(groups),
        start_positions=np.take(curve[0], order, axis=0),
        end_positions=np.take(curve[-1], order, axis=0),
        control_positions=tuple(np.take(points, order, axis=0) for points in curve[1:-1]),
        tracks=np.take(tracks.astype(np.uint16 if tracks.max() <= 0xFFFF else np.uint32), order),
        **{name: None if a is None else np.take(a, order, axis=0) for name, a in optional.items()},
        segments=segments,
    )


def raised(curve: tuple[NDArray[Any], ...], degree: int) -> tuple[NDArray[Any], ...]:
    """The same Bézier curves with the control points of a higher degree (Farin 2002, 6.1)."""
    for low in range(len(curve) - 1, degree):
        inner = [
            (curve[i - 1] * i + curve[i] * (low + 1 - i)) / (low + 1) for i in range(1, low + 1)
        ]
        curve = (curve[0], *inner, curve[-1])
    return curve


def _joined(arrays: Sequence[Any]) -> Any:
    return None if any(array is None for array in arrays) else np.concatenate(arrays)


def _quantised(points: NDArray[np.floating], box: Box) -> NDArray[np.uint16]:
    steps = points - np.asarray(box.low)
    steps /= np.where(box.step > 0, box.step, 1.0)
    return np.round(steps, out=steps).astype(np.uint16)
