"""Scans that don't seem to be of this plant: in another unit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from baker.alignment.sample import EvenSample
from baker.scans.finding import Finding

MAX_SIZE_RATIO = 20.0  # between a scan and most others; plants grow by less from scan to scan


def strangers(samples: Sequence[EvenSample], names: Sequence[str]) -> list[Finding]:
    """A finding for each scan that is far larger or smaller than the others."""
    sizes = np.array([np.linalg.norm(np.ptp(sample.points, axis=0)) for sample in samples])
    sizes = np.maximum(sizes, np.finfo(np.float32).tiny)
    ratios = sizes / np.median(sizes)
    return [
        Finding(
            "plant",
            "the scans are taken to be of one plant in one unit",
            f"{name} is {max(ratio, 1 / ratio):,.0f} times as {'large' if ratio > 1 else 'small'} "
            "as the others: it is in another unit or of another plant; convert it, or leave it out",
        )
        for name, ratio in zip(names, ratios, strict=True)
        if max(ratio, 1 / ratio) > MAX_SIZE_RATIO
    ]
