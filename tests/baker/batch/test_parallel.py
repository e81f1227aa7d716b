"""Worker processes: results, errors, deaths, and that none is left behind."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import threading
import time
import warnings
from contextlib import suppress
from pathlib import Path

import pytest

from baker.batch.bake_all import bake_plants
from baker.batch.plant import Outcome, PlantJob
from baker.batch.workers import process_pool
from baker.options import Options, Outputs
from baker.scans.child_process import ChildEnded
from gclip.terminal.atomic import folder_beside
from tests.baker.batch.conftest import write_greenhouse


def square(number: int) -> int:
    return number * number


def whoami(number: int) -> int:
    time.sleep(0.2)
    return os.getpid()


def fail(number: int) -> int:
    raise ArithmeticError(f"no {number}")


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def leave_marker(folder: Path) -> None:
    """Work for long, with a half-written file that is named by the process."""
    with folder_beside(folder / "clip") as draft:
        (draft / str(os.getpid())).touch()
        time.sleep(600)


def warn(number: int) -> int:
    warnings.warn(f"number {number}", stacklevel=1)
    return number


def test_results_are_from_other_processes() -> None:
    with process_pool(2) as submit:
        squares = [submit(square, k) for k in range(9)]
        assert [task.result() for task in squares] == [k * k for k in range(9)]
        processes = {task.result() for task in [submit(whoami, k) for k in range(4)]}
    assert len(processes) == 2
    assert os.getpid() not in processes


def test_errors_are_raised_here() -> None:
    with pytest.raises(ArithmeticError, match="no 3"), process_pool(2) as submit:
        submit(fail, 3).result()


def test_a_task_that_kills_its_process_fails_alone() -> None:
    with process_pool(2) as submit:
        doomed, other = submit(die), submit(square, 3)
        assert other.result() == 9
        with pytest.raises(ChildEnded):
            doomed.result()
        assert submit(square, 4).result() == 16


def test_a_killed_plant_is_baked_once_more(tmp_path: Path) -> None:
    jobs = [_job(tmp_path, f"p{k}") for k in range(3)]
    with process_pool(2) as submit:
        found = bake_plants(submit, jobs, bake=_bake_or_die_once)
        states = {outcome.name: outcome.state for outcome in found}
    assert states == dict.fromkeys(("p0", "p1", "p2"), "baked")


def _job(folder: Path, name: str) -> PlantJob:
    return PlantJob(name, folder, Options(), Outputs(folder / f"{name}.gclip"))


def _bake_or_die_once(job: PlantJob) -> Outcome:
    if not job.outputs.clip.exists():
        job.outputs.clip.touch()
        die()
    return Outcome(job.name, "baked")


def test_a_plant_that_kills_its_process_is_the_programs_fault(tmp_path) -> None:
    jobs = [_job(tmp_path, f"p{k}") for k in range(3)]
    with process_pool(1) as submit:
        found = bake_plants(submit, jobs, bake=_bake_or_die)
        codes = {outcome.name: outcome.code for outcome in found}
    assert codes == {"p0": 0, "p1": 1, "p2": 0}


def _bake_or_die(job: PlantJob) -> Outcome:
    if job.name == "p1":
        die()
    return Outcome(job.name, "baked")


def test_a_task_that_is_ended_takes_its_process_with_it() -> None:
    with pytest.raises(ChildEnded), process_pool(1) as submit:
        submit(sys.exit, 3).result()


def test_leaving_early_ends_tasks_by_an_exception(tmp_path: Path) -> None:
    with suppress(KeyboardInterrupt), process_pool(2) as submit:
        for _ in range(8):
            submit(leave_marker, tmp_path)
        processes = _wait_for_markers(tmp_path, 2)
        raise KeyboardInterrupt
    assert not any(map(alive, processes))
    assert not list(tmp_path.iterdir())


def test_no_worker_outlives_the_command(tmp_path: Path) -> None:
    code = (
        "from pathlib import Path\n"
        "from baker.batch.workers import process_pool\n"
        "from tests.baker.batch.test_parallel import leave_marker\n"
        "with process_pool(2) as submit:\n"
        f"    tasks = [submit(leave_marker, Path({str(tmp_path)!r})) for _ in range(2)]\n"
        "    tasks[0].result()\n"
    )
    command = subprocess.Popen([sys.executable, "-c", code])
    processes = _wait_for_markers(tmp_path, 2)
    command.kill()
    command.wait()
    while any(map(alive, processes)):
        time.sleep(0.05)


def test_warnings_of_workers_on_a_terminal_hang_nobody() -> None:
    """While bars are drawn as fast as they can be, their locks are held nearly always."""
    code = (
        "from baker.batch.workers import process_pool\n"
        "from gclip.terminal.progress import StageProgress\n"
        "from tests.baker.batch.test_parallel import warn\n"
        "bars = StageProgress()\n"
        "bars.bars.live.refresh_per_second = 2000\n"
        "with bars:\n"
        "    bars('warning', 0, 40)\n"
        "    for round in range(5):\n"
        "        with process_pool(4) as submit:\n"
        "            for k, one in enumerate([submit(warn, k) for k in range(8)]):\n"
        "                one.result()\n"
        "                bars('warning', 8 * round + k + 1, 40)\n"
    )
    ours, terminal = pty.openpty()
    command = subprocess.Popen(
        [sys.executable, "-c", code], stdin=terminal, stdout=terminal, stderr=terminal
    )
    os.close(terminal)
    written = bytearray()

    def read() -> None:
        try:
            while part := os.read(ours, 4096):
                written.extend(part)
        except OSError:  # Linux: nobody has the terminal any more
            pass

    reader = threading.Thread(target=read)
    reader.start()
    try:
        assert command.wait(timeout=300) == 0, written.decode()
    finally:
        command.kill()
    reader.join()
    os.close(ours)
    assert written.count(b"UserWarning: number") >= 5


def test_plants_have_the_same_bytes_by_any_number_of_workers(tmp_path: Path) -> None:
    house = write_greenhouse(tmp_path / "house", ["a", "b"], days=3)
    found = []
    for workers in (1, 2, 5):
        folder = tmp_path / str(workers)
        folder.mkdir()
        options = Options(align="none", up="z", workers=max(workers // 2, 1))
        names = ("a", "b")
        outputs = [Outputs(folder / f"{name}.gclip") for name in names]
        jobs = [PlantJob(n, house / n, options, o) for n, o in zip(names, outputs, strict=True)]
        with process_pool(min(workers, 2)) as submit:
            outcomes = list(bake_plants(submit, jobs))
        assert {outcome.state for outcome in outcomes} == {"baked"}
        found.append({path.name: path.read_bytes() for path in folder.iterdir()})
    assert found[0] == found[1] == found[2]


def _wait_for_markers(folder: Path, count: int) -> list[int]:
    while len(markers := list(folder.glob(".*/*"))) < count:
        time.sleep(0.05)
    return [int(marker.name) for marker in markers]


def alive(process: int) -> bool:
    """Whether it runs: what nobody has waited for yet does not."""
    try:
        return ") Z " not in Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return False
