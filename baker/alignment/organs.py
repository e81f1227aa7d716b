"""A plant's organs as far as an alignment needs them: what stands out from the way to the base.

Points turn, bend and multiply as an organ grows; the direction in which the organ as a whole points
from the stem is steadier. No labels are needed, and no exact borders.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.sample_graph import way_graph
from baker.geometry.sampling import EvenSample

STANDS_OUT = 0.1  # of the plant's longest way: shorter tips are no organs of their own
FEWEST = 4  # points of an organ that is seen
AXIS = -1


@dataclass(frozen=True)
class Organs:
    """The organs of an even sample that has z up and the stem's base at the origin.

    numbers:  (n,) of each of the sample's points, `AXIS` on what bears the organs.
    centers:  (k, 3) the middles of the organs that have four points or more.
    """

    numbers: NDArray[np.intp]
    centers: NDArray[np.float64]


def find_organs(sample: EvenSample, pairs: NDArray[np.intp]) -> Organs:
    """Organs are what is left of the plant where the ways from its tips have not yet met.

    pairs: (E, 2) of the sample's points that touch, see `touching_pairs`.
    """
    from scipy.sparse.csgraph import dijkstra

    if len(sample.points) < 2:
        return Organs(np.full(len(sample.points), AXIS), np.zeros((0, 3)))
    lengths = np.linalg.norm(sample.points[pairs[:, 0]] - sample.points[pairs[:, 1]], axis=1)
    graph = way_graph(pairs, lengths, len(sample.points))
    base = int(np.argmin((sample.points**2).sum(axis=1)))
    way = dijkstra(graph, indices=base)
    neighbors = np.split(graph.indices, graph.indptr[1:-1])
    numbers = peaks_apart(way, neighbors, STANDS_OUT * float(way.max()))
    members = (np.flatnonzero(numbers == number) for number in range(numbers.max() + 1))
    centers = [sample.points[of].mean(axis=0) for of in members if len(of) >= FEWEST]
    return Organs(numbers, np.array(centers).reshape(-1, 3))


def peaks_apart(
    heights: NDArray[np.float64], neighbors: Sequence[NDArray[np.integer]], least: float
) -> NDArray[np.intp]:
    """(n,) number of the peak whose slope each point of a landscape is on, `AXIS` below all passes.

    The landscape is flooded backwards, from its peaks down. Where two slopes meet, both are
    complete, if either's peak rises by `least` above the pass; a lesser one is part of the other.
    (Persistence: Edelsbrunner et al. 2002.)
    """
    at = np.full(len(heights), -1)  # the slope a point is on; slopes that merged refer onwards
    onto: list[int] = []
    peaks: list[float] = []
    members: list[list[int]] = []
    joined: list[bool] = []
    organs: list[list[int]] = []

    def slope(point: int) -> int:
        found = int(at[point])
        while onto[found] != found:
            onto[found] = onto[onto[found]]
            found = onto[found]
        return found

    for point in np.argsort(-heights, kind="stable"):
        height = float(heights[point])
        slopes = {slope(near) for near in neighbors[point] if at[near] >= 0}
        if not slopes:
            at[point] = len(onto)
            onto.append(len(onto))
            peaks.append(height)
            members.append([int(point)])
            joined.append(False)
            continue
        first, *others = sorted(slopes, key=lambda each: (-peaks[each], each))
        standing = [each for each in slopes if joined[each] or peaks[each] - height >= least]
        if len(standing) > 1:
            organs += [members[each] for each in sorted(standing) if not joined[each]]
            for each in standing:
                joined[each], members[each] = True, []
        joined[first] = any(joined[each] for each in slopes)
        for each in others:
            onto[each] = first
            members[first] += members[each]
        members[first].append(int(point))
        at[point] = first
    organs += [
        members[each] for each in range(len(onto)) if onto[each] == each and not joined[each]
    ]
    numbers = np.full(len(heights), AXIS)
    for number, of in enumerate(organs):
        numbers[of] = number
    return numbers
