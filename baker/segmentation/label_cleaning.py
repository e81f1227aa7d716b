"""Label noise: points that have the label of another organ than the one they lie in."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors
from baker.scans.scan import Scan

MAX_RADIUS_RATIO = 2.0  # of a point's neighborhood to the median point's; else it floats apart
MAX_CHANGED_SHARE = 0.5  # of an organ; where more is in doubt, its label means something else


def clean_labels(labels: NDArray[np.int64], neighbors: Neighbors) -> NDArray[np.int64]:
    """Give a point whose label none of its neighbors has the label of most of them.

    So do points with a negative label, which is none, where most of their neighbors have others.
    Points that float apart keep their label: what is nearest to them says nothing of them.

    Returns `labels` itself where nothing is changed. No label vanishes.
    """
    names, organ = np.unique(labels, return_inverse=True)
    around = organ[neighbors.indices]
    if not around.size:
        return labels
    radius = neighbors.distances[:, -1]
    isolated = (around != organ[:, None]).all(axis=1)
    noise = np.flatnonzero(isolated & (radius <= MAX_RADIUS_RATIO * np.median(radius)))
    size = np.bincount(organ)
    changed = np.bincount(organ[noise], minlength=len(size))
    noise = noise[(changed <= MAX_CHANGED_SHARE * size)[organ[noise]]]
    unlabelled = np.flatnonzero(labels < 0)
    labelled_around = (names[around[unlabelled]] >= 0).mean(axis=1)
    noise = np.union1d(noise, unlabelled[labelled_around > MAX_CHANGED_SHARE])
    if not len(noise):
        return labels
    votes = np.where(names[around[noise]] < 0, len(names), around[noise])
    organ[noise] = [np.bincount(own)[: len(names)].argmax() for own in votes]
    return names[organ]


def with_clean_labels(scan: Scan, neighbors: Neighbors) -> Scan:
    """The scan with `clean_labels`, and a note of how many points were changed."""
    if scan.labels is None:
        return scan
    labels = clean_labels(scan.labels, neighbors)
    count = int((labels != scan.labels).sum())
    if not count:
        return scan
    points = "point was given" if count == 1 else "points were given"
    note = f"{count} {points} the label of the organ that lies around."
    return replace(scan, labels=labels, notes=(*scan.notes, note))
