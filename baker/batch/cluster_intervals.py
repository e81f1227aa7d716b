"""A plant's intervals as tasks of a cluster: an `Executor` of the pipeline.

Worth it where there are fewer plants than cores. What an interval needs travels with its task,
through the scheduler, so that a worker that dies loses nothing; a window of them does at a time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from itertools import islice
from typing import TYPE_CHECKING, TypeVar

from baker.batch.executor import Done
from baker.batch.interval_job import IntervalJob
from baker.errors import InputError

if TYPE_CHECKING:
    from distributed import Client, Future

Result = TypeVar("Result")


class ClusterIntervals:
    """Where a bake's intervals are solved: by all workers of a cluster.

    client: opens a client for as long as intervals are under way.
    """

    def __init__(self, client: Callable[[], AbstractContextManager[Client]]) -> None:
        self._client = client

    def run(
        self, function: Callable[..., Result], jobs: Sequence[IntervalJob], done: Done
    ) -> Iterator[tuple[int, Result]]:
        """See `baker.batch.executor`. Raises InputError where workers die of an interval."""
        import dask
        from distributed import KilledWorker, as_completed

        # Scans are large; that they are sent is meant.
        with self._client() as client, dask.config.set(LARGE):
            window = max(2, 2 * sum(client.nthreads().values()))
            waiting = iter(enumerate(jobs))
            under_way: dict[Future, int] = {}
            ready = as_completed([], loop=client.loop)
            try:
                while True:
                    for index, job in islice(waiting, window - len(under_way)):
                        future = client.submit(function, job, pure=False)
                        under_way[future] = index
                        ready.add(future)
                    if not under_way:
                        return
                    future = next(ready)
                    index = under_way.pop(future)
                    try:
                        found: Result = future.result()
                    except KilledWorker as error:
                        times = error.allowed_failures + 1
                        raise InputError(
                            f"the workers of the cluster died {times} times of one interval; most "
                            "likely they need more memory, or the scans fewer points (--voxel, "
                            "--resample)."
                        ) from None
                    done(len(jobs[index]))
                    yield index, found
            finally:
                if under_way:
                    client.cancel(list(under_way), force=True)


LARGE = {"distributed.admin.large-graph-warning-threshold": "1TB"}


def on_this_worker() -> ClusterIntervals:
    """For a plant that is itself a task: while it waits, its worker takes other tasks."""
    from distributed import worker_client

    return ClusterIntervals(worker_client)
