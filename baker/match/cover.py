"""Organs numbered anew in every scan, named the same in all (baker/match/tracks.py)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.match.pieces import agreement
from baker.match.tracks import track_organs

__all__ = ["agreement", "consistent_labels"]


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
