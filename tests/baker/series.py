"""Series made of arrays, as if they had been read."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from baker.scans.scan import Scan, Series


def series_of(
    clouds: Sequence[np.ndarray],
    labels: Sequence[Any] | None = None,
    names: Sequence[str] | None = None,
    origins: Sequence[Any] | None = None,
    **known: Any,
) -> Series:
    """A scan of each of (N, 3) clouds: "scan 1", "scan 2", ... where they have no names."""
    names = names or [f"scan {number}" for number in range(1, len(clouds) + 1)]
    labels = labels or [None] * len(clouds)
    origins = origins or [np.zeros(3)] * len(clouds)
    scans = [
        Scan(points.astype(np.float32), own, name=name, time=float(day), origin=origin)
        for day, (points, own, name, origin) in enumerate(
            zip(clouds, labels, names, origins, strict=True)
        )
    ]
    return Series(tuple(scans), **known)
