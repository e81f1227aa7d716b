"""Who shares out what: few or light works are done by one, and others may load something beside."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from baker.geometry.workers import ALONE, Crew, in_groups


@pytest.mark.parametrize("workers", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 9])
def test_results_are_in_the_items_order_and_told_of(workers: int, count: int) -> None:
    told: list[int] = []
    found = Crew(workers).map(lambda k: k * k, range(count), done=told.append)
    assert found == [k * k for k in range(count)]
    assert told == count * [1]


def test_something_is_begun_beside_one_who_works_alone() -> None:
    begun: list[str] = []
    with ThreadPoolExecutor(2) as pool:
        crew = Crew(2, pool, lambda: begun.append("beside"))
        assert crew.map(str, [1, 2], fewest=3) == ["1", "2"]
        assert begun == ["beside"]
        assert crew.map(str, [1, 2]) == ["1", "2"]
    assert begun == ["beside"]


def test_two_processes_do_not_share_light_work() -> None:
    with ThreadPoolExecutor(2) as pool:
        assert Crew(2, pool).if_light() is ALONE
        assert Crew(3, pool).if_light().workers == 3
    assert Crew(2).if_light().workers == 2  # threads cost nothing


def test_groups_keep_the_order_and_are_of_about_one_size() -> None:
    sizes = [5, 1, 1, 1, 9, 2, 2, 2, 1]
    groups = in_groups(sizes, lambda size: size, 3)
    assert [size for group in groups for size in group] == sizes
    assert len(groups) <= 3
    assert max(map(sum, groups)) <= sum(sizes) / 3 + max(sizes)
