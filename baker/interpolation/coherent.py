"""Draw a cloud onto another one as a whole: a coherent, locally affine, annealed warp."""

from __future__ import annotations

import numpy as np

from baker.interpolation.spine import Points

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
    from baker.interpolation.drawing import mapped, maps, spread_out, terms
    from baker.interpolation.nearest import line, line_along, nearest_on

    middle = moving.mean(axis=0)
    here, there = moving - middle, end - middle
    size = float(np.sqrt((here**2).sum(axis=1).mean())) or 1.0
    centres = here[spread_out(here, CENTRES)]
    # What is fitted to some hundred points is not more accurate than a float32.
    ways = (here[:, axis] - centres[:, axis, None] for axis in range(3))
    squared = np.float32(sum(way**2 for way in ways))
    drawn, target = here, line(there)
    for width in WIDTHS:
        weights = np.exp(squared * np.float32(-0.5 / (width * size) ** 2)) + np.float32(1e-12)
        blend = (weights / weights.sum(axis=0)).T
        for _ in range(ROUNDS):
            now = line_along(drawn, target[0])
            ahead, back = nearest_on(now, target, np.inf), nearest_on(target, now, np.inf)
            sums = weights @ terms(here, there, ahead, back, DOUBTFUL)
            drawn = mapped(here, blend @ maps(sums, STIFFNESS * (width * size) ** 2))
    return drawn + middle
