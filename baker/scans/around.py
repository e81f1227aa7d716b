"""What a scan's points have around them: looked up once, while it is read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from baker.contacts import MOST_ORGANS, Borders, contacts
from baker.nearby import CurveTree
from baker.scans.cloud import Cloud
from baker.scans.strays import without_strays
from baker.spacing import Surroundings


def look_around(cloud: Cloud, workers: int = 1) -> tuple[Cloud, Surroundings]:
    """The cloud with strays of its labels mended, and all of its surroundings.

    Notes how many points were given another label. workers: threads.
    """
    tree = CurveTree.of(cloud.points)
    around = Surroundings.of(cloud.points, workers, surface=True, tree=tree)
    if cloud.labels is None:
        return cloud, around
    found = Borders.of(tree.points, cloud.labels[tree.order], around.spacing)
    borders = without_strays(found, tree.tree)
    if len(borders.names) <= MOST_ORGANS:
        around = replace(around, touching=contacts(borders, workers))
    changed = int((borders.owner != found.owner).sum())
    if not changed:
        return cloud, around
    labels = np.empty_like(cloud.labels)
    labels[tree.order] = borders.names[borders.owner]
    points = "point has" if changed == 1 else "points have"
    return replace(cloud, labels=labels).noting(
        f"{changed} {points} the label of what is all around now, not of an organ elsewhere."
    ), around
