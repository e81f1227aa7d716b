"""All intervals of a series, solved one by one wherever an executor runs them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from baker.batch.cache import IntervalCache
from baker.batch.cache.colors import colored, numbered
from baker.batch.cache.key import key_of
from baker.batch.executor import Executor
from baker.batch.interval_job import IntervalJob, solve_interval
from gclip import Interval


def solve_intervals(
    jobs: Sequence[IntervalJob],
    executor: Executor,
    *,
    cache: IntervalCache | None = None,
    tell: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[Interval, ...]:
    """The jobs' intervals, in their order; the same whatever the executor and the cache.

    jobs:   of successive intervals, all of them.
    cache:  intervals that need no solving; each one that does is kept as soon as it is done.
    tell:   called with the tasks done and the tasks in all.
    """
    found: dict[int, Interval] = {}
    keys, asked = [], jobs
    if cache is not None:
        jobs = [numbered(job) for job in asked]
        keys = [key_of(job) for job in jobs]
        kept = ((k, cache.get(keys[k], job)) for k, job in enumerate(jobs))
        found = {k: interval for k, interval in kept if interval is not None}
    wanted = [k for k in range(len(jobs)) if k not in found]
    total, solved = sum(len(jobs[k]) for k in wanted), 0
    tell(0, total)

    def done(steps: int) -> None:
        nonlocal solved
        solved += steps
        tell(solved, total)

    for index, interval in executor.run(solve_interval, [jobs[k] for k in wanted], done):
        found[wanted[index]] = interval
        if cache is not None:
            cache.put(keys[wanted[index]], interval)
    if cache is not None:
        return tuple(colored(found[k], job) for k, job in enumerate(asked))
    return tuple(found[k] for k in range(len(jobs)))
