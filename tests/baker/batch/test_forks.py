"""Work on forks: the results of this process, in less time, and nothing of them stays behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from baker.batch.forks import ForkPool, Forks
from baker.errors import InputError
from baker.options import Options
from baker.pipeline import bake_recorded

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="forks are for Linux")


def children() -> set[str]:
    return {*Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()}


@pytest.fixture(autouse=True)
def nothing_stays():
    before = children()
    yield
    assert children() <= before


@pytest.mark.parametrize("workers", [1, 2, 3, 50])
@pytest.mark.parametrize("count", [0, 1, 2, 20])
def test_results_are_in_the_items_order(workers: int, count: int) -> None:
    items = [np.full(k, k) for k in range(count)]
    found = list(ForkPool(workers).map(lambda item: item.sum(), items))
    assert found == [k * k for k in range(count)]


def test_the_work_is_done_elsewhere_and_side_by_side() -> None:
    found = list(ForkPool(2).map(lambda k: (os.getpid(), time.sleep(0.2)), range(6)))
    assert len({pid for pid, _ in found}) == 2
    assert os.getpid() not in {pid for pid, _ in found}


def test_large_results_come_whole() -> None:
    rows = [np.random.default_rng(k).normal(size=(100_000, 3)) for k in range(5)]
    for row, found in zip(rows, ForkPool(2).map(lambda row: 2 * row, rows), strict=True):
        np.testing.assert_array_equal(found, 2 * row)


def test_steps_are_told_here() -> None:
    told: list[int] = []
    pool = ForkPool(2, told.append)
    list(pool.map(lambda k: pool.tell(k), [1, 2, 3, 4]))
    assert sorted(told) == [1, 2, 3, 4]


def test_a_fork_does_not_fork_again() -> None:
    pool = ForkPool(2)
    inner = pool.map(lambda k: {*pool.map(lambda n: os.getpid(), range(4))}, range(2))
    assert all(len(pids) == 1 for pids in inner)


def test_what_an_item_raises_is_raised_here() -> None:
    with pytest.raises(InputError, match="item 3 is bad"):
        list(ForkPool(2).map(raise_at_three, range(6)))


def raise_at_three(item: int) -> int:
    if item == 3:
        raise InputError("item 3 is bad")
    return item


def test_an_error_that_cannot_be_sent_is_told() -> None:
    class Local(Exception):
        pass

    def fail(item: int) -> int:
        raise Local("what happened")

    with pytest.raises(RuntimeError, match="what happened"):
        list(ForkPool(2).map(fail, range(3)))


def test_a_fork_that_is_killed_is_told_in_a_sentence() -> None:
    def die(item: int) -> int:
        os.kill(os.getpid(), signal.SIGKILL)
        return item

    with pytest.raises(InputError, match="was killed; most likely there is too little memory"):
        list(ForkPool(2).map(die, range(3)))


@pytest.mark.parametrize("possible", [0, 1, 2])
def test_fewer_forks_than_wanted_do_it_too(monkeypatch, possible: int) -> None:
    """A limit on processes: as many as there may be do the work, if need be this one."""
    fork, forked = os.fork, []

    def limited() -> int:
        if len(forked) == possible:
            raise BlockingIOError(11, "Resource temporarily unavailable")
        forked.append(1)
        return fork()

    monkeypatch.setattr(os, "fork", limited)
    assert list(ForkPool(3).map(lambda k: k * k, range(9))) == [k * k for k in range(9)]


def test_leaving_early_stops_the_forks() -> None:
    found = ForkPool(2).unordered(lambda k: time.sleep(60 * (k > 0)), range(4))
    next(found)
    began = time.monotonic()
    found.close()
    assert time.monotonic() - began < 30


def test_no_fork_outlives_the_command(tmp_path: Path) -> None:
    script = (
        "import os, time\n"
        "from baker.batch.forks import ForkPool\n"
        f"place = {str(tmp_path)!r}\n"
        "def work(item):\n"
        "    open(f'{place}/{os.getpid()}', 'w').close()\n"
        "    time.sleep(600)\n"
        "list(ForkPool(2).map(work, range(2)))\n"
    )
    command = subprocess.Popen([sys.executable, "-c", script])
    until = time.monotonic() + 60
    while len(forks := [*tmp_path.iterdir()]) < 2 and time.monotonic() < until:
        time.sleep(0.05)
    command.kill()
    command.wait()
    assert len(forks) == 2
    while any(alive(int(fork.name)) for fork in forks) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(alive(int(fork.name)) for fork in forks)


def alive(process: int) -> bool:
    """Whether it runs: what nobody has waited for yet does not."""
    try:
        return ") Z " not in Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return False


@pytest.fixture(scope="module")
def maize(tmp_path_factory) -> Path:
    from grow.cli import main

    folder = tmp_path_factory.mktemp("forks") / "maize"
    main(["maize", str(folder), "--scans", "3", "--points", "1500", "-q"])
    return folder


@pytest.mark.parametrize("workers", [2, 4, 5])
def test_forks_bake_the_bytes_that_threads_do(maize: Path, tmp_path: Path, workers: int) -> None:
    """Whether intervals are shared out, or the tasks in them."""
    for name, executor in (("threads", None), ("forks", Forks(workers))):
        options = Options(align="none", up="z", workers=1)
        bake_recorded([maize], options, executor=executor)[0].save(tmp_path / f"{name}.gclip")
    assert (tmp_path / "forks.gclip").read_bytes() == (tmp_path / "threads.gclip").read_bytes()


def test_progress_is_that_of_the_tasks(maize: Path) -> None:
    stages: dict[str, list[tuple[int, int]]] = {}

    def progress(stage: str, done: int, total: int) -> None:
        stages.setdefault(stage, []).append((done, total))

    bake_recorded([maize], Options(align="none", up="z"), progress, Forks(2))
    told = stages["transport"]
    assert told[0][0] == 0
    assert told[-1][0] == told[-1][1] == len(told) - 1
    assert [done for done, _ in told] == sorted(done for done, _ in told)
