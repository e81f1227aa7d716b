"""From float movers to an interval's buffers: grouped, ordered for the GPU, quantised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.clip import Box, Group, Interval, Motion, SegmentPair

ABREAST = 64  # points that are compared with the next ones at once
BLOCK = 128  # movers that stay neighbours when the blocks are shuffled
LEVELS = 65535  # quantisation levels along each axis of the box
TINY = 1e-30  # extent of positions
FINE_ENOUGH = 0.01  # largest quantisation step, as a share of the point spacing


@dataclass(frozen=True)
class Movers:
    """Movers of one motion before packing, positions in float about the clip's origin.

    curve:  degree + 1 arrays of (N, 3): start, control points, end.
    tracks: (N,) track ids.
    start_colors, end_colors: (N, 4) uint8, or both None.
    """

    motion: Motion
    curve: tuple[NDArray[np.floating], ...]
    tracks: NDArray[np.integer]
    start_colors: NDArray[np.uint8] | None = None
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

    Positions become 16-bit integers in the interval's box, unless `precision` is "float32" or a
    quantisation step would be coarser than a hundredth of `spacing` (the point spacing).
    Each group is sorted along a Morton curve, then shuffled in blocks of 128: the GPU reads near
    where it just did, and a prefix of the group is a fair sample of it.
    """
    degree = max((len(m.curve) - 1 for m in movers), default=1)
    movers = [replace(m, curve=raised(m.curve, degree)) for m in movers]
    together = [_together([m for m in movers if m.motion is motion]) for motion in Motion]
    present = [m for m in together if m is not None and len(m)]
    low, high = _box([points for m in present for points in m.curve])
    stops = np.cumsum([len(m) for m in present])
    order = np.concatenate(
        [
            _gpu_order(m.curve[0] + m.curve[-1]) + (stop - len(m))
            for m, stop in zip(present, stops, strict=True)
        ]
    )
    joined = _together(present)
    assert joined is not None
    box = None
    if precision != "float32" and (high - low).max() / LEVELS <= FINE_ENOUGH * spacing:
        box = Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))
    narrow = np.uint16 if joined.tracks.max() <= 0xFFFF else np.uint32
    # First what makes numbers shorter, then their order.
    curve: tuple[NDArray[Any], ...] = tuple(
        np.take(
            points.astype(np.float32) if box is None else _quantised(points, box), order, axis=0
        )
        for points in joined.curve
    )
    return Interval(
        start=start,
        end=end,
        box=box,
        groups=tuple(
            Group(int(stop) - len(m), len(m), m.motion)
            for m, stop in zip(present, stops, strict=True)
        ),
        start_positions=curve[0],
        end_positions=curve[-1],
        control_positions=curve[1:-1],
        tracks=np.take(joined.tracks.astype(narrow), order),
        start_colors=_taken(joined.start_colors, order),
        end_colors=_taken(joined.end_colors, order),
        segments=segments,
    )


def packed_alike(interval: Interval, spacing: float, precision: str) -> bool:
    """Whether packing the same movers with this point spacing gives this interval.

    Where that is a matter of rounding it is said not to.
    """
    box = interval.box
    low, high = _box(interval.curve) if box is None else (np.asarray(box.low), np.asarray(box.high))
    step, finest = float((np.asarray(high) - low).max()) / LEVELS, FINE_ENOUGH * spacing
    if precision == "float32":
        return box is None
    return abs(step - finest) > 1e-6 * finest and (box is not None) == (step <= finest)


def raised(curve: tuple[NDArray[Any], ...], degree: int) -> tuple[NDArray[Any], ...]:
    """The same Bézier curves with the control points of a higher degree (Farin 2002, 6.1)."""
    for low in range(len(curve) - 1, degree):
        inner = [
            (curve[i - 1] * i + curve[i] * (low + 1 - i)) / (low + 1) for i in range(1, low + 1)
        ]
        curve = (curve[0], *inner, curve[-1])
    return curve


def _together(movers: Sequence[Movers]) -> Movers | None:
    if len(movers) <= 1:
        return movers[0] if movers else None
    colored = all(m.start_colors is not None for m in movers)
    return Movers(
        motion=movers[0].motion,
        curve=tuple(
            np.concatenate(points) for points in zip(*(m.curve for m in movers), strict=True)
        ),
        tracks=np.concatenate([m.tracks for m in movers]),
        start_colors=np.concatenate([m.start_colors for m in movers]) if colored else None,
        end_colors=np.concatenate([m.end_colors for m in movers]) if colored else None,
    )


def _taken(colors: NDArray[np.uint8] | None, order: NDArray[np.intp]) -> NDArray[np.uint8] | None:
    return None if colors is None else np.take(colors, order, axis=0)


def _box(points: Sequence[NDArray[np.floating]]) -> tuple[list[float], list[float]] | tuple:
    ends = [extent(p) for p in points]
    low, high = (np.array(side) for side in zip(*ends, strict=True))
    return low.min(axis=0).astype(float), high.max(axis=0).astype(float)


def extent(points: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """(3,) the lowest and the highest of (N, 3) points along each axis; N is at least 1.

    Long rows are compared side by side, some ten times as fast as rows of three.
    """
    whole = len(points) // ABREAST * ABREAST
    if not whole or not points.flags.c_contiguous:
        return points.min(axis=0), points.max(axis=0)
    rows, rest = points[:whole].reshape(-1, 3 * ABREAST), points[whole - 1 :]
    low, high = (side(axis=0).reshape(-1, 3) for side in (rows.min, rows.max))
    return (
        np.minimum(low.min(axis=0), rest.min(axis=0)),
        np.maximum(high.max(axis=0), rest.max(axis=0)),
    )


def _quantised(points: NDArray[np.floating], box: Box) -> NDArray[np.uint16]:
    step = np.where(box.step > 0, box.step, 1.0)
    steps = points - np.asarray(box.low)
    steps /= step
    return np.round(steps, out=steps).astype(np.uint16)


def _gpu_order(points: NDArray[np.floating]) -> NDArray[np.intp]:
    order = in_order(morton_codes(points))
    blocks = -(-len(order) // BLOCK)
    shuffled = np.random.default_rng(0).permutation(blocks)
    padded = np.full(blocks * BLOCK, -1, np.intp)
    padded[: len(order)] = order
    order = padded.reshape(blocks, BLOCK)[shuffled].ravel()
    return order[order >= 0]


def in_order(codes: NDArray[np.uint64]) -> NDArray[np.intp]:
    """(N,) indices that sort Morton codes, as far as their leading bits tell; equal ones stay.

    The others make room for the indices: to sort numbers is twice as fast as to sort by them.
    """
    room = np.uint64(len(codes).bit_length())
    numbered = (codes >> room << room) | np.arange(len(codes), dtype=np.uint64)
    numbered.sort()
    return (numbered & ((np.uint64(1) << room) - np.uint64(1))).astype(np.intp)


def morton_codes(points: NDArray[np.floating]) -> NDArray[np.uint64]:
    """(N,) Morton codes of (N, 3) positions: 21 bits an axis of the positions' box, interleaved."""
    low, high = extent(points)
    size = float((high - low).max()) or 1.0
    if size < TINY:  # its reciprocal is more than a float32 can be
        return morton_codes((points - low).astype(np.float64) / size)
    cells = ((points - low) * ((2**21 - 1) / size)).T.astype(np.uint64, order="C")
    _spread(cells)
    codes, *others = cells
    for axis, bits in enumerate(others, 1):
        codes |= np.left_shift(bits, np.uint64(axis), out=bits)
    return codes


def _spread(cells: NDArray[np.uint64]) -> None:
    """Move the 21 low bits of each number three places apart, by doubling (Morton 1966)."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        cells |= cells << np.uint64(shift)
        cells &= np.uint64(mask)
