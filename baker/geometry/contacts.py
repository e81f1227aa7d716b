"""Which segments of a labelled cloud touch each other, and how far they are apart there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from baker.geometry.halves import Halves

REACH = 3.0  # gap that still counts as touching, in median point spacings

MOST_ORGANS = 1000
"""Labels of a scan, above which they number something else than organs (matching all of them with
all of the next scan's would take hours)."""

Gaps = Mapping[tuple[int, int], float]  # by what grows, and what it may grow from


@dataclass(frozen=True)
class Borders:
    """Where segments of a labelled cloud may touch.

    names:  (K,) the labels.
    owner:  (N,) which of them each point has.
    one, other, apart: (n,) points that may be within reach of another segment, what is within reach
            of them, of any segment, and how far: all about one point follow one another, the
            nearest first. Most points are amid their own, and not told of.
    """

    names: NDArray[np.integer]
    owner: NDArray[np.intp]
    one: NDArray[np.intp]
    other: NDArray[np.intp]
    apart: NDArray[np.float64]

    @classmethod
    def of(
        cls,
        points: NDArray[np.floating],
        labels: NDArray[np.integer],
        spacing: float,
        workers: int = 1,
        halves: Halves | None = None,
    ) -> Borders:
        """Those of (N, 3) points of (N,) labels.

        spacing: of the cloud's points; workers: threads; halves: of the points, where known.
        """
        from baker.geometry.halves import Halves

        names, owner = np.unique(labels, return_inverse=True)
        halves = halves or Halves.of(points)
        pairs = halves.pairs(owner.take(halves.order), REACH * spacing, workers)
        return cls(names, owner, *pairs)


def contacts(borders: Borders) -> Gaps:
    """By their labels, both ways, how far apart segments are that touch."""
    one, other = borders.owner.take(borders.one), borders.owner.take(borders.other)
    meet = np.flatnonzero(one != other)
    one, other, gaps = one.take(meet), other.take(meet), borders.apart.take(meet)
    pairs = np.minimum(one, other) * len(borders.names) + np.maximum(one, other)
    order = np.argsort(pairs)
    found, first = np.unique(pairs.take(order), return_index=True)
    least = np.minimum.reduceat(gaps.take(order), first) if len(first) else gaps
    a, b = (borders.names.take(side).tolist() for side in np.divmod(found, len(borders.names)))
    return {
        pair: gap
        for one, other, gap in zip(a, b, least.tolist(), strict=True)
        for pair in ((one, other), (other, one))
    }
