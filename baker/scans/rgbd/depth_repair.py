"""Depth at the borders of organs, marked unknown where it can't be right, then filled.

A depth camera's edges don't sit on the colour image's edges: along an organ's border its pixels
show the depth of what lies behind, or a mixture. For each label separately, as the paper does
(section 4, Komatsuna), in two steps:

1. Depth is unknown where the camera measured none, where a hand-painted mask says so, on the
   outermost ring of the label, and in a band along its border wherever it jumps away from the
   label's surface. That surface is a robust polynomial of second degree (which follows a tilted,
   arched leaf) plus a robust local mean of what it leaves over.
2. The deviation from the polynomial is filled by diffusion from the valid pixels: the steady state
   of the implicit diffusion of Desbrun et al. (Implicit Fairing of Irregular Meshes using Diffusion
   and Curvature Flow, SIGGRAPH 1999), which is the solution of Laplace's equation with the valid
   pixels as boundary values. Diffusing the deviation instead of the depth keeps a tilted leaf
   tilted up to its rim.

Valid depth is never changed, nor is noise in it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Depth = NDArray[np.float64]
Mask = NDArray[np.bool_]

REACH = 3.0  # pixels, standard deviation of the local mean
ROUNDS = 3  # of reweighting, each with half the tolerance of the one before
SURE = 3.0  # standard deviations of the noise that are no jump


@dataclass(frozen=True)
class RepairOptions:
    """What is marked unknown.

    ring: pixels along a label's border that never count as valid, unless the organ is too thin to
          have others near by.
    band: pixels along a label's border in which depth may jump; 0 looks for no jumps.
    jump: mm off the label's surface from which on depth is implausible; more where the depth is
          so noisy that three standard deviations are more.
    """

    ring: int = 1
    band: int = 6
    jump: float = 2.0


@dataclass(frozen=True)
class LabelRepair:
    """What happened to the pixels of one label: all, why unknown (first reason), and outcome.

    filled + dropped = missing + painted + jumps + ring; dropped pixels had no valid depth in reach.
    """

    label: int
    pixels: int
    missing: int
    painted: int
    jumps: int
    ring: int
    filled: int
    dropped: int


@dataclass(frozen=True)
class Repaired:
    """depth: (H, W) float64 mm, 0 outside of all labels and where none could be found.
    unknown: (H, W) bool, the labels' pixels whose depth was not taken as measured."""

    depth: Depth
    unknown: Mask
    labels: tuple[LabelRepair, ...]


def repair(
    depth: Depth,
    labels: NDArray[np.integer],
    background: int = 0,
    painted: Mask | None = None,
    options: RepairOptions | None = None,
) -> Repaired:
    """Mark implausible depth in every label but the background, and fill it by diffusion.

    depth: (H, W) mm, 0 where nothing was measured. labels: (H, W). painted: (H, W), True where
    someone marked the depth as unknown.
    """
    from scipy.ndimage import find_objects

    options = options or RepairOptions()
    names, index = np.unique(labels, return_inverse=True)
    segment = index.reshape(labels.shape).astype(np.int32) + 1
    marked = np.zeros(labels.shape, bool) if painted is None else painted
    trend = np.zeros(labels.shape)
    reason = np.zeros(labels.shape, np.uint8)
    for number, (name, box) in enumerate(zip(names, find_objects(segment), strict=True), 1):
        if name == background:
            segment[segment == number] = 0
            continue
        box = tuple(slice(max(s.start - 1, 0), s.stop + 1) for s in box)
        inside = segment[box] == number
        found, surface = _examine(depth[box], inside, marked[box], options)
        reason[box][inside] = found[inside]
        trend[box][inside] = surface[inside]

    unknown = reason > VALID
    valid = (segment > 0) & ~unknown
    deviation = diffuse(depth - trend, valid, segment)
    filled = unknown & np.isfinite(deviation)
    # A surface continued past the camera is no depth.
    result = np.where(filled, np.maximum(trend + np.nan_to_num(deviation), 0.0), 0.0)
    result[valid] = depth[valid]
    counts = _counts(names, background, segment, reason, unknown & (result == 0))
    return Repaired(result, unknown, counts)


VALID, MISSING, PAINTED, JUMP, RING = range(5)


def _examine(
    depth: Depth, inside: Mask, painted: Mask, options: RepairOptions
) -> tuple[NDArray[np.uint8], Depth]:
    """Why each pixel of one label is unknown, and the label's polynomial surface."""
    from scipy.ndimage import binary_dilation

    reason = np.zeros(depth.shape, np.uint8)
    reason[inside & painted] = PAINTED
    reason[inside & (depth <= 0)] = MISSING
    measured = inside & (reason == VALID)
    if not measured.any():
        return reason, np.zeros(depth.shape)

    inward = _distance_inward(inside)
    surface = _polynomial(depth, measured, np.minimum(inward / max(options.band, 1), 1.0))
    off = np.where(measured, depth - surface, 0.0)
    if options.band:
        in_band = measured & (inward <= options.band)
        center = _local_mean(off, measured, inward, options)
        error = np.abs(off - center)
        core = error[measured & ~in_band]
        noise = 1.4826 * float(np.median(core)) if len(core) else 0.0
        jumps = in_band & (error > max(options.jump, SURE * noise))
        # What lies next to a jump is likely a mixture of both sides.
        jumps |= in_band & binary_dilation(jumps) & (error > max(options.jump / 2, 2 * noise))
        reason[jumps] = JUMP
        measured &= ~jumps
    if options.ring:
        ring = measured & (inward <= options.ring)
        near_others = binary_dilation(
            measured & ~ring, np.ones((3, 3), bool), iterations=options.ring
        )
        reason[ring & near_others] = RING
    return reason, surface


def _distance_inward(inside: Mask) -> Depth:
    """Pixels from the label's border; 1 on its outermost ring. The picture's edge is no border."""
    from scipy.ndimage import distance_transform_cdt

    if inside.all():
        return np.full(inside.shape, float(max(inside.shape)))
    return distance_transform_cdt(inside, metric="chessboard").astype(np.float64)


def _polynomial(depth: Depth, measured: Mask, trust: Depth) -> Depth:
    """A robust surface of second degree (of lower degree for few pixels), by reweighting.

    trust: 0 to 1, how far a pixel counts from the start.
    """
    grid = np.indices(depth.shape).astype(np.float64)
    grid -= grid[:, measured].mean(axis=1)[:, None, None]
    v, u = grid[0] / max(depth.shape), grid[1] / max(depth.shape)
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=-1)
    count = int(measured.sum())
    terms = terms[..., : 6 if count >= 60 else 3 if count >= 12 else 1]

    rows, heights = terms[measured], depth[measured]
    weights = trust[measured] ** 2
    middle = _weighted_median(heights, weights)
    values = heights - middle
    scale = max(4 * _weighted_median(np.abs(values), weights), 1.0)
    coefficients = np.zeros(rows.shape[1])
    for _ in range(12):
        residual = values - rows @ coefficients
        weighted = rows * (weights * np.exp(-((residual / scale) ** 2)))[:, None]
        # A little stiffness keeps a surface through pixels in one line from tipping over.
        stiff = 1e-6 * np.trace(weighted.T @ rows) * np.eye(rows.shape[1])
        coefficients = np.linalg.solve(weighted.T @ rows + stiff, weighted.T @ values)
        residual = np.abs(values - rows @ coefficients)
        scale = max(min(scale, 4 * _weighted_median(residual, weights)), 1.0)
    return middle + terms @ coefficients


def _weighted_median(values: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    order = np.argsort(values, kind="stable")
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, total[-1] / 2)])


def _local_mean(off: Depth, measured: Mask, inward: Depth, options: RepairOptions) -> Depth:
    """Robust mean of `off` around each pixel, in which inner pixels count for more."""
    from scipy.ndimage import gaussian_filter

    trust = np.where(measured, np.minimum(inward / options.band, 1.0) ** 2, 0.0)
    center = np.zeros_like(off)
    tolerance = options.jump * 2**ROUNDS
    for _ in range(ROUNDS):
        weights = trust * np.exp(-(((off - center) / tolerance) ** 2))
        total = gaussian_filter(weights, REACH)
        mean = gaussian_filter(weights * off, REACH) / np.maximum(total, 1e-12)
        center = np.where(total > 1e-6, mean, center)
        tolerance /= 2
    return center


def diffuse(values: Depth, valid: Mask, segment: NDArray[np.integer]) -> Depth:
    """`values` where valid; elsewhere in each segment the solution of Laplace's equation.

    segment: (H, W), 0 is outside. Nothing flows between segments or out of them. NaN outside, and
    in parts of a segment (joined over pixels' sides) without any valid pixel.
    """
    from scipy.sparse import coo_array, csr_array
    from scipy.sparse.csgraph import connected_components
    from scipy.sparse.linalg import spsolve

    result = np.where(valid, values, np.nan)
    unknown = (segment > 0) & ~valid
    if not unknown.any():
        return result
    a, b = _sides(segment)
    size = segment.size
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(size, size))
    part = connected_components(graph, directed=False)[1]
    reached = np.zeros(part.max() + 1, bool)
    reached[part[valid.ravel()]] = True
    solved = np.flatnonzero(unknown.ravel() & reached[part])
    if not len(solved):
        return result

    row = np.full(size, -1)
    row[solved] = np.arange(len(solved))
    start, end = np.concatenate([a, b]), np.concatenate([b, a])
    start, end = start[row[start] >= 0], end[row[start] >= 0]
    inner = row[end] >= 0
    degree = np.bincount(row[start], minlength=len(solved)).astype(np.float64)
    source = np.bincount(row[start[~inner]], values.ravel()[end[~inner]], minlength=len(solved))
    diagonal = np.arange(len(solved))
    laplacian = csr_array(
        (
            np.concatenate([degree, -np.ones(int(inner.sum()))]),
            (
                np.concatenate([diagonal, row[start[inner]]]),
                np.concatenate([diagonal, row[end[inner]]]),
            ),
        ),
        shape=(len(solved), len(solved)),
    )
    result.ravel()[solved] = spsolve(laplacian.tocsc(), source, permc_spec="MMD_AT_PLUS_A")
    return result


def _sides(segment: NDArray[np.integer]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Flat indices of the two pixels on every side that joins two of one segment."""
    pixel = np.arange(segment.size).reshape(segment.shape)
    pairs: list[tuple[NDArray, NDArray]] = []
    cut: Callable[[NDArray], tuple[NDArray, NDArray]]
    for cut in (lambda x: (x[:, :-1], x[:, 1:]), lambda x: (x[:-1], x[1:])):
        first, second = cut(segment)
        joined = (first == second) & (first > 0)
        a, b = cut(pixel)
        pairs.append((a[joined], b[joined]))
    return np.concatenate([a for a, _ in pairs]), np.concatenate([b for _, b in pairs])


def _counts(
    names: NDArray[np.integer],
    background: int,
    segment: NDArray[np.integer],
    reason: NDArray[np.uint8],
    dropped: Mask,
) -> tuple[LabelRepair, ...]:
    counts = []
    for number, name in enumerate(names.tolist(), 1):
        if name == background:
            continue
        inside = segment == number
        by_reason = np.bincount(reason[inside], minlength=5)
        lost = int(dropped[inside].sum())
        counts.append(
            LabelRepair(
                label=name,
                pixels=int(inside.sum()),
                missing=int(by_reason[MISSING]),
                painted=int(by_reason[PAINTED]),
                jumps=int(by_reason[JUMP]),
                ring=int(by_reason[RING]),
                filled=int(by_reason[1:].sum()) - lost,
                dropped=lost,
            )
        )
    return tuple(counts)
