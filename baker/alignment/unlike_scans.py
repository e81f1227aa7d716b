"""Find scans that seem to be of another plant."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from baker.alignment.icp import nearest_pairs
from baker.alignment.sample import EvenSample
from baker.scans.scan import Finding

SCANS_AROUND = 2  # number of scans before and after a scan that it is compared with
# Distance of a scan to those around it, minus that of these to each other, in sizes of the plant.
# Of 307 scans of 19 real series, whole or thinned, 2 % exceed it; of scans of another species 86 %,
# of another plant of the same species 60 %.
MAX_EXCESS = 0.07
USUAL_DISTANCE = 0.09  # in a series of two, which has no others to compare with
MIN_SIZE = 1e-3  # of a scan, in sizes of the largest


def unlike_scans(samples: Sequence[EvenSample], transforms: NDArray[np.float64]) -> list[Finding]:
    """A finding that names the scans that are unlike those around them, if there are any.

    transforms: (S, 4, 4) from the coordinates of each scan to those of the first one.
    """
    count = len(samples)
    sizes = np.array([np.ptp(sample.points, axis=0).max() for sample in samples])
    sizes = np.maximum(sizes, MIN_SIZE * sizes.max() or 1.0)
    distances = np.full((count, count), np.nan)
    for i, j in combinations(range(count), 2):
        if j - i <= SCANS_AROUND:
            step = np.linalg.inv(transforms[i]) @ transforms[j]
            distance, _, _ = nearest_pairs(samples[i], samples[j], step)
            distances[i, j] = distances[j, i] = distance / (np.sqrt(sizes[i]) * np.sqrt(sizes[j]))
    excess = np.zeros(count)
    for k in range(int(count == 2), count):
        near = [j for j in range(count) if 0 < abs(j - k) <= SCANS_AROUND]
        usual = np.nanmean(distances[np.ix_(near, near)]) if count > 2 else USUAL_DISTANCE
        excess[k] = distances[k, near].mean() - usual
    # The scans next to an unlike one have an excess, too, but a smaller one.
    is_peak = [excess[k] == excess[max(k - 1, 0) : k + 2].max() for k in range(count)]
    unlike = [samples[k].name for k in range(count) if is_peak[k] and excess[k] > MAX_EXCESS]
    if not unlike:
        return []
    names = ", ".join(unlike)
    doubt = f"{names} may be of another plant or day, fallen or upside down: leave it out if so"
    return [Finding("plant", "taken for the same one in all scans", doubt)]
