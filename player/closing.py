"""How large discs must be to close a scanned surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gclip import Clip

SAMPLES = 1500
NEIGHBORS = 48
COVERED = 0.95  # share of the surface


class ClosingDistances:
    """A clip's closing distance at any time: measured at each interval's ends, linear between.

    So the discs grow and shrink with the surface's density, and never jump.
    """

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._at_end: dict[int, float] = {}

    def at(self, index: int, share: float) -> float:
        """In the clip's unit; `index` and `share` as `gclip.evaluate.locate` gives them."""
        return (1.0 - share) * self._measured(index) + share * self._measured(index + 1)

    def _measured(self, end: int) -> float:
        if end not in self._at_end:
            from gclip.evaluate import positions_on_curve

            last = end == len(self._clip.intervals)
            interval = self._clip.intervals[end - 1 if last else end]
            points = positions_on_curve(interval, slice(None), 1.0 if last else 0.0)
            self._at_end[end] = closing_distance(points) or 2.5 * self._clip.spacing
        return self._at_end[end]


def closing_distance(points: NDArray[np.floating]) -> float:
    """The radius at which discs on the points cover most of the surface that they lie on.

    points: (N, 3) on a surface; repeated ones count once.

    The distance to the nearest point says little: a scanner's points lie close together along its
    lines, and far apart across them. So the points' neighbourhoods are laid flat, and places
    between three points each ask for the nearest one: 19 of 20 find it within this distance.
    Gives 0 where there are too few points to tell.
    """
    from scipy.spatial import cKDTree

    from gclip.pack import morton_codes

    if len(points) == 0:
        return 0.0
    _, first = np.unique(morton_codes(points), return_index=True)
    distinct = np.asarray(points[first], np.float64)
    count = min(NEIGHBORS, len(distinct) - 1)
    if count < 3:
        return 0.0
    random = np.random.default_rng(0)
    chosen = distinct[random.permutation(len(distinct))[:SAMPLES]]
    tree = cKDTree(distinct, balanced_tree=False, compact_nodes=False)
    _, neighbors = tree.query(chosen, k=count + 1)
    offsets = distinct[neighbors] - chosen[:, None]
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", offsets, offsets))
    flat = np.einsum("nki,nij->nkj", offsets, axes[:, :, 1:])
    corners = flat[np.arange(len(flat))[:, None], random.integers(0, count + 1, (len(flat), 3))]
    places = np.einsum("nc,ncj->nj", random.dirichlet((1, 1, 1), len(flat)), corners)
    nearest = np.linalg.norm(flat - places[:, None], axis=2).min(axis=1)
    return float(np.quantile(nearest, COVERED))
