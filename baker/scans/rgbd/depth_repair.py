"""Repair implausible depth at the borders of organs (section 4 of the paper, Komatsuna).

Along an organ's border, pixels of a depth camera show the background or a mixture of both. Each
label is repaired separately, in two steps:

1. Depth is marked unknown where the camera measured none, where a hand-painted mask marks it, and
   in a band along the label's border where it jumps away from the label's surface, or is next to
   unknown depth. The surface is a polynomial of degree 2, fitted robustly, which follows a tilted,
   arched leaf.
2. The deviation from the polynomial is filled by diffusion from the valid pixels, so that a tilted
   leaf stays tilted up to its border. Valid depth is never changed, nor is its noise removed.
"""

import numpy as np
from numpy.typing import NDArray

from baker.scans.rgbd.camera import RepairOptions

Depth = NDArray[np.float64]
Mask = NDArray[np.bool_]

NOISE_SIGMAS = 3.0  # least height of a jump in standard deviations of the noise
USUAL_NOISE = 0.1  # mm, scale of the robust loss of the surface's fit
VALID, MISSING, PAINTED, JUMP, BESIDE = range(5)
REASONS = ("valid", "not measured", "painted", "off their surface", "beside such pixels")


def repair(
    depth: Depth,
    labels: NDArray[np.integer],
    background: int = 0,
    painted: Mask | None = None,
    options: RepairOptions | None = None,
) -> tuple[Depth, NDArray[np.uint8]]:
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

    Returns
    -------
    depth : (H, W) float64
        In mm; 0 outside of all labels and where it could not be filled.
    reason : (H, W) uint8
        Why depth was unknown, an index of `REASONS`.
    """
    from scipy.ndimage import binary_dilation, maximum_filter, minimum_filter

    options = options or RepairOptions()
    plant = labels != background
    reason = np.full(labels.shape, VALID, np.uint8)
    if painted is not None:
        reason[painted] = PAINTED
    reason[depth <= 0] = MISSING
    reason[~plant] = VALID
    surface, tolerance = np.zeros(labels.shape), np.zeros(labels.shape)
    for label in np.unique(labels[plant]):
        inside = labels == label
        measured = reason[inside] == VALID
        if measured.any():
            surface[inside] = _polynomial_surface(np.argwhere(inside), depth[inside], measured)
            noise = 1.4826 * np.median(np.abs(depth - surface)[inside][measured])
            tolerance[inside] = max(options.jump, NOISE_SIGMAS * noise)

    size = 2 * options.band + 1
    is_border = maximum_filter(labels, size) != minimum_filter(labels, size)
    in_band = plant & is_border & (reason == VALID)
    jumps = in_band & (np.abs(depth - surface) > tolerance)
    reason[jumps] = JUMP
    # Pixels next to unknown depth are likely a mixture of both sides.
    reason[in_band & ~jumps & binary_dilation(reason != VALID, np.ones((3, 3)))] = BESIDE
    valid = plant & (reason == VALID)
    filled = surface + diffuse(depth - surface, valid, plant, labels)
    # 0 where a label has no valid pixel, or the filled depth would be behind the camera.
    filled = np.nan_to_num(filled, posinf=0.0).clip(min=0.0)
    return np.where(valid, depth, filled), reason


def _polynomial_surface(pixels: NDArray[np.int64], depth: Depth, measured: Mask) -> Depth:
    """Fit a polynomial of degree 2 (less for few pixels) with a robust loss (Cauchy)."""
    from scipy.optimize import least_squares

    v, u = ((pixels - pixels[measured].mean(axis=0)) / (np.ptp(pixels) + 1)).T
    count = int(measured.sum())
    degree = 6 if count >= 60 else 3 if count >= 12 else 1
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v][:degree], axis=-1)
    rows, values = terms[measured], depth[measured]
    start = np.eye(terms.shape[-1])[0] * np.median(values)
    robust = {"loss": "cauchy", "f_scale": USUAL_NOISE}
    fit = least_squares(lambda c: rows @ c - values, start, lambda c: rows, **robust)
    return np.asarray(terms @ fit.x)


def diffuse(
    values: Depth, valid: Mask, plant: Mask, labels: NDArray[np.integer]
) -> NDArray[np.float64]:
    """Fill each label of the plant with the solution of Laplace's equation between valid pixels.

    Nothing flows between labels or out of the plant. NaN outside, and where no valid pixel of the
    label is connected (4-neighbourhood). It is the steady state of the implicit diffusion of
    M. Desbrun et al., Implicit Fairing of Irregular Meshes using Diffusion and Curvature Flow,
    SIGGRAPH 1999.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components, laplacian
    from scipy.sparse.linalg import spsolve

    pixel = np.arange(labels.size).reshape(labels.shape)
    across = plant[:, 1:] & (labels[:, :-1] == labels[:, 1:])
    down = plant[1:] & (labels[:-1] == labels[1:])
    a = np.concatenate([pixel[:, :-1][across], pixel[:-1][down]])
    b = np.concatenate([pixel[:, 1:][across], pixel[1:][down]])
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(labels.size, labels.size))
    component = connected_components(graph, directed=False)[1].reshape(labels.shape)
    solved = plant & ~valid & np.isin(component, component[valid])
    result = np.where(valid, values, np.nan)
    if solved.any():
        rows = laplacian(graph, symmetrized=True).tocsr()[pixel[solved]]
        source = -rows[:, pixel[valid]] @ values[valid]
        result[solved] = spsolve(rows[:, pixel[solved]], source, permc_spec="MMD_AT_PLUS_A")
    return result
