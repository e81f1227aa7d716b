"""What is transported in one interval: matched organs, new organs, and organs that are lost."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from baker.matching import Match
from baker.segmentation.hierarchy import NO_PARENT
from baker.transport.problem import Points

# docs/method.md, row 16: of the parent's and the new organ's points, from this many to that many.
ATTACHMENT_SHARE, ORGAN_SHARE = 0.01, 0.1
MIN_ATTACHMENT_POINTS, MAX_ATTACHMENT_POINTS = 3, 100
PAPER_MIN_ATTACHMENT_POINTS = 10
SAMPLE_RATIO = 10  # sampled points for each attachment point, to bound how far these are


@dataclass(frozen=True)
class Task:
    """One organ's transport through an interval."""

    event: Literal["match", "birth", "loss"]
    organ: int  # track id
    start: NDArray[np.intp]  # (n,) points of the first scan; of a new organ, where it is attached
    end: NDArray[np.intp]  # (m,) points of the second scan; none of a lost organ


def interval_tasks(
    points: tuple[Points, Points],
    match: Match,
    attachment_points: int | None = None,
    paper: bool = False,
) -> tuple[Task, ...]:
    """What is transported in an interval: matches, births and losses (section 3.3.1).

    Parameters
    ----------
    points : (N, 3) and (M, 3) float ndarray
        The two aligned scans.
    match : Match
    attachment_points : int, optional
        Points that a new organ unfolds from, l; by default 1 % of its parent's, from 10 to 100 (the
        paper's choice), or as few as 3 where the new organ itself has few: more would stretch far
        along the parent.
    paper : bool
        Choose as the paper does.

    Returns
    -------
    tuple of Task
        Every point of the first scan is in the start of a match or a loss, every point of the
        second in the end of one task.
    """
    first, second = match.first, match.second
    tasks = [
        Task("match", second.organs[b], first.segments[a], second.segments[b])
        for a, b in match.pairs
        if len(first.segments[a]) and len(second.segments[b])
    ]
    # A stem that meets a virtual, empty root has nothing to become, or to come from.
    emptied = [a for a, b in match.pairs if not len(second.segments[b])]
    filled = [b for a, b in match.pairs if not len(first.segments[a])]
    attachments: dict[tuple[int | None, int], NDArray[np.intp]] = {}
    for segment in (*match.births, *filled):
        if not len(second.segments[segment]):
            continue
        place = _attachment(match, segment)
        if place not in attachments:
            attachments[place] = _attachment_points(points, match, *place, attachment_points, paper)
        members = second.segments[segment]
        tasks.append(Task("birth", second.organs[segment], attachments[place], members))
    nothing = np.empty(0, np.intp)
    lost = (*match.losses, *emptied)
    tasks += [Task("loss", first.organs[s], first.segments[s], nothing) for s in lost]
    return tuple(task for task in tasks if len(task.start) or len(task.end))


def _attachment(match: Match, segment: int) -> tuple[int | None, int]:
    """Where a new segment grows: the first scan's segment, and the second's that is attached there.

    A whole new subtree grows from one place, on the nearest ancestor that both scans have; under an
    empty virtual root (None) from anywhere on the plant.
    """
    first, second = match.first, match.second
    top = segment
    ancestor = match.start_of(second.parents[top])
    while ancestor is None and second.parents[top] != NO_PARENT:
        top = second.parents[top]
        ancestor = match.start_of(second.parents[top])
    if ancestor is not None and not len(first.segments[ancestor]):
        ancestor = None
    return ancestor, top if len(second.segments[top]) else segment


def _attachment_points(
    points: tuple[Points, Points],
    match: Match,
    ancestor: int | None,
    top: int,
    count: int | None,
    paper: bool,
) -> NDArray[np.intp]:
    """The ancestor's points nearest to the new segment `top`; ties go to the lowest index."""
    from scipy.spatial import KDTree

    members = np.arange(len(points[0])) if ancestor is None else match.first.segments[ancestor]
    organ = match.second.segments[top]
    if not count:
        least = PAPER_MIN_ATTACHMENT_POINTS if paper else MIN_ATTACHMENT_POINTS
        most = MAX_ATTACHMENT_POINTS if paper else round(ORGAN_SHARE * len(organ))
        most = max(least, min(most, MAX_ATTACHMENT_POINTS))
        count = min(max(least, round(ATTACHMENT_SHARE * len(members))), most)
    tree = KDTree(points[1].take(organ, axis=0), balanced_tree=False)
    # Most points are farther than what a sample shows, and are not searched for.
    sample = members[:: max(1, len(members) // (SAMPLE_RATIO * count))]
    nearest = np.sort(tree.query(points[0].take(sample, axis=0))[0])[:count]
    bound = 1.000001 * float(nearest[-1]) or np.inf
    distances, _ = tree.query(points[0].take(members, axis=0), distance_upper_bound=bound)
    return members[np.argsort(distances, kind="stable")[:count]]
