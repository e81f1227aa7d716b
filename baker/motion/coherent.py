"""Draw a cloud onto another one as a whole: a coherent, locally affine, annealed warp."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.motion.spine import Points

CENTRES = 60
WIDTHS = (0.8, 0.6, 0.45, 0.35, 0.28, 0.22, 0.18, 0.15)  # of the kernel, in rms radii of the cloud
ROUNDS = 2  # at each width
STIFFNESS = 0.1  # share of the kernel's width squared that holds the maps back from stretching
DOUBTFUL = 3.0  # median distances from which a pair counts less than half


def draw(moving: Points, end: Points) -> Points:
    """(n, 3) where the moving points come to lie.

    In every round each point is paired with its nearest on the other side, both ways; around each
    of some centres the pairs' shifts are fitted by an affine map, the nearer the more they weigh;
    the maps are blended. The kernel narrows: first the whole is moved, then its parts.
    """
    from baker.motion.nearest import nearest

    middle = moving.mean(axis=0)
    here, there = moving - middle, end - middle
    centres = here[spread_out(here, CENTRES)]
    size = float(np.sqrt((here**2).sum(axis=1).mean())) or 1.0
    squared = ((here[None] - centres[:, None]) ** 2).sum(axis=2)
    drawn, everyone = here, np.arange(len(here))
    for width in WIDTHS:
        weights = np.exp(-0.5 * squared / (width * size) ** 2) + 1e-12
        blend = weights / weights.sum(axis=0)
        for _ in range(ROUNDS):
            ahead, partner = nearest(drawn, there)
            back, owner = nearest(there, drawn)
            rows = np.concatenate([everyone, owner])
            shift = np.concatenate([there[partner], there]) - here[rows]
            away = np.concatenate([ahead, back])
            trust = 1.0 / (1.0 + (away / (DOUBTFUL * np.median(away) + 1e-12 * size)) ** 2)
            slopes, offsets = _affine(here, rows, shift, trust, weights, width * size)
            local = (blend.T @ slopes.reshape(-1, 9)).reshape(-1, 3, 3)
            drawn = here + (here[:, None] @ local)[:, 0] + blend.T @ offsets
    return drawn + middle


def _affine(
    points: Points,
    rows: NDArray[np.intp],
    shift: Points,
    trust: NDArray[np.float64],
    weights: NDArray[np.float64],
    width: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Around each centre shift = point @ slope + offset, by weighted least squares.

    rows, shift, trust: (m,) each pair's point, by how much it should move, how much it counts;
    weights: (centres, n). Returns (centres, 3, 3) and (centres, 3).
    """
    count = len(points)
    mass, pull = np.bincount(rows, trust, count), np.empty((count, 3))
    for axis in range(3):
        pull[:, axis] = np.bincount(rows, trust * shift[:, axis], count)
    outer = points[:, :, None] * np.concatenate([mass[:, None] * points, pull], axis=1)[:, None]
    summed = weights @ np.concatenate(
        [mass[:, None], mass[:, None] * points, pull, outer.reshape(count, -1)], axis=1
    )
    total, first, moved = summed[:, 0], summed[:, 1:4], summed[:, 4:7]
    second, cross = np.split(summed[:, 7:].reshape(-1, 3, 6), 2, axis=2)
    mean, shifted = first / total[:, None], moved / total[:, None]
    second = second - np.einsum("ci,cj->cij", first, mean)
    cross = cross - np.einsum("ci,cj->cij", first, shifted)
    stiff = STIFFNESS * total[:, None, None] * width**2 * np.eye(3)
    slopes = np.linalg.solve(second + stiff, cross)
    return slopes, shifted - np.einsum("ci,cik->ck", mean, slopes)


def spread_out(points: Points, count: int) -> NDArray[np.intp]:
    """Indices of up to `count` points, each the farthest from those before."""
    chosen = [0]
    away = ((points - points[0]) ** 2).sum(axis=1)
    for _ in range(min(count, len(points)) - 1):
        farthest = int(np.argmax(away))
        if away[farthest] == 0:
            break
        chosen.append(farthest)
        away = np.minimum(away, ((points - points[farthest]) ** 2).sum(axis=1))
    return np.array(chosen)
