"""Match the hierarchies of two scans with inconsistent labels (section 3.3.1 of the paper).

The roots are matched first. A matched segment of the second scan is merged with its children as
long as this reduces the distance to its partner; then the remaining children are matched. Subtrees
of unmatched segments are born or lost.
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
    """Match the segment hierarchies of two scans from the roots down.

    points: (N, 3) and (M, 3). distance: of two segments, (n, 3) and (m, 3), in length units.
    report_matched: called with the number of segments of the second scan that are matched or
    merged. Returns the second hierarchy after merging, and the pairs of matched segments; all
    others are born or lost.
    """
    first, second = hierarchies
    groups: dict[int, list[int]] = {}  # matched segment -> itself and the segments merged into it

    def group_distance(source: int, group: Sequence[int]) -> float:
        report_matched(sum(map(len, groups.values())))
        target = np.concatenate([second.segments[s] for s in group])
        return distance(points[0][first.segments[source]], points[1][target])

    def children(hierarchy: Hierarchy, group: Sequence[int]) -> list[int]:
        """The children of a group that are not part of it and have points."""
        candidates = (child for segment in group for child in hierarchy.children(segment))
        return [c for c in candidates if c not in group and len(hierarchy.segments[c])]

    def merge(source: int, group: list[int]) -> None:
        """Merge children into the group as long as the distance falls, the best one first."""
        current = group_distance(source, group)
        while candidates := sorted(children(second, group)):  # of equal ones the first is merged
            distances = [group_distance(source, [*group, child]) for child in candidates]
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
            costs = np.array([[group_distance(p, [q]) for q in target] for p in source])
            queue += [(source[i], target[j]) for i, j in assign_by_minima(costs)]
    matched_or_merged = {segment for group in groups.values() for segment in group}
    unmatched = [[s] for s in range(len(second.segments)) if s not in matched_or_merged]
    merged = sorted([*groups.values(), *unmatched])
    index = {group[0]: number for number, group in enumerate(merged)}
    return second.merged(merged), [(a, index[b]) for a, b in matched]


def assign_by_minima(costs: NDArray[np.floating]) -> list[tuple[int, int]]:
    """Assign rows to columns of (n, m) costs, leaving out the surplus of the larger side first.

    Of the larger side, the ``|n - m|`` segments with the largest minimum cost stay unmatched
    (section 3.3.1 of the paper). Returns ``min(n, m)`` pairs, by row.
    """
    from scipy.optimize import linear_sum_assignment

    n, m = costs.shape
    rows = np.sort(np.argsort(costs.min(axis=1), kind="stable")[:m])
    columns = np.sort(np.argsort(costs.min(axis=0), kind="stable")[:n])
    i, j = linear_sum_assignment(costs[np.ix_(rows, columns)])
    return list(zip(rows[i].tolist(), columns[j].tolist(), strict=True))
