"""Map-like callables, by which stages loop over scans, organs or intervals.

A stage takes ``map: MapLike = map`` as `scipy.optimize` takes ``workers``: the builtin does the
items one after another; the ``map`` of a `concurrent.futures` executor shares them out.
"""

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

MapLike = Callable[..., Iterable[Any]]
"""``map(function, *iterables)``: the results in the items' order. Executors of worker processes
need a function and items that can be pickled."""

ReportProgress = Callable[[int, int], None]
"""``report_progress(done, total)``"""


def worker_count(requested: int) -> int:
    """`requested` cores, or where that is 0 as many as this process may use."""
    if requested:
        return requested
    # Not every system can tie a process to some of its cores.
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def thread_map(workers: int) -> Iterator[MapLike]:
    """A map over `workers` threads, which pays where the function releases Python's lock."""
    if workers <= 1:
        yield map
    else:
        executor = ThreadPoolExecutor(workers)
        try:
            yield executor.map
        finally:  # after an error or Ctrl-C nobody waits for what is under way
            executor.shutdown(wait=False, cancel_futures=True)


def reporting(map: MapLike, report_progress: ReportProgress, total: int) -> MapLike:
    """A map that reports after each item how many of `total` are done, and at once that none is.

    total: items of all calls of the map together; more than that are not reported.
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
