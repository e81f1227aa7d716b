"""Scans that don't seem to be of this plant."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from baker.alignment.icp import trimmed_residual
from baker.alignment.sample import EvenSample
from baker.scans.scan import Finding

SCANS_AROUND = 2  # before and after one that it is compared with
# By how much a scan has to be less like those around it than these are like each other. Of 1,240
# scans of 20 real series, whole, thinned or turned, 2 % are, half of them of plants that fell over;
# of scans of another species among them 94 %, of another plant of the same species two in three.
MAX_EXCESS = 0.085
MAX_UNLIKENESS = 0.2  # of two scans, which no others can be compared with
MIN_SIZE = 1e-3  # of a scan, in sizes of the largest; of a part of it, in its own
WEIGHT = 0.75  # of slenderness beside distances
PART_RADIUS, MAX_PARTS = 0.16, 200  # of the plant's size, for slenderness


def strangers(
    samples: Sequence[EvenSample], transforms: Sequence[NDArray[np.float64]]
) -> list[Finding]:
    """A finding that names the scans that are unlike those around them, if there are any.

    transforms: (4, 4) of each scan to the first one's coordinates. Two scans are as unlike as what
    the earlier one shows is far from the later one, in sizes of the plant (root mean square, its
    farthest fifth aside), and as one is more slender than the other.
    """
    count = len(samples)
    sizes = np.array([np.ptp(sample.points, axis=0).max() for sample in samples])
    sizes = np.maximum(sizes, MIN_SIZE * sizes.max() or 1.0)
    slender = [_slenderness(*each) for each in zip(samples, sizes, strict=True)]
    unlikeness = np.zeros((count, count))
    for i, j in combinations(range(count), 2):
        if j - i <= SCANS_AROUND:
            step = np.linalg.inv(transforms[i]) @ transforms[j]
            distance = trimmed_residual(samples[i], samples[j], step)
            unlikeness[i, j] = distance / (np.sqrt(sizes[i]) * np.sqrt(sizes[j]))
            unlikeness[i, j] += WEIGHT * abs(slender[i] - slender[j])
    unlikeness += unlikeness.T
    excess = np.zeros(count)
    for k in range(int(count <= 2), count):
        around = [j for j in range(count) if 0 < abs(j - k) <= SCANS_AROUND]
        others = [unlikeness[i, j] for i in around for j in around if i < j <= i + SCANS_AROUND]
        excess[k] = unlikeness[k, around].mean() - (np.mean(others) if others else 0.0)
    least = MAX_EXCESS if count > 2 else MAX_UNLIKENESS
    # Those beside a stranger are unlike it too.
    most = [excess[k] == excess[max(k - 1, 0) : k + 2].max() for k in range(count)]
    unlike = [samples[k].name for k in range(count) if most[k] and excess[k] > least]
    if not unlike:
        return []
    named = ", ".join(unlike)
    doubt = f"{named} may be of another plant or day, fallen or upside down: leave it out if so"
    return [Finding("plant", "taken for the same one in all scans", doubt)]


def _slenderness(sample: EvenSample, size: float) -> float:
    """How much parts of a plant are longer than wide, from 0 to 1, in the mean.

    Those of grasses are, leaflets are not; neither growth nor pose changes it much.
    """
    from scipy.spatial.distance import cdist

    points = sample.points - sample.points.mean(axis=0)
    near = cdist(points[:MAX_PARTS], points) <= PART_RADIUS * size
    weight = near / near.sum(axis=1, keepdims=True)
    mean = weight @ points
    squares = weight @ (points[:, :, None] * points[:, None]).reshape(-1, 9)
    variance = np.linalg.eigvalsh(squares.reshape(-1, 3, 3) - mean[:, :, None] * mean[:, None])
    _, width, length = np.sqrt(np.maximum(variance, 0.0)).T
    return float(np.mean((length - width) / np.maximum(length, MIN_SIZE * size)))
