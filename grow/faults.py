"""What a depth camera and a tired annotator get wrong (the paper on the Komatsuna data, section 4).

Depth edges don't sit where the colour image's edges are, and smear; thin stalks get lost in what is
behind them; some pixels get no depth; labels may be a little misplaced.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Faults:
    """How far it goes wrong.

    shift:   pixels, standard deviation of the depth image's displacement, part of it uneven.
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
    """The depth (H, W) mm that the camera measures, 0 where it measures nothing."""
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
    """The labels (H, W) that someone has painted."""
    from scipy.ndimage import map_coordinates

    if not faults.labels:
        return label
    where = _displaced(label.shape, faults.labels, rng)
    return map_coordinates(label, where, order=0, mode="nearest")


def _displaced(
    shape: tuple[int, ...], amount: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Pixel coordinates (2, H, W), displaced by one shift for all and a slowly changing one."""
    from scipy.ndimage import zoom

    together = rng.normal(0, amount, 2)
    coarse = rng.normal(0, amount / 2, (2, 6, 8))
    uneven = zoom(coarse, (1, shape[0] / 6, shape[1] / 8), order=1)[:, : shape[0], : shape[1]]
    return np.indices(shape) + together[:, None, None] + uneven
