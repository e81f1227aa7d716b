"""Scraps that one scan alone shows are given back to the organ they were cut from.

Where organs are found without labels, a few points at a leaf's tip may be an organ of their own in
one scan. They would be born, and hang in the air while the leaf grows on, until they are gone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

FEWEST = 40  # points of an organ that may be told from a scrap,
SHARE = 0.01  # and of its scan's points, which may be few


def without_glimpses(
    clouds: Sequence[NDArray[np.floating]], tracks: Sequence[NDArray[np.int64]]
) -> list[NDArray[np.int64]]:
    """Each scan's (N,) track numbers from 0, glimpses being what most of their neighbours are.

    clouds: (N, 3) of each scan. A glimpse is an organ of few points that is in one scan only. What
    only the last one has may be an organ that has just come.
    """
    scans = [set(np.unique(numbers).tolist()) for numbers in tracks]
    found = [
        _given_back(cloud, numbers, here.difference(*scans[:k], *scans[k + 1 :]))
        for k, (cloud, numbers, here) in enumerate(zip(clouds[:-1], tracks, scans, strict=False))
    ]
    numbers = np.unique(np.concatenate([*found, *tracks[-1:]]), return_inverse=True)[1]
    return np.split(numbers.astype(np.int64), np.cumsum([len(one) for one in found]))


def _given_back(
    cloud: NDArray[np.floating], numbers: NDArray[np.int64], alone: set[int]
) -> NDArray[np.int64]:
    """alone: the tracks that this scan alone has."""
    from scipy.spatial import cKDTree

    few = min(FEWEST, SHARE * len(numbers))
    scraps = [track for track in sorted(alone) if (numbers == track).sum() < few]
    rest = np.flatnonzero(~np.isin(numbers, scraps))
    if not scraps or not len(rest):
        return numbers
    tree, done = cKDTree(cloud[rest]), numbers.copy()
    for track in scraps:
        members = numbers == track
        beside = numbers[rest[tree.query(cloud[members])[1]]]
        done[members] = np.bincount(beside).argmax()
    return done
