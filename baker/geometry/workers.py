"""How many cores a bake may use, and work shared out among them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")
Done = Callable[[int], None]


class Pool(Protocol):
    """Where a function is mapped over items, as executors of the standard library do it."""

    def map(self, function: Callable[[Item], Result], items: Sequence[Item], /) -> Iterable[Result]:
        """The results in the items' order."""
        ...


@dataclass(frozen=True)
class Crew:
    """Those who share out work among themselves.

    workers: how many there are.
    pool:    where they work; none of its own threads may be among the callers. By default they
             are threads, which gain only where the function spends its time outside Python, as
             compiled loops do.
    beside_one: called before one of them works while the others have nothing to do.
    """

    workers: int = 1
    pool: Pool | None = None
    beside_one: Callable[[], None] = lambda: None

    def map(
        self,
        function: Callable[[Item], Result],
        items: Sequence[Item],
        *,
        fewest: int = 2,
        done: Done = lambda steps: None,
    ) -> list[Result]:
        """The function's results in the items' order.

        fewest: items, below which they are not worth sharing out.
        done:   called with 1 for every result that is there.
        """
        results = []
        for result in self.each(function, items, fewest):
            results.append(result)
            done(1)
        return results

    def if_light(self) -> Crew:
        """Who should share out what moves more than it computes: two processes gain nothing."""
        return self if self.pool is None or self.workers > 2 else ALONE

    def beside(self, count: int) -> int:
        """Threads for each of so many works: few are of different size, and cores stand idle."""
        return self.workers if count < 2 * self.workers else 1

    def each(
        self, function: Callable[[Item], Result], items: Sequence[Item], fewest: int = 2
    ) -> Iterable[Result]:
        """The function's results in the items' order, each as soon as it and those before are."""
        if self.workers <= 1 or len(items) < fewest:
            self.beside_one()
            yield from map(function, items)
        elif self.pool is not None:
            yield from self.pool.map(function, items)
        else:
            from concurrent.futures import ThreadPoolExecutor

            with ThreadPoolExecutor(min(self.workers, len(items))) as executor:
                yield from executor.map(function, items)


ALONE = Crew()


def in_groups(items: Sequence[Item], size: Callable[[Item], int], count: int) -> list[list[Item]]:
    """The items in their order, in up to `count` groups of about the same size in all."""
    share = sum(map(size, items)) / count
    groups: list[list[Item]] = []
    held = 0.0
    for item in items:
        if not groups or held > share:
            groups.append([])
            held = 0.0
        groups[-1].append(item)
        held += size(item)
    return groups


class Steps:
    """Counts the steps of a stage that are done; more of them than there are don't count.

    tell: called with the steps done and the steps in all, at first with none.
    """

    def __init__(self, tell: Callable[[int, int], None], total: int) -> None:
        self._tell, self._done, self._total = tell, 0, total
        tell(0, total)

    def __call__(self, steps: int) -> None:
        """So many more are done."""
        before, self._done = self._done, min(self._done + steps, self._total)
        if self._done > before:
            self._tell(self._done, self._total)


def worker_count(asked: int) -> int:
    """`asked` cores, or where that is 0 as many as this process may use."""
    if asked:
        return asked
    # Not every system can tie a process to some of its cores.
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
