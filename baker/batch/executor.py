"""Where the intervals of a bake are solved: here on threads, or wherever else jobs can be sent."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from queue import SimpleQueue
from typing import Any, Protocol, TypeVar

from baker.batch.interval_job import IntervalJob

Result = TypeVar("Result")
Done = Callable[[int], None]


class Executor(Protocol):
    """Runs a function of `baker.batch.interval_job` on many jobs."""

    def run(
        self, function: Callable[..., Result], jobs: Sequence[IntervalJob], done: Done
    ) -> Iterator[tuple[int, Result]]:
        """Yield each job's number and its result as they come, in any order.

        function: top-level and picklable; called as `function(job)`, or with more of the
                  arguments that `solve_interval` has.
        done:     called in the caller's own thread with how many more of the jobs' tasks are done.
        """
        ...


class Threads:
    """An `Executor` on threads of this process.

    Several intervals are under way at once, and all their tasks go to the same `workers` threads:
    a single interval with many segments keeps all cores busy too.
    """

    def __init__(self, workers: int) -> None:
        self._workers = workers

    def run(
        self, function: Callable[..., Result], jobs: Sequence[IntervalJob], done: Done
    ) -> Iterator[tuple[int, Result]]:
        if self._workers <= 1:
            for index, job in enumerate(jobs):
                yield index, function(job, done=done)
            return
        events: SimpleQueue[int | Future[Result]] = SimpleQueue()
        pool = ThreadPoolExecutor(self._workers)
        leads = ThreadPoolExecutor(self._workers)  # they wait for the pool: it needs its own
        try:
            work: Callable[[IntervalJob], Result] = partial(
                function, map=pool.map, workers=self._workers, done=events.put
            )
            numbers: dict[Future[Any], int] = {}
            for index, job in enumerate(jobs):
                future = leads.submit(work, job)
                numbers[future] = index
                future.add_done_callback(events.put)
            while numbers:
                event = events.get()
                if isinstance(event, int):
                    done(event)
                else:
                    yield numbers.pop(event), event.result()
        finally:
            leads.shutdown(wait=False, cancel_futures=True)
            pool.shutdown(wait=False, cancel_futures=True)
