"""Pack movers into the buffers of an interval: group, sort for the GPU, and quantise them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, groupby
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.morton import block_shuffle
from gclip.schema import OPTIONAL, Box, Group, Interval, Motion, SegmentPair, extent

LEVELS = 65535  # quantisation levels along each axis of the box
MAX_STEP = 0.01  # of quantisation, as a share of the point spacing


@dataclass(frozen=True)
class Movers:
    """Movers of one motion before packing."""

    motion: Motion
    curve: tuple[NDArray[np.floating], ...]  #: start, control points, end: (N, 3) local positions
    tracks: NDArray[np.integer]  #: (N,) track ids
    start_colors: NDArray[np.uint8] | None = None  #: (N, 4) sRGB and alpha
    end_colors: NDArray[np.uint8] | None = None
    normals: NDArray[np.uint8] | None = None  #: (N, 4) octahedral, at start and end

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
    """Pack the movers of an interval, with all curves elevated to the highest degree.

    Movers of one motion form a group, sorted by `block_shuffle`.

    start, end: times of the two scans. movers: at least one mover. spacing: median distance between
    neighbouring points. precision: "float32", or "auto": 16-bit integers, if their step is at most
    `MAX_STEP` of the spacing.
    """
    movers = [m for motion in Motion for m in movers if m.motion is motion and len(m)]
    degree = max(len(m.curve) - 1 for m in movers)
    curves = [elevate_degree(m.curve, degree) for m in movers]
    groups, orders = list[Group](), []
    for motion, same in groupby(movers, attrgetter("motion")):
        ends = np.concatenate([m.curve[0] + m.curve[-1] for m in same])
        groups.append(Group(groups[-1].stop if groups else 0, len(ends), motion))
        orders.append(groups[-1].first + block_shuffle(ends))
    order = np.concatenate(orders)
    low, high = extent(*chain.from_iterable(curves))
    tracks = np.concatenate([m.tracks for m in movers])
    tracks = tracks.astype(np.uint16 if tracks.max() <= 0xFFFF else np.uint32)
    colors_and_normals = {
        name: _in_order([getattr(m, name) for m in movers], order) for name in OPTIONAL
    }
    is_float = precision == "float32" or (high - low).max() / LEVELS > MAX_STEP * spacing
    box = None if is_float else Box(tuple(low.tolist()), tuple(high.tolist()))
    return Interval(
        start=start,
        end=end,
        degree=degree,
        box=box,
        groups=tuple(groups),
        curve=tuple(
            _in_order([_quantised(points, box) for points in same], order)
            for same in zip(*curves, strict=True)
        ),
        tracks=tracks[order],
        **colors_and_normals,
        segments=segments,
    )


def elevate_degree(curve: tuple[NDArray[Any], ...], degree: int) -> tuple[NDArray[Any], ...]:
    """Elevate the degree of Bézier curves without changing them.

    curve: (N, 3) each, the start, the control points and the end. degree: of the returned curves,
    at least that of the given ones.

    References
    ----------
    G. Farin, Curves and Surfaces for CAGD, 2002, section 6.1.
    """
    for low in range(len(curve) - 1, degree):
        inner = [
            (curve[i - 1] * i + curve[i] * (low + 1 - i)) / (low + 1) for i in range(1, low + 1)
        ]
        curve = (curve[0], *inner, curve[-1])
    return curve


def _in_order(arrays: Sequence[Any], order: NDArray[np.intp]) -> Any:
    """Concatenate arrays in this order of their rows; None if one is None."""
    if any(array is None for array in arrays):
        return None
    return np.take(np.concatenate(arrays), order, axis=0)


def _quantised(points: NDArray[np.floating], box: Box | None) -> NDArray[Any]:
    """Points as integers in a box, or as float32 where there is none."""
    if box is None:
        return points.astype(np.float32, copy=False)
    low, step = np.asarray(box.low), np.where(box.step > 0, box.step, 1.0)
    packed = np.empty(points.shape, np.uint16)
    for axis in range(3):
        packed[:, axis] = np.round((points[:, axis] - low[axis]) / step[axis])
    return packed
