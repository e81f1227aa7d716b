"""Label noise: points that have the label of another organ than the one they lie in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors
from baker.scans.scan import Scan

MAX_OWN_SHARE = 0.15  # of the neighbors of a point with a wrong label, that have the same one
MAX_CHANGED_SHARE = 0.5  # of an organ; where more is in doubt, its label means something else


def clean_labels(labels: NDArray[np.int64], neighbors: Neighbors) -> NDArray[np.int64]:
    """Give isolated points of a label the label of most of their neighbors.

    Returns `labels` itself where nothing is changed. No label vanishes.
    """
    names, organ = np.unique(labels, return_inverse=True)
    around = organ[neighbors.indices]
    own_share = (around == organ[:, None]).mean(axis=1) if around.size else np.ones(len(labels))
    noise = np.flatnonzero(own_share <= MAX_OWN_SHARE)
    size = np.bincount(organ)
    changed = np.bincount(organ[noise], minlength=len(size))
    noise = noise[(changed <= MAX_CHANGED_SHARE * size)[organ[noise]]]
    if not len(noise):
        return labels
    organ[noise] = [np.bincount(votes).argmax() for votes in around[noise]]
    return names[organ]


def with_clean_labels(scan: Scan, neighbors: Neighbors) -> Scan:
    """The scan with `clean_labels`, and a note of how many points were changed."""
    if scan.labels is None:
        return scan
    labels = clean_labels(scan.labels, neighbors)
    count = int((labels != scan.labels).sum())
    if not count:
        return scan
    points = "point has" if count == 1 else "points have"
    note = f"{count} {points} the label of most neighbors now, not of an organ elsewhere."
    return replace(scan, labels=labels, notes=(*scan.notes, note))
