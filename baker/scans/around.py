"""What a scan's points have around them: looked up once, while it is read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from baker.geometry.contacts import MOST_ORGANS, Borders, contacts
from baker.geometry.spacing import Surroundings
from baker.scans.cloud import Cloud
from baker.scans.strays import without_strays


def look_around(cloud: Cloud, workers: int = 1) -> tuple[Cloud, Surroundings]:
    """The cloud with strays of its labels mended, and all of its surroundings.

    Notes how many points were given another label. workers: threads.
    """
    from baker.geometry.halves import Halves

    halves = Halves.of(cloud.points)
    around = Surroundings.of(cloud.points, workers, surface=True, halves=halves)
    if cloud.labels is None:
        return cloud, around
    found = Borders.of(cloud.points, cloud.labels, around.spacing, workers, halves)
    borders = without_strays(found)
    if len(borders.names) <= MOST_ORGANS:
        around = replace(around, touching=contacts(borders))
    changed = int((borders.owner != found.owner).sum())
    if not changed:
        return cloud, around
    points = "point has" if changed == 1 else "points have"
    mended = borders.names[borders.owner].astype(np.int64)
    return replace(cloud, labels=mended).noting(
        f"{changed} {points} the label of what is all around now, not of an organ elsewhere."
    ), around


def ready() -> None:
    """Load the machine code that looks around, so that not every fork has to."""
    look_around(Cloud(np.eye(3, dtype=np.float32), np.arange(3)))
