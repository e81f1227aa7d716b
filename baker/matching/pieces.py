"""Pieces of a segmentation at forks, numbered anew in every scan, named the same in all.

All pieces of a scan are matched with those of the next at once: by the mean distance of the younger
piece from the older one, for what grows covers what it was. Leaving two pieces unmatched costs a
share of what it takes to fold one back into its bud and unfold the other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.matching.assignment import assign_with_dummies
from baker.segmentation.hierarchy import split_by_label

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

SAMPLE = 400  # points of an organ that distances are measured with
# What it costs to leave an organ alone, as a share of its distance from its bud.
LOSS_PRICE, BIRTH_PRICE = 0.4, 0.75
# An unmatched piece is part of an organ that covers it in the other scan (nearer than this share of
# the piece's distance from its bud), but not in its own (this share of its distance from it there).
NEAR, COVERED = 0.75, 0.5


def consistent_pieces(
    clouds: Sequence[NDArray[np.floating]],
    pieces: Sequence[NDArray[np.integer]],
    root_points: Sequence[int],
) -> list[NDArray[np.int64]]:
    """Name pieces the same in all scans, several of one scan alike where they are one organ's.

    clouds: aligned scans, (N, 3) each; pieces: (N,) each; root_points: each scan's stem base.
    A piece that is matched to nothing, yet lies where the plant already was or still is, is no
    birth and no loss but one more piece of the organ that it lies on.
    Returns (N,) organ numbers for each scan, from 0 in order of first appearance.
    """
    names = {int(label): index for index, label in enumerate(np.unique(pieces[0]))}
    born = len(names)
    named = [_rename(pieces[0], names)]
    for k in range(1, len(clouds)):
        first = _Scan(clouds[k - 1], named[-1], root_points[k - 1])
        second = _Scan(clouds[k], pieces[k], root_points[k])
        pairs = {b: first.labels[a] for a, b in _matched(first, second)}
        pairs |= _pieces(second, first, {a: b for b, a in pairs.items()})
        names = {}
        for index, label in enumerate(second.labels):
            names[label] = pairs.get(index, born)
            born += index not in pairs
        named.append(_rename(pieces[k], names))
        later = _Scan(clouds[k], named[-1], root_points[k])
        kept = {name: i for i, name in enumerate(first.labels) if name in later.labels}
        for index, organ in _pieces(first, later, kept).items():
            named = [np.where(scan == first.labels[index], organ, scan) for scan in named]
    return named


def _pieces(scan: _Scan, other: _Scan, twins: Mapping[int, int]) -> dict[int, int]:
    """The other scan's label that each unmatched piece of a scan lies on, if it lies on one.

    twins: which piece of the scan each organ of the other scan is, by label.

    The organ must cover the piece in the other scan and leave it out in its own: a leaf that is
    lost beside another one lies as far from that before as after.
    """
    matched, pieces = set(twins.values()), {}
    for piece, sample in enumerate(scan.samples):
        if piece in matched:
            continue
        apart = [tree.query(sample)[0].mean() for tree in other.trees]
        organ = other.labels[int(np.argmin(apart))]
        if organ in twins and min(apart) < NEAR * scan.from_bud[piece]:
            beside = scan.trees[twins[organ]].query(sample)[0].mean()
            if min(apart) < COVERED * beside:
                pieces[piece] = organ
    return pieces


def agreement(
    clouds: Sequence[NDArray[np.floating]],
    labels: Sequence[NDArray[np.integer]],
    root_points: Sequence[int],
) -> float:
    """Of the organs whose label the next scan has too: the share matched to their namesake.

    By what they cover alone, for what --paper bakes hangs on it.
    """
    scans = [_Scan(c, n, r) for c, n, r in zip(clouds, labels, root_points, strict=True)]
    same = [
        first.labels[a] == second.labels[b]
        for first, second in pairwise(scans)
        for a, b in _matched(first, second)
        if first.labels[a] in second.labels
    ]
    return float(np.mean(same)) if same else 0.0


class _Scan:
    """A scan's pieces: samples of their points, and how far each is from its bud."""

    def __init__(
        self, cloud: NDArray[np.floating], labels: NDArray[np.integer], root_point: int
    ) -> None:
        from scipy.spatial import cKDTree

        self.labels, members = split_by_label(labels)
        self.samples = [cloud[own[:: -(-len(own) // SAMPLE)]] for own in members]
        self.trees = [cKDTree(sample) for sample in self.samples]
        stem = self.trees[self.labels.index(int(labels[root_point]))]
        self.from_bud = np.array([_distance_from_bud(s, stem) for s in self.samples])


def _matched(first: _Scan, second: _Scan) -> list[tuple[int, int]]:
    """Pairs of pieces, by index; all others are born or lost."""
    costs = np.array([[tree.query(s)[0].mean() for tree in second.trees] for s in first.samples])
    return assign_with_dummies(costs, LOSS_PRICE * first.from_bud, BIRTH_PRICE * second.from_bud)


def _distance_from_bud(sample: NDArray[np.floating], stem: cKDTree) -> float:
    """Root mean square distance of an organ's points from the point of it nearest to the stem."""
    bud = sample[np.argmin(stem.query(sample)[0])]
    return float(np.sqrt(((sample - bud) ** 2).sum(axis=1).mean()))


def _rename(labels: NDArray[np.integer], names: dict[int, int]) -> NDArray[np.int64]:
    values, inverse = np.unique(labels, return_inverse=True)
    return np.array([names[int(value)] for value in values], np.int64)[inverse]
