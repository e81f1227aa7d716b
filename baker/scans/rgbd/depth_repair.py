"""Repair implausible depth at the borders of organs (section 4 of the paper, Komatsuna).

Along an organ's border, pixels of a depth camera show the background or a mixture of both. In each
label, depth is unknown where it is 0, and in a band along the border where it jumps away from the
label's surface or is next to unknown depth. The surface is a polynomial of degree 2, fitted
robustly, which follows a tilted, arched leaf. Unknown depth is filled by the normalized convolution
of the deviations of valid pixels from it; these are never changed themselves (H. Knutsson,
C.-F. Westin, Normalized and Differential Convolution, CVPR 1993).
"""

from functools import partial

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float64]
Mask = NDArray[np.bool_]

# docs/method.md, row 24.
BAND = 6  # pixels along a label's border that are searched for jumps
MIN_JUMP, NOISE_SIGMAS = 2.0, 3.0  # of a jump: mm, and standard deviations of the noise
LEAST_PIXELS = (60, 12)  # of surfaces of degree 2 and 1; smaller ones have degree 0
USUAL_NOISE = 0.1  # mm, scale of the robust loss of the surface's fit
SIGMA, KERNEL_RADIUS = 2.0, 12  # pixels, of the Gaussian kernel of the convolution


def repair(depth: Image, labels: NDArray[np.integer], background: int = 0) -> tuple[Image, Mask]:
    """Mark implausible depth in every label but the background, and fill it by convolution.

    All images are (H, W). depth: in mm, 0 where it is unknown. Returns the depth, 0 outside of
    labels and where it could not be filled, and whether it was unknown or implausible in a label.
    """
    from scipy import ndimage

    blur = partial(ndimage.gaussian_filter, sigma=SIGMA, mode="constant", radius=KERNEL_RADIUS)
    plant = labels != background
    valid = plant & (depth > 0)
    size = 2 * BAND + 1
    in_band = ndimage.maximum_filter(labels, size) != ndimage.minimum_filter(labels, size)
    repaired = np.zeros(labels.shape)
    number = np.unique(labels, return_inverse=True)[1].reshape(labels.shape)
    for k, box in enumerate(ndimage.find_objects(number + 1)):
        inside = plant[box] & (number[box] == k)
        is_valid = inside & valid[box]
        if not is_valid.any():
            continue
        surface = _polynomial_surface(depth[box], is_valid)
        deviation = depth[box] - surface
        noise = 1.4826 * np.median(np.abs(deviation[is_valid]))
        is_jump = np.abs(deviation) > max(MIN_JUMP, NOISE_SIGMAS * noise)
        border = is_valid & in_band[box]
        is_valid &= ~(border & is_jump)
        # Depth next to unknown depth is likely a mixture of two surfaces.
        is_valid &= ~(border & ndimage.binary_dilation(inside & ~is_valid, np.ones((3, 3))))
        valid[box][inside] = is_valid[inside]
        weight, total = blur(is_valid.astype(float)), blur(np.where(is_valid, deviation, 0.0))
        # 0 where no valid depth is within the kernel, or the result would be behind the camera.
        mean = np.divide(total, weight, out=-surface, where=weight > 0)
        filled = np.where(is_valid, depth[box], np.maximum(surface + mean, 0.0))
        repaired[box][inside] = filled[inside]
    return repaired, plant & ~valid


def _polynomial_surface(depth: Image, measured: Mask) -> Image:
    """(H, W) polynomial of degree 2 (less for few pixels), fitted with a robust loss (Cauchy)."""
    from scipy.optimize import least_squares

    count = int(measured.sum())
    v, u = np.indices(depth.shape) / max(depth.shape)
    v, u = v - v[measured].mean(), u - u[measured].mean()
    quadratic, linear = LEAST_PIXELS
    term_count = 6 if count >= quadratic else 3 if count >= linear else 1
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v][:term_count], axis=-1)
    rows, values = terms[measured], depth[measured]
    start = np.eye(term_count)[0] * np.median(values)
    robust = {"loss": "cauchy", "f_scale": USUAL_NOISE}
    fit = least_squares(lambda c: rows @ c - values, start, lambda c: rows, **robust)
    return np.asarray(terms @ fit.x)
