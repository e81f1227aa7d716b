"""Matching down the hierarchies where labels are not consistent (paper section 3.3.1).

The roots are matched. Each segment of the second scan that is matched is merged with children for
as long as that brings it nearer to its partner; then the remaining children are matched. Whole
subtrees are born or lost.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.hierarchy import Hierarchy

Points = NDArray[np.floating]
Distance = Callable[[Points, Points], float]


def match_hierarchies(
    points: tuple[Points, Points],
    hierarchies: tuple[Hierarchy, Hierarchy],
    distance: Distance,
    report_matched: Callable[[int], None] = lambda segments: None,
) -> tuple[Hierarchy, list[tuple[int, int]]]:
    """Match the segment hierarchies of two scans from the roots on.

    points: (N, 3) of both scans, aligned; distance: of two segments, (n, 3) and (m, 3), in length
    units; report_matched: called before each distance with how many segments of the second scan are
    matched or merged. Returns the second hierarchy after merging, and the pairs of matched segments
    of the first one and of that; all others are born or lost.
    """
    first, second = hierarchies
    groups: dict[int, list[int]] = {}  # what is merged into each matched segment, itself first

    def measured(source: int, group: Sequence[int]) -> float:
        report_matched(sum(map(len, groups.values())))
        target = np.concatenate([second.segments[s] for s in group])
        return distance(points[0][first.segments[source]], points[1][target])

    def children(hierarchy: Hierarchy, group: Sequence[int]) -> list[int]:
        """Those that are not part of the group; an empty one has no shape."""
        found = (child for segment in group for child in hierarchy.children(segment))
        return [c for c in found if c not in group and len(hierarchy.segments[c])]

    def merge(source: int, group: list[int]) -> None:
        """Merge children into the group, the largest gain first, while one gains."""
        current = measured(source, group)
        while candidates := sorted(children(second, group)):  # ties go to the lowest
            distances = [measured(source, [*group, child]) for child in candidates]
            nearest = min(distances)
            if not nearest < current:
                return
            group.append(candidates[distances.index(nearest)])
            current = nearest

    queue, matched = [(first.root, second.root)], []
    while queue:
        a, b = queue.pop(0)
        matched.append((a, b))
        groups[b] = [b]
        if len(first.segments[a]) and len(second.segments[b]):
            merge(a, groups[b])
        source, target = children(first, [a]), children(second, groups[b])
        if source and target:
            costs = np.array([[measured(p, [q]) for q in target] for p in source])
            queue += [(source[i], target[j]) for i, j in assign_by_minima(costs)]
    inside = {segment for group in groups.values() for segment in group}
    alone = [[s] for s in range(len(second.segments)) if s not in inside]
    merged = sorted([*groups.values(), *alone])
    index = {group[0]: number for number, group in enumerate(merged)}
    return second.merged(merged), [(a, index[b]) for a, b in matched]


def assign_by_minima(costs: NDArray[np.floating]) -> list[tuple[int, int]]:
    """Assign as the paper does: the surplus of the larger side is left out first (section 3.3.1).

    Of the larger side, the ``|n - m|`` segments whose nearest partner is farthest stay unmatched.
    Returns ``min(n, m)`` pairs, by row.
    """
    from scipy.optimize import linear_sum_assignment

    n, m = costs.shape
    rows = np.sort(np.argsort(costs.min(axis=1), kind="stable")[:m])
    columns = np.sort(np.argsort(costs.min(axis=0), kind="stable")[:n])
    i, j = linear_sum_assignment(costs[np.ix_(rows, columns)])
    return list(zip(rows[i].tolist(), columns[j].tolist(), strict=True))
