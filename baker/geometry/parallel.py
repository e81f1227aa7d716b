"""Map-like callables with which stages loop over scans, organs or intervals.

A stage takes ``map: MapLike = map``, like the `workers` of `scipy.optimize`: the builtin is serial,
the ``map`` of a `concurrent.futures` executor is parallel.
"""

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

MapLike = Callable[..., Iterable[Any]]
"""``map(function, *iterables)``, with the results in the order of the items."""

ReportProgress = Callable[[int, int], None]
"""``report_progress(done, total)``"""


def worker_count(requested: int) -> int:
    """`requested` or, if that is 0, the number of cores that this process may use."""
    if requested:
        return requested
    # Not every system can restrict a process to some cores.
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def thread_map(workers: int) -> Iterator[MapLike]:
    """A map with `workers` threads, for functions that release the GIL."""
    if workers <= 1:
        yield map
    else:
        executor = ThreadPoolExecutor(workers)
        try:
            yield executor.map
        finally:  # after an error or Ctrl-C, don't wait for running calls
            executor.shutdown(wait=False, cancel_futures=True)


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Run the linear algebra of NumPy and SciPy on one thread.

    More threads would round sums differently, and take time from those of `thread_map`.
    """
    import scipy.linalg  # noqa: F401  # only libraries that are loaded can be limited
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield


def reporting(map: MapLike, report_progress: ReportProgress, total: int) -> MapLike:
    """Wrap a map so that it reports the number of finished items, from 0 to `total`.

    report_progress: called with that number and `total`; items of later calls are not reported.
    """
    done = 0
    report_progress(0, total)

    def reporting_map(function: Callable[..., Any], *iterables: Iterable[Any]) -> Iterator[Any]:
        nonlocal done
        for result in map(function, *iterables):
            if done < total:
                done += 1
                report_progress(done, total)
            yield result

    return reporting_map
