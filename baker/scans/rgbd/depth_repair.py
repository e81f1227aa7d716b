"""Repair implausible depth at the borders of organs (section 4 of the paper, Komatsuna).

Along an organ's border, pixels of a depth camera show the background or a mixture of both. Each
label is repaired separately, in two steps:

1. Depth is marked unknown where the camera measured none, where a hand-painted mask marks it, on
   the outermost ring of the label, and in a band along its border where it jumps away from the
   label's surface: a polynomial of degree 2, fitted robustly, which follows a tilted, arched leaf.
2. The deviation from the polynomial is filled by diffusion from the valid pixels, so that a tilted
   leaf stays tilted up to its border. Valid depth is never changed, nor is its noise removed.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.scans.rgbd.camera import RepairOptions

Depth = NDArray[np.float64]
Mask = NDArray[np.bool_]

NOISE_SIGMAS = 3.0  # least height of a jump in standard deviations of the noise
USUAL_NOISE = 0.1  # mm, scale of the robust loss of the surface's fit
VALID, MISSING, PAINTED, JUMP, RING = range(5)
REASONS = ("valid", "not measured", "painted", "off their surface", "on a border")


class Repaired(NamedTuple):
    depth: Depth  #: (H, W) mm; 0 outside of all labels and where it could not be filled
    reason: NDArray[np.uint8]  #: (H, W) why depth was unknown, an index of `REASONS`


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
        In mm, 0 where nothing was measured.
    labels : (H, W) integers
    background : int
        The label that is not repaired.
    painted : (H, W) bool, optional
        A hand-painted mask of unknown depth.
    options : RepairOptions, optional
    """
    from scipy.ndimage import find_objects

    segment = np.unique(labels, return_inverse=True)[1].reshape(labels.shape) + 1
    segment[labels == background] = 0
    reason = np.full(labels.shape, VALID, np.uint8)
    if painted is not None:
        reason[painted] = PAINTED
    reason[depth <= 0] = MISSING
    reason[segment == 0] = VALID
    trend = np.zeros(labels.shape)
    for number, box in enumerate(find_objects(segment), 1):
        if box is not None:
            box = tuple(slice(max(s.start - 1, 0), s.stop + 1) for s in box)
            inside = segment[box] == number
            surface = _mark_implausible(depth[box], inside, reason[box], options or RepairOptions())
            trend[box][inside] = surface[inside]
    valid = (segment > 0) & (reason == VALID)
    # 0 where a label has no valid pixel, or the filled depth would be behind the camera.
    filled = np.nan_to_num(trend + diffuse(depth - trend, valid, segment), posinf=0.0).clip(min=0.0)
    return Repaired(np.where(valid, depth, filled), reason)


def _mark_implausible(
    depth: Depth, inside: Mask, reason: NDArray[np.uint8], options: RepairOptions
) -> Depth:
    """Mark jumps and the ring of one label in `reason`; return the label's polynomial surface."""
    from scipy.ndimage import binary_dilation, distance_transform_cdt

    measured = inside & (reason == VALID)
    if not measured.any():
        return np.zeros(depth.shape)
    # In pixels, 1 on the outermost ring; the edge of the image is not a border.
    is_border = not inside.all()
    from_border = distance_transform_cdt(inside, "chessboard") if is_border else np.inf * inside
    weight = np.minimum(from_border / max(options.band, 1), 1.0) ** 2
    surface = _polynomial_surface(depth, measured, weight)
    error = np.abs(depth - surface)
    in_band = measured & (from_border <= options.band)
    core = error[measured & ~in_band]
    noise = 1.4826 * float(np.median(core)) if len(core) else 0.0
    jumps = in_band & (error > max(options.jump, NOISE_SIGMAS * noise))
    # Pixels next to a jump are likely a mixture of both sides.
    jumps |= in_band & binary_dilation(jumps) & (error > max(options.jump / 2, 2 * noise))
    reason[jumps] = JUMP
    if options.ring:
        ring = measured & ~jumps & (from_border <= options.ring)
        within = measured & ~jumps & ~ring
        reach = binary_dilation(within, np.ones((3, 3), bool), iterations=options.ring)
        reason[ring & reach] = RING
    return surface


def _polynomial_surface(depth: Depth, measured: Mask, weight: Depth) -> Depth:
    """Fit a polynomial of degree 2 (less for few pixels) with a robust loss (Cauchy)."""
    from scipy.optimize import least_squares

    v, u = np.indices(depth.shape) / max(depth.shape)
    v, u = v - v[measured].mean(), u - u[measured].mean()
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=-1)
    count = int(measured.sum())
    terms = terms[..., : 6 if count >= 60 else 3 if count >= 12 else 1]
    root = np.sqrt(weight[measured])
    rows, values = root[:, None] * terms[measured], root * depth[measured]
    start = np.eye(terms.shape[-1])[0] * np.median(depth[measured])
    robust = {"loss": "cauchy", "f_scale": USUAL_NOISE}
    fit = least_squares(lambda c: rows @ c - values, start, lambda c: rows, **robust)
    return np.asarray(terms @ fit.x)


def diffuse(values: Depth, valid: Mask, segment: NDArray[np.integer]) -> Depth:
    """Fill each segment with the solution of Laplace's equation between its valid pixels.

    Nothing flows between segments (numbered from 1, 0 outside) or out of them. NaN outside, and
    where no valid pixel of the segment is connected (4-neighbourhood). It is the steady state of
    the implicit diffusion of M. Desbrun et al., Implicit Fairing of Irregular Meshes using
    Diffusion and Curvature Flow, SIGGRAPH 1999.
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
