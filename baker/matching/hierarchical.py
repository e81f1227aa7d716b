"""Matching down the hierarchies where labels are not consistent (paper section 3.3.1).

The roots are matched. Each matched pair is merged with children for as long as that brings the two
segments nearer to each other; then the remaining children are matched. Whole subtrees are born or
lost.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from baker.matching.descriptors import size_from_parent
from baker.segmentation.hierarchy import Hierarchy

Points = NDArray[np.floating]
Distance = Callable[[Points, Points], float]


@dataclass(frozen=True)
class GreedyRules:
    """What the paper leaves open (docs/method.md, rows 11 and 14)."""

    merge_first: bool = True  # merge in the first scan too; the paper merges in the second only
    min_gain: float = 0.001  # share of the distance that a merge has to save
    dummies: bool = True  # children of both sides may stay unmatched; else only a side's surplus


PAPER = GreedyRules(merge_first=False, min_gain=0.0, dummies=False)


def match_hierarchies(
    points: tuple[Points, Points],
    hierarchies: tuple[Hierarchy, Hierarchy],
    distance: Distance,
    rules: GreedyRules,
    report_matched: Callable[[int], None] = lambda segments: None,
) -> tuple[Hierarchy, Hierarchy, list[tuple[int, int]]]:
    """Match the segment hierarchies of two scans from the roots on.

    points: (N, 3) of both scans, aligned; distance: of two segments, (n, 3) and (m, 3), in length
    units; report_matched: called before each distance with how many segments of the second scan are
    matched or merged. Returns both hierarchies after merging, and the pairs of matched segments of
    these; all others are born or lost.
    """

    def measured(source: Points, target: Points) -> float:
        report_matched(sum(map(len, second.groups.values())))
        return distance(source, target)

    first, second = (_Scan(p, h) for p, h in zip(points, hierarchies, strict=True))
    descent = _Descent(first, second, measured, rules)
    queue = [(first.hierarchy.root, second.hierarchy.root)]
    matched = []
    while queue:
        a, b = queue.pop(0)
        matched.append((a, b))
        first.groups[a], second.groups[b] = [a], [b]
        descent.merge(a, b)
        queue += descent.match_children(a, b)
    merged_first, first_index = first.merged()
    merged_second, second_index = second.merged()
    pairs = [(first_index[a], second_index[b]) for a, b in matched]
    return merged_first, merged_second, pairs


@dataclass
class _Scan:
    """A scan while it is matched: its hierarchy and what has been merged into each segment."""

    points: Points
    hierarchy: Hierarchy
    groups: dict[int, list[int]] = field(default_factory=dict)

    def cloud(self, group: list[int]) -> Points:
        return self.points[np.concatenate([self.hierarchy.segments[s] for s in group])]

    def children(self, head: int) -> list[int]:
        """Children of a merged segment that are not part of it; an empty one has no shape."""
        group = self.groups.get(head, [head])
        return [
            child
            for segment in group
            for child in self.hierarchy.children(segment)
            if child not in group and len(self.hierarchy.segments[child])
        ]

    def sizes(self, head: int, children: list[int]) -> NDArray[np.float64]:
        """Wasserstein distance of each child from its own attachment point on a merged segment."""
        from scipy.spatial import KDTree

        parent = self.cloud(self.groups[head])
        tree = KDTree(parent) if len(parent) else None
        return np.array([size_from_parent(self.cloud([child]), tree) for child in children])

    def merged(self) -> tuple[Hierarchy, dict[int, int]]:
        """The merged hierarchy, and the index in it of each group's head."""
        inside = {segment for group in self.groups.values() for segment in group}
        alone = [[s] for s in range(len(self.hierarchy.segments)) if s not in inside]
        groups = sorted([*self.groups.values(), *alone], key=lambda group: group[0])
        return self.hierarchy.merged(groups), {g[0]: index for index, g in enumerate(groups)}


@dataclass(frozen=True)
class _Descent:
    """The greedy choices: what is merged into a matched pair, and which children match."""

    first: _Scan
    second: _Scan
    distance: Distance
    rules: GreedyRules

    def merge(self, a: int, b: int) -> None:
        """Merge children into the matched segments, the largest gain first, while one gains."""
        source, target = self.first.groups[a], self.second.groups[b]
        if not (len(self.first.cloud(source)) and len(self.second.cloud(target))):
            return
        current = self.distance(self.first.cloud(source), self.second.cloud(target))
        while True:
            trials = [(1, child) for child in self.second.children(b)]
            if self.rules.merge_first:
                trials += [(0, child) for child in self.first.children(a)]
            trials.sort()  # ties go to the lowest
            distances = [
                self.distance(
                    self.first.cloud(source if side else [*source, child]),
                    self.second.cloud([*target, child] if side else target),
                )
                for side, child in trials
            ]
            nearest = min(distances, default=np.inf)
            if not nearest < current * (1.0 - self.rules.min_gain):
                return
            side, child = trials[distances.index(nearest)]
            (target if side else source).append(child)
            current = nearest

    def match_children(self, a: int, b: int) -> list[tuple[int, int]]:
        """Pairs of the children of two matched segments."""
        first, second = self.first, self.second
        source, target = first.children(a), second.children(b)
        if not source or not target:
            return []
        costs = np.array(
            [[self.distance(first.cloud([p]), second.cloud([q])) for q in target] for p in source]
        )
        if self.rules.dummies:
            pairs = assign_with_dummies(costs, first.sizes(a, source), second.sizes(b, target))
        else:
            pairs = assign_by_minima(costs)
        return [(source[i], target[j]) for i, j in pairs]


def assign_with_dummies(
    costs: NDArray[np.floating], loss: NDArray[np.floating], birth: NDArray[np.floating]
) -> list[tuple[int, int]]:
    """Assign rows to columns at the least total cost, with a dummy partner for each of them.

    costs: (n, m) of matching a row to a column; loss, birth: (n,) and (m,) of leaving a row or a
    column unmatched. Returns the matched pairs, by row.
    """
    from scipy.optimize import linear_sum_assignment

    n, m = costs.shape
    forbidden = 1.0 + 2.0 * float(costs.sum() + loss.sum() + birth.sum())
    lost, born = (np.where(np.eye(len(c), dtype=bool), c, forbidden) for c in (loss, birth))
    padded = np.block([[costs, lost], [born, np.zeros((m, n))]])
    rows, columns = linear_sum_assignment(padded)
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if i < n and j < m]


def assign_by_minima(costs: NDArray[np.floating]) -> list[tuple[int, int]]:
    """Assign as the paper does: the surplus of the larger side is left out first (section 3.3.1).

    Of the larger side, the ``|n - m|`` segments whose nearest partner is farthest stay unmatched.
    Returns ``min(n, m)`` pairs, by row.
    """
    from scipy.optimize import linear_sum_assignment

    n, m = costs.shape
    rows, columns = np.arange(n), np.arange(m)
    if n > m:
        rows = np.sort(np.argsort(costs.min(axis=1), kind="stable")[:m])
    elif m > n:
        columns = np.sort(np.argsort(costs.min(axis=0), kind="stable")[:n])
    i, j = linear_sum_assignment(costs[np.ix_(rows, columns)])
    return list(zip(rows[i].tolist(), columns[j].tolist(), strict=True))
