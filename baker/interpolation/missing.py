"""Parts of organs that a later scan lacks: cut off, or hidden from the scanner for a while.

Transport would draw what is left over the whole organ: it would shrink, and grow again when the
part comes back (the limitations of the paper, section 5). An organ that lost a part is what
it was, laid back on itself; the part is what lies bare then.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gclip.clip import Motion

SAMPLE = 1500  # points of an organ that are laid on each other
ROUNDS, KEPT = 30, 0.9  # of laying on: steps, and the share of points that count in each
FEWEST = 40  # points below which an organ says too little
LEAST = 0.12  # share of its surface that must be gone
GONE = 0.6  # of the bare surface, how much the organ must have lost altogether
BARE = 0.08  # how far a bare point is from what is left, as a share of the organ's extent


@dataclass(frozen=True)
class Rest:
    """What is left of an organ, laid back on what it was.

    missing:  (n,) mask of the points that lie bare.
    rotation: (3, 3), shift: (3,): a point p of what it was goes to rotation @ p + shift.
    """

    missing: NDArray[np.bool_]
    rotation: NDArray[np.float64]
    shift: NDArray[np.float64]


@dataclass(frozen=True)
class Part:
    """What an organ loses in an interval.

    points: (n,) indices into the first scan; leaves: how they go; note: for the report.
    """

    organ: int
    points: NDArray[np.intp]
    leaves: Motion
    note: str


def missing_part(
    before: NDArray[np.floating],
    after: NDArray[np.floating],
    surface_before: NDArray[np.floating],
    surface_after: NDArray[np.floating],
    bases: Callable[[], tuple[NDArray[np.floating], NDArray[np.floating]]],
) -> Rest | None:
    """The part of an organ that is missing later, or None where it is all there.

    before, after: (n, 3) and (m, 3), the organ in two scans; surface_…: what each point stands for;
    bases: where it is attached in both, (3,) each; asked for only where surface is missing.
    """
    from scipy.spatial import cKDTree

    whole, left = float(surface_before.sum()), float(surface_after.sum())
    if min(len(before), len(after)) < FEWEST or left > (1 - GONE * LEAST) * whole:
        return None
    base_before, base_after = bases()
    a, b = before[:: -(-len(before) // SAMPLE)], after[:: -(-len(after) // SAMPLE)]
    rotation, shift, apart = _laid_on(b, a, base_after, base_before)
    extent = float(np.sqrt(((before - base_before) ** 2).sum(axis=1).mean()))
    reach = cKDTree(a).query(a, k=[min(9, len(a))])[0]
    near = max(BARE * extent, 2 * float(np.median(reach)))
    if np.quantile(apart, 0.9) > near:
        return None  # it has changed its shape: what is bare says nothing
    back = after @ rotation.T + shift
    bare = _largest_part(before, cKDTree(back).query(before)[0] > near)
    share = float(surface_before[bare].sum()) / whole
    if share < LEAST or whole - left < GONE * share * whole:
        return None
    return Rest(bare, rotation.T, -rotation.T @ shift)


def _laid_on(
    moving: NDArray[np.floating],
    fixed: NDArray[np.floating],
    base: NDArray[np.floating],
    onto: NDArray[np.floating],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Rotation and shift that lay one cloud on part of another, and how far its points then are.

    One-way, trimmed iterated closest points, from base on base (Chetverikov et al. 2002).
    """
    from scipy.spatial import cKDTree

    tree = cKDTree(fixed)
    rotation, shift = np.eye(3), onto - base
    for _ in range(ROUNDS):
        laid = moving @ rotation.T + shift
        apart, near = tree.query(laid)
        kept = apart <= np.quantile(apart, KEPT)
        a, b = moving[kept], fixed[near[kept]]
        center, target = a.mean(axis=0), b.mean(axis=0)
        u, _, vt = np.linalg.svd((a - center).T @ (b - target))
        rotation = vt.T @ np.diag([1, 1, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
        shift = target - rotation @ center
    return rotation, shift, tree.query(moving @ rotation.T + shift)[0]


def _largest_part(points: NDArray[np.floating], mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The mask's largest connected part."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    inside = np.flatnonzero(mask)
    if len(inside) < FEWEST // 4:
        return np.zeros_like(mask)
    k = min(9, len(inside))
    near = cKDTree(points[inside]).query(points[inside], k=k)[1].reshape(len(inside), k)
    rows = np.repeat(np.arange(len(inside)), k)
    graph = coo_matrix((np.ones(near.size), (rows, near.ravel())), (len(inside),) * 2)
    part = connected_components(graph, directed=False)[1]
    largest = np.zeros_like(mask)
    largest[inside[part == np.bincount(part).argmax()]] = True
    return largest
