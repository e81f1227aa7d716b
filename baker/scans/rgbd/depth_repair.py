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

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.scans.rgbd.camera import RepairOptions

Depth = NDArray[np.float64]
Mask = NDArray[np.bool_]

LOCAL_MEAN_SIGMA = 3.0  # pixels, standard deviation of the local mean's window
LOCAL_MEAN_ROUNDS = 3  # of reweighting, each with half the tolerance of the one before
NOISE_SIGMAS = 3.0  # standard deviations of the noise that are no jump
POLYNOMIAL_ROUNDS = 12
VALID, MISSING, PAINTED, JUMP, RING = range(5)  # why depth is unknown; the first reason counts


@dataclass(frozen=True)
class LabelRepair:
    """What happened to the pixels of one label.

    `missing`, `painted`, `jumps` and `ring` count the unknown ones by reason; together they are
    those `filled` and those `dropped`, which are connected to no valid pixel of their label.
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
    """A repaired depth image."""

    depth: Depth  #: (H, W) mm; 0 outside of all labels and where none could be found
    unknown: Mask  #: (H, W), the labels' pixels whose depth was not taken as measured
    labels: tuple[LabelRepair, ...]


def repair(
    depth: Depth,
    labels: NDArray[np.integer],
    background: int = 0,
    painted: Mask | None = None,
    options: RepairOptions | None = None,
) -> Repaired:
    """Mark implausible depth in every label but the background, and fill it by diffusion.

    Parameters
    ----------
    depth : (H, W) float64
        mm, 0 where nothing was measured.
    labels : (H, W) int
    background : int
        The label of what is no plant.
    painted : (H, W) bool, optional
        True where someone marked the depth as unknown.
    options : RepairOptions, optional

    References
    ----------
    Section 4 (Komatsuna).
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
    # A surface continued past the camera is no depth.
    continued = np.where(np.isfinite(deviation), np.maximum(trend + deviation, 0.0), 0.0)
    result = np.where(valid, depth, continued)
    dropped = np.bincount(segment[unknown & (result == 0)], minlength=len(names) + 1)
    counts = np.bincount(segment.ravel() * 5 + reason.ravel(), minlength=5 * len(names) + 5)
    repaired = []
    for number, name in enumerate(names.tolist(), 1):
        by_reason, lost = counts[5 * number : 5 * number + 5].tolist(), int(dropped[number])
        pixels, (_, missing, painted_over, jumps, ring) = sum(by_reason), by_reason
        if name != background:
            filled = pixels - by_reason[VALID] - lost
            repaired.append(
                LabelRepair(name, pixels, missing, painted_over, jumps, ring, filled, lost)
            )
    return Repaired(result, unknown, tuple(repaired))


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

    border_distance = _border_distance(inside)
    weight = np.minimum(border_distance / max(options.band, 1), 1.0) ** 2
    surface = _polynomial_surface(depth, measured, weight)
    if options.band:
        residual = np.where(measured, depth - surface, 0.0)
        mean = _local_mean(residual, np.where(measured, weight, 0.0), options.jump)
        error = np.abs(residual - mean)
        in_band = measured & (border_distance <= options.band)
        core = error[measured & ~in_band]
        noise = 1.4826 * float(np.median(core)) if len(core) else 0.0
        jumps = in_band & (error > max(options.jump, NOISE_SIGMAS * noise))
        # What lies next to a jump is likely a mixture of both sides.
        jumps |= in_band & binary_dilation(jumps) & (error > max(options.jump / 2, 2 * noise))
        reason[jumps] = JUMP
        measured &= ~jumps
    if options.ring:
        ring = measured & (border_distance <= options.ring)
        inner = binary_dilation(measured & ~ring, np.ones((3, 3), bool), iterations=options.ring)
        reason[ring & inner] = RING
    return reason, surface


def _border_distance(inside: Mask) -> Depth:
    """Pixels from the label's border; 1 on its outermost ring. The picture's edge is no border."""
    from scipy.ndimage import distance_transform_cdt

    if inside.all():
        return np.full(inside.shape, float(max(inside.shape)))
    return distance_transform_cdt(inside, metric="chessboard").astype(np.float64)


def _polynomial_surface(depth: Depth, measured: Mask, weight: Depth) -> Depth:
    """A polynomial surface by iteratively reweighted least squares with Welsch's weights.

    weight: of each pixel from the start, 0 to 1.
    """
    grid = np.indices(depth.shape).astype(np.float64)
    grid -= grid[:, measured].mean(axis=1)[:, None, None]
    v, u = grid / max(depth.shape)
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=-1)
    count = int(measured.sum())
    terms = terms[..., : 6 if count >= 60 else 3 if count >= 12 else 1]

    rows, weights = terms[measured], weight[measured]
    middle = _weighted_median(depth[measured], weights)
    values = depth[measured] - middle
    scale = max(4 * _weighted_median(np.abs(values), weights), 1.0)
    coefficients = np.zeros(rows.shape[1])
    for _ in range(POLYNOMIAL_ROUNDS):
        residual = values - rows @ coefficients
        weighted = rows * (weights * np.exp(-((residual / scale) ** 2)))[:, None]
        # A ridge term keeps a surface through pixels in one line from tipping over.
        ridge = 1e-6 * np.trace(weighted.T @ rows) * np.eye(rows.shape[1])
        coefficients = np.linalg.solve(weighted.T @ rows + ridge, weighted.T @ values)
        residual = np.abs(values - rows @ coefficients)
        scale = max(min(scale, 4 * _weighted_median(residual, weights)), 1.0)
    return middle + terms @ coefficients


def _weighted_median(values: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    return float(np.quantile(values, 0.5, weights=weights, method="inverted_cdf"))


def _local_mean(residual: Depth, weight: Depth, jump: float) -> Depth:
    """Robust mean of `residual` around each pixel."""
    from scipy.ndimage import gaussian_filter

    mean = np.zeros_like(residual)
    for k in range(LOCAL_MEAN_ROUNDS, 0, -1):
        weights = weight * np.exp(-(((residual - mean) / (jump * 2**k)) ** 2))
        total = gaussian_filter(weights, LOCAL_MEAN_SIGMA)
        smoothed = gaussian_filter(weights * residual, LOCAL_MEAN_SIGMA)
        mean = np.where(total > 1e-6, smoothed / np.maximum(total, 1e-12), mean)
    return mean


def diffuse(values: Depth, valid: Mask, segment: NDArray[np.integer]) -> Depth:
    """Fill each segment with the solution of Laplace's equation between its valid pixels.

    Parameters
    ----------
    values : (H, W) float64
    valid : (H, W) bool
        Where `values` hold.
    segment : (H, W) int
        Number of each pixel's segment, 0 outside. Nothing flows between segments or out of them.

    Returns
    -------
    (H, W) float64
        `values` where valid; NaN outside, and in parts of a segment (connected over pixels' sides)
        without any valid pixel.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components, laplacian
    from scipy.sparse.linalg import spsolve

    result = np.where(valid, values, np.nan)
    across = (segment[:, :-1] == segment[:, 1:]) & (segment[:, 1:] > 0)
    down = (segment[:-1] == segment[1:]) & (segment[1:] > 0)
    pixel = np.arange(segment.size).reshape(segment.shape)
    a = np.concatenate([pixel[:, :-1][across], pixel[:-1][down]])
    b = np.concatenate([pixel[:, 1:][across], pixel[1:][down]])
    edges = np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])
    graph = coo_array(edges, shape=(segment.size, segment.size)).tocsr()
    component = connected_components(graph, directed=False)[1]
    reached = np.isin(component, component[valid.ravel()])
    known = np.flatnonzero(valid)
    solved = np.flatnonzero((segment > 0).ravel() & ~valid.ravel() & reached)
    if len(solved):
        rows = laplacian(graph).tocsr()[solved]
        system, source = rows[:, solved].tocsc(), -(rows[:, known] @ values.ravel()[known])
        result.ravel()[solved] = spsolve(system, source, permc_spec="MMD_AT_PLUS_A")
    return result
