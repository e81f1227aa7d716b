"""Processes that die take no plant with them."""

import os
import signal
from contextlib import closing
from pathlib import Path

from baker.batch import local
from baker.batch.work import Job, Outcome
from baker.options import Options


def jobs(folder: Path, count: int) -> list[Job]:
    return [Job(f"p{k}", folder, folder / f"p{k}.gclip", Options()) for k in range(count)]


def dies_once(job: Job) -> Outcome:
    """A plant whose bake is killed the first time."""
    if job.name == "p1" and not job.clip.exists():
        job.clip.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return Outcome(job.name, "baked")


def dies_always(job: Job) -> Outcome:
    if job.name == "p1":
        os.kill(os.getpid(), signal.SIGKILL)
    return Outcome(job.name, "baked")


def test_a_killed_process_is_replaced_and_its_plant_done_again(tmp_path):
    with closing(local.share_out(dies_once, jobs(tmp_path, 4), 2)) as found:
        assert {one.name: one.state for one in found} == {f"p{k}": "baked" for k in range(4)}


def test_a_plant_that_kills_its_process_each_time_fails_alone(tmp_path):
    with closing(local.share_out(dies_always, jobs(tmp_path, 3), 1)) as found:
        outcomes = {one.name: one for one in found}
    assert {one.name for one in outcomes.values() if one.state == "baked"} == {"p0", "p2"}
    assert outcomes["p1"].code == 2
    assert "signal 9" in outcomes["p1"].error
