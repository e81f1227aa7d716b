"""An interval's organs and segments under numbers of its own.

Who is numbered how in the series depends on all scans. Without that a cache finds an interval again
although organs of other intervals are matched otherwise.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.interval_job import IntervalJob, IntervalSolver
from baker.matching import IntervalOrgans, match_from_pairs
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy
from gclip import Interval

Numbers = NDArray[np.intp]


def solve_under_own_numbers(
    jobs: Sequence[IntervalJob], solve: IntervalSolver, progress: Callable[[int, int], None]
) -> tuple[Interval, ...]:
    """Solve intervals that know nothing of the series' numbers, and number their organs as it does.

    Parameters
    ----------
    jobs : sequence of IntervalJob
    solve : IntervalSolver
    progress : callable
        Called with the intervals solved and the intervals in all.
    """
    own_jobs, organs_of = zip(*map(with_own_numbers, jobs), strict=True)
    return tuple(map(renumbered, solve(own_jobs, progress), organs_of))


def with_own_numbers(job: IntervalJob) -> tuple[IntervalJob, Numbers]:
    """Number segments by their first points, and organs by their segments, the first scan's first.

    Returns
    -------
    job : IntervalJob
        The same work.
    organs : (n,) intp ndarray
        The organ of the series by its number there.
    """
    (first, a_of), (second, b_of) = map(_by_first_point, (job.match.first, job.match.second))
    sides = [
        {int(place[segment]): organ for segment, organ in side.items()}
        for side, place in ((job.organs.first, a_of), (job.organs.second, b_of))
    ]
    organs = [side[segment] for side in sides for segment in sorted(side)]
    number = {organ: own for own, organ in enumerate(dict.fromkeys(organs))}

    def numbered(values: Mapping[int, Any]) -> dict[int, Any]:
        known = (organ for organ in number if organ in values)
        return {number[organ]: values[organ] for organ in known}

    tasks = [replace(task, organ=number[task.organ]) for task in job.tasks]
    names = [{segment: number[side[segment]] for segment in sorted(side)} for side in sides]
    pairs = [(int(a_of[a]), int(b_of[b])) for a, b in job.match.pairs]
    own = replace(
        job,
        match=match_from_pairs(first, second, pairs),
        organs=IntervalOrgans(*names),
        tasks=tuple(sorted(tasks, key=lambda task: (task.event, task.organ))),
        timings=numbered(job.timings),
        decays=numbered(job.decays),
        attachments=(numbered(job.attachments[0]), numbered(job.attachments[1])),
    )
    return own, np.array(list(number))


def renumbered(interval: Interval, organs: Numbers) -> Interval:
    """The interval with the organ of the series for each number of its own."""
    kind = np.uint16 if organs.max() < 2**16 else np.uint32
    return replace(
        interval,
        tracks=organs.astype(kind)[interval.tracks],
        segments=tuple(replace(one, track=int(organs[one.track])) for one in interval.segments),
    )


def _by_first_point(hierarchy: Hierarchy) -> tuple[Hierarchy, Numbers]:
    """The hierarchy with its segments by their first points, and each one's place there."""
    count = len(hierarchy.segments)
    order = sorted(range(count), key=lambda s: (*hierarchy.segments[s][:1].tolist(), np.inf)[0])
    place = np.argsort(order)
    parents = (hierarchy.parents[segment] for segment in order)
    numbered = Hierarchy(
        segments=tuple(hierarchy.segments[segment] for segment in order),
        labels=(None,) * count,
        parents=tuple(p if p == NO_PARENT else int(place[p]) for p in parents),
        root=int(place[hierarchy.root]),
    )
    return numbered, place
