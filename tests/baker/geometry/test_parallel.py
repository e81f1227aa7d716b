"""Maps keep the items' order and report every result."""

from __future__ import annotations

import operator
import threading
from contextlib import suppress

import pytest

from baker.geometry.parallel import reporting, thread_map


@pytest.mark.parametrize("workers", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 9])
def test_results_are_in_the_items_order_and_reported(workers: int, count: int) -> None:
    reported: list[tuple[int, int]] = []
    with thread_map(workers) as map_:
        counted = reporting(map_, lambda *progress: reported.append(progress), count)
        found = list(counted(operator.mul, range(count), range(count)))
    assert found == [k * k for k in range(count)]
    assert reported == [(k, count) for k in range(count + 1)]


def test_several_maps_of_a_stage_are_counted_together() -> None:
    reported: list[tuple[int, int]] = []
    counted = reporting(map, lambda *progress: reported.append(progress), 3)
    assert list(counted(abs, [-1, -2])) == [1, 2]
    assert list(counted(abs, [-3, -4])) == [3, 4]
    assert reported == [(0, 3), (1, 3), (2, 3), (3, 3)]


def test_nobody_waits_for_threads_when_the_work_is_stopped() -> None:
    release, finished = threading.Event(), []

    def wait(number: int) -> None:
        release.wait(20)
        finished.append(number)

    with suppress(KeyboardInterrupt), thread_map(2) as map_:
        map_(wait, range(8))
        raise KeyboardInterrupt
    assert not finished
    release.set()
