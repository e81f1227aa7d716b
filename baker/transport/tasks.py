"""The transport tasks of one interval: matched, new and lost organs."""

from dataclasses import dataclass
from functools import cache, partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from baker.matching.match import Match
from baker.transport.problem import Points

# Number of points from which a new organ unfolds (docs/method.md, row 16).
ATTACHMENT_SHARE, ORGAN_SHARE = 0.01, 0.1  # of the parent's points; greatest, of the organ's
MIN_ATTACHMENT_POINTS, MAX_ATTACHMENT_POINTS = 3, 100  # limits of that number
PAPER_MIN_ATTACHMENT_POINTS = 10  # its lower limit with `paper`
SAMPLE_RATIO = 10  # points sampled for each attachment point, to bound the search for these


@dataclass(frozen=True)
class Task:
    """The transport of one organ in an interval."""

    event: Literal["match", "birth", "loss"]
    organ: int  # track id
    start: NDArray[np.intp]  # (n,) points of the first scan; of a new organ, of its parent
    end: NDArray[np.intp]  # (m,) points of the second scan; empty for a lost organ
    # Of a new organ without `start`: the track id of its parent, and (l,) points of that in the
    # second scan. The organ unfolds from where the movers start that end there.
    origin: tuple[int, NDArray[np.intp]] | None = None
    shares_start: bool = False  # whether the points of `start` are in the start of another task

    @property
    def size(self) -> int:
        """The number of points in both scans."""
        return len(self.start) + len(self.end)


def interval_tasks(
    points: tuple[Points, Points],
    match: Match,
    attachment_points: int | None = None,
    paper: bool = False,
) -> tuple[Task, ...]:
    """Make the tasks of an interval: matches, births and losses (section 3.3.1).

    points: (N, 3) and (M, 3) points of the two aligned scans. attachment_points: the paper's l, the
    number of points from which a new organ unfolds; by default 1 % of the parent's points, from 3
    to 100, but at most a tenth of the organ's. paper: whether it is by default 1 % of the parent's
    points, from 10 to 100, and always those nearest to the organ in the first scan, as in the
    paper. Each point of the first scan is in the start of one task that does not share it, each
    point of the second in the end of one task.
    """
    starts, ends, organs = match.first.segments, match.second.segments, match.second.organs
    # A stem that is matched with a virtual, empty root is lost, or born.
    matched = {b: a for a, b in match.pairs if len(starts[a]) and len(ends[b])}
    born = [*match.births, *(b for a, b in match.pairs if not len(starts[a]))]
    born = [b for b in born if b not in matched]
    lost = [*match.losses, *(a for a, b in match.pairs if not len(ends[b]))]
    tasks = [
        Task("birth" if b in match.births else "match", organs[b], starts[a], ends[b])
        for b, a in matched.items()
    ]
    attach = cache(partial(_attachment_points, points, match, attachment_points, paper))
    for b in (b for b in born if len(ends[b])):
        ancestor, top = _attachment(match, b)
        start, origin, parent = np.arange(0), None, match.second.parents[top]
        if paper or parent not in matched:
            start = attach(0, ancestor, top)
        else:
            origin = organs[parent], attach(1, parent, top)
        tasks.append(Task("birth", organs[b], start, ends[b], origin, True))
    tasks += [Task("loss", match.first.organs[a], starts[a], np.arange(0)) for a in lost]
    return tuple(task for task in tasks if task.size)


def _attachment(match: Match, segment: int) -> tuple[int | None, int]:
    """The segment of the first scan from which a new segment grows, and the root of its subtree.

    A new subtree grows from its nearest ancestor in the first scan, or from any point of the plant
    (None) if that is a virtual root.
    """
    lineage = [segment, *match.second.ancestors(segment)]
    start_of = {b: a for a, b in match.pairs}
    starts = [start_of.get(match.second.parents[ancestor]) for ancestor in lineage]
    depth = next((k for k, start in enumerate(starts) if start is not None), -1)
    start, top = starts[depth], lineage[depth]
    if start is not None and not len(match.first.segments[start]):
        start = None
    return start, top if len(match.second.segments[top]) else segment


def _attachment_points(
    points: tuple[Points, Points],
    match: Match,
    count: int | None,
    paper: bool,
    scan: int,
    ancestor: int | None,
    top: int,
) -> NDArray[np.intp]:
    """The points of the segment `ancestor` of scan 0 or 1 that are nearest to the new segment."""
    from scipy.spatial import cKDTree

    cloud, hierarchy = points[scan], (match.first, match.second)[scan]
    members = np.arange(len(cloud)) if ancestor is None else hierarchy.segments[ancestor]
    organ = match.second.segments[top]
    if not count:
        least, share = PAPER_MIN_ATTACHMENT_POINTS, ATTACHMENT_SHARE * len(members)
        if not paper:
            least, share = MIN_ATTACHMENT_POINTS, min(share, ORGAN_SHARE * len(organ))
        count = max(least, round(min(share, MAX_ATTACHMENT_POINTS)))
    tree = cKDTree(points[1].take(organ, axis=0), balanced_tree=False)
    # A sample gives an upper bound of the distances, which makes the query faster.
    sample = members[:: max(1, len(members) // (SAMPLE_RATIO * count))]
    nearest = np.sort(tree.query(cloud.take(sample, axis=0))[0])[:count]
    bound = 1.000001 * float(nearest[-1]) or np.inf
    distances, _ = tree.query(cloud.take(members, axis=0), distance_upper_bound=bound)
    return members[np.argsort(distances, kind="stable")[:count]]
