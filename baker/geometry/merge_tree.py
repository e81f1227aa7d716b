"""The loop over a graph from its tips down, compiled by numba: import this module late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.geometry.compiled import compiled

Ints = NDArray[np.integer]


@compiled
def branches(
    height: NDArray[np.floating],
    order: Ints,
    first: Ints,
    near: Ints,
    longest: float,
    share: float,
    fewest: int,
) -> Ints:
    """(n,) the branch that each point of a graph lies on, numbered from 0; -1 below the forks.

    height: (n,) how far each point is from the foot; order: (n,) the points, the highest first.
    first, near: the neighbours of point v are near[first[v] : first[v + 1]].
    longest, fewest: what is shorter, or has fewer points, where it meets another one is a bump on
           it. So is what is shorter than `share` of another one that has met none so far.

    From the tips down the points that are connected above some height are the branches there, the
    superlevel sets of a merge tree. Where two of them meet both end.
    """
    count = len(height)
    parent = np.full(count, -1)  # a component's root is its highest point
    size = np.ones(count, np.int64)
    forked = np.zeros(count, np.bool_)
    following, last = np.full(count, -1), np.arange(count)  # the members of each component
    branch, found = np.full(count, -1), 0
    for point in order:
        parent[point] = point
        for other in near[first[point] : first[point + 1]]:
            if parent[other] < 0:
                continue
            elder, younger = _root(parent, point), _root(parent, other)
            if elder == younger:
                continue
            if height[elder] < height[younger]:
                elder, younger = younger, elder
            length, above = height[younger] - height[point], height[elder] - height[point]
            long = length >= longest and size[younger] >= fewest
            if forked[elder]:
                fork = long or forked[younger]
            else:
                fork = forked[younger] or (long and length >= share * above)
            if fork:
                for one in (elder, younger):
                    if not forked[one]:
                        member = one
                        while member >= 0:
                            branch[member] = found
                            member = following[member]
                        found += 1
                forked[elder] = True
            parent[younger] = elder
            size[elder] += size[younger]
            following[last[elder]] = younger
            last[elder] = last[younger]
    return branch


@compiled
def _root(parent: Ints, point: int) -> int:
    while parent[point] != point:
        parent[point] = parent[parent[point]]
        point = parent[point]
    return point
