"""All intervals of a series, solved one by one wherever an executor runs them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from baker.executor import Executor
from baker.interval import Moved
from baker.job import IntervalJob, move_interval, packed_interval, solve_interval
from baker.through import smooth_through
from gclip.clip import Interval


def solve_intervals(
    jobs: Sequence[IntervalJob],
    executor: Executor,
    smooth: bool,
    tell: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[Interval, ...]:
    """The jobs' intervals, in their order; the same whatever the executor.

    jobs:   of successive intervals, all of them.
    smooth: whether paths keep their speed across scans (`--paths smooth`): then an interval also
            depends on the movers of its two neighbours.
    tell:   called with the tasks done and the tasks in all.
    """
    total, finished = sum(map(len, jobs)), 0

    def done(steps: int) -> None:
        nonlocal finished
        finished += steps
        tell(finished, total)

    tell(0, total)
    if not smooth:
        intervals = dict(executor.run(solve_interval, jobs, done))
        return tuple(intervals[k] for k in range(len(jobs)))
    moved: dict[int, list[Moved]] = dict(executor.run(move_interval, jobs, done))
    keyframes = [job.start for job in jobs] + [job.end for job in jobs[-1:]]
    times = [job.times[0] for job in jobs] + [job.times[1] for job in jobs[-1:]]
    through = smooth_through([moved[k] for k in range(len(jobs))], keyframes, times)
    return tuple(packed_interval(job, tasks) for job, tasks in zip(jobs, through, strict=True))
