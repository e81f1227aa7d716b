"""Label noise: specks that have the label of another organ than the one they lie in."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Neighbors
from baker.scans.scan import Scan

MAX_CHANGED_SHARE = 0.5  # of an organ; where more is in doubt, its label means something else


def clean_labels(labels: NDArray[np.int64], neighbors: Neighbors) -> NDArray[np.int64]:
    """Give specks of an organ that lie amid other organs the label of most of their neighbors.

    So do points with a negative label, which is none, where most of their neighbors have others.
    Specks that float apart keep their label: what is nearest to them says nothing of them.

    Returns `labels` itself where nothing is changed. No label vanishes.
    """
    names, organ = np.unique(labels, return_inverse=True)
    around = organ[neighbors.indices]
    if not around.size:
        return labels
    noise = np.flatnonzero(_is_speck(organ, around, neighbors))
    size = np.bincount(organ)
    changed = np.bincount(organ[noise], minlength=len(size))
    noise = noise[(changed <= MAX_CHANGED_SHARE * size)[organ[noise]]]
    unlabelled = np.flatnonzero(labels < 0)
    labelled_around = (names[around[unlabelled]] >= 0).mean(axis=1)
    noise = np.union1d(noise, unlabelled[labelled_around > MAX_CHANGED_SHARE])
    if not len(noise):
        return labels
    own_or_none = (names[around[noise]] < 0) | (around[noise] == organ[noise, None])
    votes = np.where(own_or_none, len(names), around[noise])
    organ[noise] = [np.bincount(own)[: len(names)].argmax() for own in votes]
    return names[organ]


def _is_speck(
    organ: NDArray[np.intp], around: NDArray[np.intp], neighbors: Neighbors
) -> NDArray[np.bool_]:
    """(N,) whether a point is of a piece of its organ, (N,), that lies amid others.

    A piece hangs together by neighbors, (N, k). A speck has at most k points, most of whose
    neighbors are of other organs, and is not the organ's largest piece.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

    at_border = (around != organ[:, None]).any(axis=1)  # as are all points of a speck
    border = np.flatnonzero(at_border)
    foreign = around[border] != organ[border, None]
    row, column = np.nonzero(~foreign)
    edges = border[row], neighbors.indices[border[row], column]
    graph = csr_matrix((np.ones(len(row), bool), edges), (len(organ), len(organ)))
    piece = connected_components(graph, directed=False)[1]
    size = np.bincount(piece)
    size[piece[~at_border]] = len(organ)
    largest = np.zeros(organ.max() + 1, np.intp)
    np.maximum.at(largest, organ, size[piece])
    share = np.bincount(piece[border], foreign.mean(axis=1), len(size)) / size
    gap = np.full(len(size), np.inf)
    distances = np.where(foreign, neighbors.distances[border], np.inf)
    np.minimum.at(gap, piece[border], distances.min(axis=1))
    is_near = gap <= np.median(neighbors.distances[:, -1])
    amid_others = is_near & (share > 0.5) & (size <= around.shape[1])
    return np.asarray(amid_others[piece] & (size[piece] < largest[organ]))


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
