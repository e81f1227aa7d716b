"""Scans that don't seem to be of this plant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.icp import trimmed_residual
from baker.alignment.sample import EvenSample
from baker.scans.finding import Finding

SCANS_AROUND = 2  # before and after one that it is compared with
# Of the plant's size: by how much a scan has to be farther from those around it than these are from
# each other. Of 20 real series no scan is 0.06 farther; of scans of another plant among them 60 %.
MAX_EXCESS = 0.055
MAX_RESIDUAL = 0.1  # of one of two scans, which no others can be compared with


def strangers(
    samples: Sequence[EvenSample], transforms: Sequence[NDArray[np.float64]], names: Sequence[str]
) -> list[Finding]:
    """A finding that names the scans that are unlike those around them, if there are any.

    transforms: (4, 4) of each scan to the first one's coordinates. Scans are as far apart as what
    the earlier one shows is from the later one, root mean square, its farthest fifth aside.
    """
    count = len(samples)
    size = max(float(np.ptp(sample.points, axis=0).max()) for sample in samples)
    distances = np.zeros((count, count))
    for i in range(count):
        for j in range(i + 1, min(i + SCANS_AROUND + 1, count)):
            step = np.linalg.inv(transforms[i]) @ transforms[j]
            distances[i, j] = trimmed_residual(samples[i], samples[j], step)
    distances += distances.T
    unlike = []
    for k in range(int(count == 2), count):
        around = [j for j in range(count) if 0 < abs(j - k) <= SCANS_AROUND]
        others = [distances[i, j] for i in around for j in around if i < j <= i + SCANS_AROUND]
        excess = np.median(distances[k, around]) - (np.median(others) if others else 0.0)
        if excess > (MAX_EXCESS if others else MAX_RESIDUAL) * size:
            unlike.append(names[k])
    if not unlike:
        return []
    doubt = f"{', '.join(unlike)} may be of another plant, upside down or in another unit"
    return [Finding("plant", "the same one in all scans", doubt)]
