"""Remove label noise: small groups of points with the label of another organ."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import edge_components
from baker.geometry.neighbors import Neighbors
from baker.scans.scan import Scan

MAX_CHANGED_SHARE = 0.5  # of an organ's points; if more would change, none does
MIN_MAJORITY = 0.5  # share of a point's neighbours that decides about its label


def clean_labels(labels: NDArray[np.int64], neighbors: Neighbors) -> NDArray[np.int64]:
    """Replace the labels of specks, and missing labels, by that of most of their neighbours.

    A speck is a small connected component of an organ among points of other organs. One that is
    isolated in space keeps its label. No label disappears.

    labels: (N,), returned itself if nothing is changed. Negative labels are missing ones, and are
    replaced where most neighbours have a label.
    """
    distinct, organ = np.unique(labels, return_inverse=True)
    neighbor_organ = organ[neighbors.indices]
    if not neighbor_organ.size:
        return labels
    noise = np.flatnonzero(_is_speck(organ, neighbor_organ, neighbors))
    size = np.bincount(organ)
    changed = np.bincount(organ[noise], minlength=len(size))
    noise = noise[(changed <= MAX_CHANGED_SHARE * size)[organ[noise]]]
    unlabelled = np.flatnonzero(labels < 0)
    labelled_share = (distinct[neighbor_organ[unlabelled]] >= 0).mean(axis=1)
    noise = np.union1d(noise, unlabelled[labelled_share > MIN_MAJORITY])
    if not len(noise):
        return labels
    candidates = neighbor_organ[noise]
    is_excluded = (distinct[candidates] < 0) | (candidates == organ[noise, None])
    votes = np.where(is_excluded, len(distinct), candidates)
    organ[noise] = [np.bincount(row)[: len(distinct)].argmax() for row in votes]
    return distinct[organ]


def _is_speck(
    organ: NDArray[np.intp], neighbor_organ: NDArray[np.intp], neighbors: Neighbors
) -> NDArray[np.bool_]:
    """(N,) whether a point is in a speck, by the (N,) organs and those of the (N, k) neighbours.

    A speck is a connected component of an organ's points, but not the largest one. It has at most k
    points, most of whose neighbours are of other organs.
    """
    at_border = (neighbor_organ != organ[:, None]).any(axis=1)  # includes all points of specks
    border = np.flatnonzero(at_border)
    is_foreign = neighbor_organ[border] != organ[border, None]
    row, column = np.nonzero(~is_foreign)
    edges = np.stack([border[row], neighbors.indices[border[row], column]])
    component = edge_components(edges, len(organ))
    size = np.bincount(component)
    size[component[~at_border]] = len(organ)  # a component with inner points is not a speck
    largest = np.zeros(organ.max() + 1, np.intp)
    np.maximum.at(largest, organ, size[component])
    foreign_share = np.bincount(component[border], is_foreign.mean(axis=1), len(size)) / size
    gap = np.full(len(size), np.inf)
    distances = np.where(is_foreign, neighbors.distances[border], np.inf)
    np.minimum.at(gap, component[border], distances.min(axis=1))
    is_near = gap <= np.median(neighbors.distances[:, -1])
    is_speck = is_near & (foreign_share > MIN_MAJORITY) & (size <= neighbor_organ.shape[1])
    return np.asarray(is_speck[component] & (size[component] < largest[organ]))


def with_clean_labels(scan: Scan, neighbors: Neighbors) -> Scan:
    """Apply `clean_labels` to a scan, and note the number of points changed."""
    if scan.labels is None:
        return scan
    labels = clean_labels(scan.labels, neighbors)
    count = int((labels != scan.labels).sum())
    if not count:
        return scan
    points = "point was given" if count == 1 else "points were given"
    note = f"{count} {points} the label of the surrounding organ."
    return replace(scan, labels=labels).noting(note)
