"""Errors of a depth camera and of manual labels (section 4 of the paper, Komatsuna).

Depth edges are displaced from those of the colour image and blurred; thin stalks get the depth of
the background; some pixels have no depth; labels may be displaced.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Faults:
    """Sizes of the errors.

    shift:   pixels, standard deviation of the displacement of the depth image, partly uneven.
    smear:   pixels, standard deviation of the blur over depth edges.
    noise:   mm, standard deviation, of every pixel.
    dropout: share of the pixels at depth edges without any depth.
    labels:  pixels, standard deviation of the uneven displacement of labels.
    """

    shift: float = 1.2
    smear: float = 0.9
    noise: float = 0.4
    dropout: float = 0.2
    labels: float = 0.0


def spoil_depth(
    depth: NDArray[np.float64], faults: Faults, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Add the errors of a camera to (H, W) depth in mm; 0 where nothing is measured."""
    from scipy.ndimage import gaussian_filter, map_coordinates, maximum_filter, minimum_filter

    moved = map_coordinates(
        depth, _displaced(depth.shape, faults.shift, rng), order=1, mode="nearest"
    )
    smeared = gaussian_filter(moved, faults.smear)
    measured = smeared + rng.normal(0, faults.noise, depth.shape)
    at_edge = maximum_filter(smeared, 5) - minimum_filter(smeared, 5) > 10
    lost = at_edge & (rng.random(depth.shape) < faults.dropout)
    return np.where(lost, 0.0, measured)


def misplace_labels(
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
    """(2, H, W) pixel coordinates, displaced by a constant and by a smoothly varying shift."""
    from scipy.ndimage import zoom

    constant = rng.normal(0, amount, 2)
    coarse = rng.normal(0, amount / 2, (2, 6, 8))
    varying = zoom(coarse, (1, shape[0] / 6, shape[1] / 8), order=1)[:, : shape[0], : shape[1]]
    return np.indices(shape) + constant[:, None, None] + varying
