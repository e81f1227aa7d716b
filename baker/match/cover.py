"""Organs numbered anew in every scan, named the same in all (baker/match/tracks.py)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.match.tracks import track_organs


def consistent_labels(
    clouds: Sequence[NDArray[np.floating]],
    labels: Sequence[NDArray[np.integer]],
    root_points: Sequence[int],
) -> list[NDArray[np.int64]]:
    """Name organs the same in all scans, where `labels` number them anew in each.

    clouds: aligned scans, (N, 3) each; labels: (N,) each; root_points: each scan's stem base.
    Returns (N,) organ numbers for each scan, from 0 in order of first appearance.
    """
    return track_organs(clouds, labels, root_points)


def agreement(
    clouds: Sequence[NDArray[np.floating]],
    labels: Sequence[NDArray[np.integer]],
    root_points: Sequence[int],
) -> float:
    """Of the organs whose label the next scan has too: the share followed to their namesake."""
    tracks = track_organs(clouds, labels, root_points)
    same: list[bool] = []
    for (first, second), (before, after) in zip(pairwise(labels), pairwise(tracks), strict=True):
        was, now = _numbers(first, before), _numbers(second, after)
        same += [was[name] == now[name] for name in was.keys() & now.keys()]
    return float(np.mean(same)) if same else 0.0


def _numbers(labels: NDArray[np.integer], tracks: NDArray[np.int64]) -> dict[int, int]:
    names, where = np.unique(labels, return_index=True)
    return dict(zip(names.tolist(), tracks[where].tolist(), strict=True))
