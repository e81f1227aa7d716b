"""How many cores a bake may use, and work shared out among them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from typing import Protocol, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


class Pool(Protocol):
    """Where a function is mapped over items, as executors of the standard library do it."""

    def map(self, function: Callable[[Item], Result], items: Sequence[Item], /) -> Iterable[Result]:
        """The results in the items' order."""
        ...


def worker_count(asked: int) -> int:
    """`asked` threads, or where that is 0 as many as this process may use cores."""
    if asked:
        return asked
    # Not every system can tie a process to some of its cores.
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def in_parallel(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    workers: int,
    pool: Pool | None = None,
    fewest: int = 2,
) -> list[Result]:
    """The function's results in the items' order, worked out by up to `workers` threads.

    pool:   to run on instead; none of its own threads may be among the callers.
    fewest: items, below which they are not worth sharing out.

    Threads gain only where the function spends its time outside Python, as compiled loops do.
    """
    if workers <= 1 or len(items) < fewest:
        return [function(item) for item in items]
    if pool is not None:
        return list(pool.map(function, items))
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(min(workers, len(items))) as executor:
        return list(executor.map(function, items))
