"""Matching where labels are not consistent: down the hierarchies, by the paper (section 3.3.1).

Root meets root. Each new match is merged with children as long as that brings the two segments
nearer to each other, then the remaining children are matched; whole subtrees are born or lost.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from baker.matching.assignment import assign_by_minima, assign_with_dummies
from baker.matching.lazy import LazyCosts, least
from baker.matching.match import Match, Merge, from_pairs
from baker.segmentation.hierarchy import Hierarchy
from baker.transport.wasserstein import Moments

Distance = Callable[[NDArray[np.floating], NDArray[np.floating]], float]
Bound = Callable[[Moments, Sequence[Moments]], NDArray[np.floating]]


def _unbounded(one: Moments, others: Sequence[Moments]) -> NDArray[np.floating]:
    return np.zeros(len(others))


@dataclass(frozen=True)
class GreedyRules:
    """What the paper leaves open (rulings 11 and 14).

    merge_first: also merge segments of the first scan, whichever gains most; the paper merges in
                 the second scan only.
    least_gain:  share of the distance that a merge has to save.
    dummies:     children may stay unmatched on both sides at once, where a bud that unfolds and an
                 organ that goes come cheaper; else as many as the numbers differ, farthest first.
    """

    merge_first: bool = True
    least_gain: float = 0.001
    dummies: bool = True


PAPER = GreedyRules(merge_first=False, least_gain=0.0, dummies=False)


@dataclass
class _Side:
    """One scan while it is matched: its hierarchy and what has been merged so far."""

    points: NDArray[np.floating]
    hierarchy: Hierarchy
    groups: dict[int, list[int]] = field(default_factory=dict)
    moments: dict[int, Moments] = field(default_factory=dict)

    def cloud(self, group: list[int]) -> NDArray[np.floating]:
        return self.points[np.concatenate([self.hierarchy.segments[s] for s in group])]

    def moments_of(self, segment: int) -> Moments:
        if segment not in self.moments:
            self.moments[segment] = Moments.of(self.cloud([segment]))
        return self.moments[segment]

    def moments_of_group(self, group: list[int]) -> Moments:
        return sum((self.moments_of(s) for s in group[1:]), self.moments_of(group[0]))

    def children(self, head: int) -> list[int]:
        """Children of a merged segment that are not part of it; an empty one has no shape."""
        group = self.groups.get(head, [head])
        return [
            child
            for segment in group
            for child in self.hierarchy.children(segment)
            if child not in group and len(self.hierarchy.segments[child])
        ]

    def merged(self) -> tuple[Hierarchy, dict[int, int]]:
        """The merged hierarchy, and from a group's head to its number there."""
        inside = {segment for group in self.groups.values() for segment in group}
        alone = [[s] for s in range(len(self.hierarchy.segments)) if s not in inside]
        groups = sorted([*self.groups.values(), *alone], key=lambda group: group[0])
        return self.hierarchy.merged(groups), {g[0]: index for index, g in enumerate(groups)}


@dataclass(frozen=True)
class _Greedy:
    """Both scans, how their segments are compared, and the greedy choices that follow."""

    first: _Side
    second: _Side
    distance: Distance
    bound: Bound
    rules: GreedyRules

    def merge(self, a: int, b: int) -> list[Merge]:
        """Merge children into the matched segments, the largest gain first, while one gains."""
        merges: list[Merge] = []
        one, other = self.first.groups[a], self.second.groups[b]
        if not (len(self.first.cloud(one)) and len(self.second.cloud(other))):
            return merges
        current = self.distance(self.first.cloud(one), self.second.cloud(other))
        while True:
            trials = [(1, child) for child in self.second.children(b)]
            if self.rules.merge_first:
                trials += [(0, child) for child in self.first.children(a)]
            trials.sort()  # the lowest of those tied

            def joined(trial: int, trials: list[tuple[int, int]] = trials) -> float:
                side, child = trials[trial]
                return self.distance(
                    self.first.cloud(one if side else [*one, child]),
                    self.second.cloud([*other, child] if side else other),
                )

            found = least(
                self._bounds(one, other, trials),
                joined,
                limit=current * (1.0 - self.rules.least_gain),
            )
            if found is None:
                return merges
            best, (side, child) = found[0], trials[found[1]]
            (other if side else one).append(child)
            merges.append(Merge(side, b if side else a, child, current, best))
            current = best

    def _bounds(
        self, one: list[int], other: list[int], trials: Sequence[tuple[int, int]]
    ) -> NDArray[np.floating]:
        """What two merged segments' distances are at least with one more child in either."""
        own, its = self.first.moments_of_group(one), self.second.moments_of_group(other)
        found = np.zeros(len(trials))
        for side, whole, across, scan in ((1, its, own, self.second), (0, own, its, self.first)):
            chosen = [k for k, trial in enumerate(trials) if trial[0] == side]
            if chosen:
                joined = [whole + scan.moments_of(trials[k][1]) for k in chosen]
                found[chosen] = self.bound(across, joined)
        return found

    def match_children(self, a: int, b: int) -> list[tuple[int, int]]:
        """Pairs of the children of two matched segments."""
        first, second = self.first, self.second
        ours, theirs = first.children(a), second.children(b)
        if not ours or not theirs:
            return []
        moments = [second.moments_of(q) for q in theirs]
        costs = LazyCosts(
            np.array([self.bound(first.moments_of(p), moments) for p in ours]),
            lambda i, j: self.distance(first.cloud([ours[i]]), second.cloud([theirs[j]])),
        )
        if self.rules.dummies:
            pairs = assign_with_dummies(
                costs.all(),
                np.array([_to_bud(first, p, first.cloud(first.groups[a])) for p in ours]),
                np.array([_to_bud(second, q, second.cloud(second.groups[b])) for q in theirs]),
            )
        else:
            pairs = assign_by_minima(costs)
        return [(ours[i], theirs[j]) for i, j in pairs]


def match_greedily(
    points: tuple[NDArray[np.floating], NDArray[np.floating]],
    hierarchies: tuple[Hierarchy, Hierarchy],
    distance: Distance,
    rules: GreedyRules,
    bound: Bound = _unbounded,
    done: Callable[[int], None] = lambda segments: None,
) -> Match:
    """Match two scans' hierarchies from the roots on.

    distance: d_w of two clouds (n, 3) and (m, 3), in length units.
    bound:    what it is at least, by the clouds' moments: few distances are then worked out, and
              the match is the same.
    done:     called after each distance, with how many of the second scan's segments are matched
              or merged so far.
    """

    def measured(one: NDArray[np.floating], other: NDArray[np.floating]) -> float:
        done(sum(map(len, second.groups.values())))
        return distance(one, other)

    first, second = (_Side(p, h) for p, h in zip(points, hierarchies, strict=True))
    greedy = _Greedy(first, second, measured, bound, rules)
    queue = [(first.hierarchy.root, second.hierarchy.root)]
    matched, merges = [], []
    while queue:
        a, b = queue.pop(0)
        matched.append((a, b))
        first.groups[a], second.groups[b] = [a], [b]
        merges += greedy.merge(a, b)
        queue += greedy.match_children(a, b)
    merged_first, number_first = first.merged()
    merged_second, number_second = second.merged()
    pairs = [(number_first[a], number_second[b]) for a, b in matched]
    return from_pairs(merged_first, merged_second, pairs, tuple(merges))


def _to_bud(side: _Side, segment: int, parent: NDArray[np.floating]) -> float:
    """d_w of a segment from its bud: all its mass at the point of it nearest to its parent."""
    from scipy.spatial import cKDTree

    cloud = side.cloud([segment])
    bud = cloud.mean(axis=0)
    if len(parent):
        bud = cloud[np.argmin(cKDTree(parent).query(cloud)[0])]
    return float(np.sqrt(((cloud - bud) ** 2).sum(axis=1).mean()))
