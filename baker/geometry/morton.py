"""Sort points along a Morton curve, so that points near in space are near in memory."""

import numpy as np
from numpy.typing import NDArray

from gclip.schema import BLOCK, extent

POINTS_AT_ONCE = 8192  # whose codes are computed in the processor's cache
# Shifts and masks that spread the 21 lowest bits to every third bit.
SPREAD = [(32, 0x1F00000000FFFF), (16, 0x1F0000FF0000FF), (8, 0x100F00F00F00F00F)]
SPREAD += [(4, 0x10C30C30C30C30C3), (2, 0x1249249249249249)]
MIN_SIZE = 1e-30  # of the bounding box, so that its reciprocal is finite in float32


def morton_codes(points: NDArray[np.floating]) -> NDArray[np.uint64]:
    """(N,) Morton codes of (N, 3) points: interleaved bits of their integer coordinates.

    There are 21 bits for each axis of the bounding cube, with x in the lowest bit (Morton 1966).
    """
    low, high = extent(points)
    size = max(float((high - low).max()), MIN_SIZE)
    codes, scale = np.empty(len(points), np.uint64), (2**21 - 1) / size
    for begin in range(0, len(points), POINTS_AT_ONCE):
        part = slice(begin, begin + POINTS_AT_ONCE)
        cells = ((points[part] - low) * scale).T.astype(np.uint64, order="C")
        for shift, mask in SPREAD:
            cells |= cells << np.uint64(shift)
            cells &= np.uint64(mask)
        codes[part] = cells[0] | cells[1] << np.uint64(1) | cells[2] << np.uint64(2)
    return codes


def morton_order(points: NDArray[np.floating]) -> NDArray[np.intp]:
    """(N,) indices that sort (N, 3) points by the leading bits of their codes.

    Equivalent to a stable ``np.argsort(codes >> bits)``. With the indices in place of the other
    bits, the codes themselves are sorted, which numpy does ten times as fast.
    """
    bits = np.uint64(len(points).bit_length())
    codes = morton_codes(points)
    codes >>= bits
    codes <<= bits
    codes |= np.arange(len(points), dtype=np.uint64)
    codes.sort()
    codes &= ~(~np.uint64(0) << bits)
    return codes.astype(np.intp)


def block_shuffle(points: NDArray[np.floating]) -> NDArray[np.intp]:
    """(N,) indices that sort (N, 3) points along the curve, then shuffle blocks of 128 points.

    Neighbouring threads of a GPU then read neighbouring points, and any prefix is an even sample.
    """
    order = morton_order(points)
    blocks = np.split(order, range(BLOCK, len(order), BLOCK))
    return np.concatenate([blocks[i] for i in np.random.default_rng(0).permutation(len(blocks))])
