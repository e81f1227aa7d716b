"""Pack movers into the buffers of an interval: group, sort for the GPU, and quantise them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
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

    Parameters
    ----------
    start, end : float
        Times of the two scans.
    movers : sequence of Movers
        At least one mover.
    spacing : float
        Median distance between neighbouring points.
    precision : str
        "float32", or "auto": 16-bit integers, if their step is at most `MAX_STEP` of the spacing.
    segments : tuple of SegmentPair
    """
    degree = max(len(m.curve) - 1 for m in movers)
    movers = [m for motion in Motion for m in movers if m.motion is motion and len(m)]
    groups: list[Group] = []
    for motion, same in groupby(movers, attrgetter("motion")):
        groups.append(Group(groups[-1].stop if groups else 0, sum(map(len, same)), motion))
    elevated = (elevate_degree(m.curve, degree) for m in movers)
    curve = [_concatenate(points) for points in zip(*elevated, strict=True)]
    tracks = _concatenate([m.tracks for m in movers])
    optional = {n: _concatenate([getattr(m, n) for m in movers]) for n in OPTIONAL}
    ends = (curve[0][g.first : g.stop] + curve[-1][g.first : g.stop] for g in groups)
    order = np.concatenate([g.first + block_shuffle(m) for g, m in zip(groups, ends, strict=True)])
    in_order: Any = {n: a if a is None else a[order] for n, a in optional.items()}
    low, high = extent(*curve)
    is_float = precision == "float32" or (high - low).max() / LEVELS > MAX_STEP * spacing
    box = None if is_float else Box(tuple(low.tolist()), tuple(high.tolist()))
    return Interval(
        start=start,
        end=end,
        degree=degree,
        box=box,
        groups=tuple(groups),
        curve=tuple(_packed(curve.pop(0), box, order) for _ in range(degree + 1)),
        tracks=np.take(tracks.astype(np.uint16 if tracks.max() <= 0xFFFF else np.uint32), order),
        **in_order,
        segments=segments,
    )


def elevate_degree(curve: tuple[NDArray[Any], ...], degree: int) -> tuple[NDArray[Any], ...]:
    """Elevate the degree of Bézier curves without changing them.

    Parameters
    ----------
    curve : tuple of (N, 3) ndarray
        The points of the curves: start, control points, end.
    degree : int
        Of the returned curves, at least that of the given ones.

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


def _concatenate(arrays: Sequence[Any]) -> Any:
    """Concatenate arrays; None if one is None."""
    if any(array is None for array in arrays):
        return None
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)


def _packed(points: NDArray[np.floating], box: Box | None, order: NDArray[np.intp]) -> NDArray[Any]:
    """The points in this order, as float32 where there is no box."""
    points = np.take(points, order, axis=0)
    if box is None:
        return points.astype(np.float32, copy=False)
    points = points - np.asarray(box.low)
    points /= np.where(box.step > 0, box.step, 1.0)
    return np.round(points, out=points).astype(np.uint16)
