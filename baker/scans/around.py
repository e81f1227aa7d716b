"""What a scan's points have around them: looked up once, while it is read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.contacts import MOST_ORGANS, Borders, Gaps, contacts
from baker.nearby import CurveTree
from baker.scans.cloud import Cloud
from baker.scans.strays import without_strays
from baker.spacing import Surroundings, point_spacing
from baker.workers import Crew


def look_around(cloud: Cloud, workers: int = 1) -> tuple[Cloud, Surroundings]:
    """The cloud with strays of its labels mended, and all of its surroundings.

    Notes how many points were given another label. workers: threads.
    """
    tree = CurveTree.of(cloud.points)

    def around_points() -> Surroundings:
        return Surroundings.of(cloud.points, workers, surface=True, tree=tree)

    labels = cloud.labels
    if labels is None:
        return cloud, around_points()
    # Neither waits for the other: what a single thread has to do of one is done beside the other.
    looks: list[Callable[[], Any]] = [around_points, lambda: _organs(cloud.points, labels, tree)]
    around, (mended, touching) = Crew(workers).map(lambda look: look(), looks)
    around = replace(around, touching=touching)
    changed = int((mended != labels).sum())
    if not changed:
        return cloud, around
    points = "point has" if changed == 1 else "points have"
    return replace(cloud, labels=mended).noting(
        f"{changed} {points} the label of what is all around now, not of an organ elsewhere."
    ), around


def _organs(
    points: NDArray[np.floating], labels: NDArray[np.int64], tree: CurveTree
) -> tuple[NDArray[np.int64], Gaps | None]:
    """The labels, strays mended, and how far apart what touches is, if they number organs."""
    found = Borders.of(tree.points, labels[tree.order], point_spacing(points, tree.tree))
    borders = without_strays(found, tree.tree)
    if borders is not found:
        labels = np.empty_like(labels)
        labels[tree.order] = borders.names[borders.owner]
    return labels, contacts(borders) if len(borders.names) <= MOST_ORGANS else None
