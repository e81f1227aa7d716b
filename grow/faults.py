"""Errors of a depth camera and of manual labels (section 4 of the paper, Komatsuna).

Depth edges are displaced from those of the colour image and blurred; thin stalks get the depth of
the background; some pixels have no depth; labels may be displaced.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Faults:
    """Sizes of the errors; all but the share are standard deviations."""

    shift: float = 1.2  # pixels, displacement of the depth image, half of it varying
    blur: float = 0.9  # pixels, of the Gaussian blur over depth edges
    noise: float = 0.4  # mm, of the depth of each pixel
    dropout: float = 0.2  # share of the pixels at depth edges that have no depth
    labels: float = 0.0  # pixels, displacement of labels, half of it varying


MIN_EDGE = 10  # mm, range of depth within 5 x 5 pixels at a depth edge


def add_depth_errors(
    depth: NDArray[np.float64], faults: Faults, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Add the errors of a camera to (H, W) depth in mm; the result is 0 where depth is lost."""
    from scipy.ndimage import gaussian_filter, map_coordinates, maximum_filter, minimum_filter

    displaced = map_coordinates(
        depth, _displaced(depth.shape, faults.shift, rng), order=1, mode="nearest"
    )
    blurred = gaussian_filter(displaced, faults.blur)
    measured = blurred + rng.normal(0, faults.noise, depth.shape)
    at_edge = maximum_filter(blurred, 5) - minimum_filter(blurred, 5) > MIN_EDGE
    lost = at_edge & (rng.random(depth.shape) < faults.dropout)
    return np.where(lost, 0.0, measured)


def displace_labels(
    label: NDArray[np.int64], faults: Faults, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Displace (H, W) labels, as in a manual annotation."""
    from scipy.ndimage import map_coordinates

    if not faults.labels:
        return label
    coordinates = _displaced(label.shape, faults.labels, rng)
    return map_coordinates(label, coordinates, order=0, mode="nearest")


def _displaced(
    shape: tuple[int, ...], amount: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """(2, H, W) pixel coordinates, displaced by a constant and by a smoothly varying shift.

    amount: standard deviation of the constant, in pixels; that of the varying shift is half of it.
    """
    from scipy.ndimage import zoom

    constant = rng.normal(0, amount, 2)
    coarse = rng.normal(0, amount / 2, (2, 6, 8))
    varying = zoom(coarse, (1, shape[0] / 6, shape[1] / 8), order=1)[:, : shape[0], : shape[1]]
    return np.indices(shape) + constant[:, None, None] + varying
