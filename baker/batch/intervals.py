"""All intervals of a series, solved one by one wherever an executor runs them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from baker.batch.cache import IntervalCache
from baker.batch.cache.colors import colored, numbered
from baker.batch.cache.key import key_of
from baker.batch.executor import Executor
from baker.batch.interval_job import IntervalJob, move_interval, packed_interval, solve_interval
from baker.geometry.workers import Done, Steps
from baker.interpolation.movers import Moved
from baker.interpolation.through import Velocity, smooth_through, velocity_at
from gclip.clip import Interval

Numbered = Iterator[tuple[int, Interval]]


def solve_intervals(
    jobs: Sequence[IntervalJob],
    executor: Executor,
    *,
    smooth: bool,
    cache: IntervalCache | None = None,
    tell: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[Interval, ...]:
    """The jobs' intervals, in their order; the same whatever the executor and the cache.

    jobs:   of successive intervals, all of them.
    smooth: whether paths keep their speed across scans (`--paths smooth`): then an interval also
            depends on the movers of its two neighbours.
    cache:  intervals that need no solving; each one that does is kept as soon as it is done.
    tell:   called with the tasks done and the tasks in all.
    """
    found: dict[int, Interval] = {}
    keys, asked = [], jobs
    if cache is not None:
        jobs = [numbered(job) for job in asked]
        keys = [key_of(job, _beside(jobs, k) if smooth else None) for k, job in enumerate(jobs)]
        kept = ((k, cache.get(keys[k], job)) for k, job in enumerate(jobs))
        found = {k: interval for k, interval in kept if interval is not None}
    wanted = [k for k in range(len(jobs)) if k not in found]
    needed = sorted({n for k in wanted for n in _near(jobs, k)}) if smooth else wanted
    done = Steps(tell, sum(len(jobs[k]) for k in needed))
    solve = _smooth_intervals if smooth else _single_intervals
    for k, interval in solve(jobs, wanted, needed, executor, done):
        found[k] = interval
        if cache is not None:
            cache.put(keys[k], interval)
    if cache is not None:
        return tuple(colored(found[k], job) for k, job in enumerate(asked))
    return tuple(found[k] for k in range(len(jobs)))


def _beside(jobs: Sequence[IntervalJob], k: int) -> list[IntervalJob | None]:
    return [jobs[n] if 0 <= n < len(jobs) else None for n in (k - 1, k + 1)]


def _near(jobs: Sequence[IntervalJob], k: int) -> range:
    """An interval and its neighbours."""
    return range(max(k - 1, 0), min(k + 2, len(jobs)))


def _single_intervals(
    jobs: Sequence[IntervalJob],
    wanted: Sequence[int],
    needed: Sequence[int],
    executor: Executor,
    done: Done,
) -> Numbered:
    for index, interval in executor.run(solve_interval, [jobs[k] for k in wanted], done):
        yield wanted[index], interval


def _smooth_intervals(
    jobs: Sequence[IntervalJob],
    wanted: Sequence[int],
    needed: Sequence[int],
    executor: Executor,
    done: Done,
) -> Numbered:
    """Each wanted interval as soon as the movers of its neighbours are there too."""
    moved: dict[int, list[Moved]] = {}
    velocities: dict[int, Velocity] = {}
    waiting = list(wanted)
    for index, tasks in executor.run(move_interval, [jobs[k] for k in needed], done):
        moved[needed[index]] = tasks
        for k in [k for k in waiting if all(n in moved for n in _near(jobs, k))]:
            waiting.remove(k)
            for scan in (k, k + 1):
                if scan not in velocities:
                    velocities[scan] = _velocity(jobs, moved, scan)
            start, end = jobs[k].times
            through = smooth_through(moved[k], velocities[k], velocities[k + 1], end - start)
            yield k, packed_interval(jobs[k], through)


def _velocity(jobs: Sequence[IntervalJob], moved: dict[int, list[Moved]], scan: int) -> Velocity:
    """At a scan, by its number; interval k lies between scans k and k + 1."""
    spans = [job.times[1] - job.times[0] for job in jobs]
    return velocity_at(
        jobs[scan].start if scan < len(jobs) else jobs[-1].end,
        moved[scan - 1] if scan > 0 else (),
        moved[scan] if scan < len(jobs) else (),
        spans[max(scan - 1, 0)],
        spans[min(scan, len(jobs) - 1)],
    )
