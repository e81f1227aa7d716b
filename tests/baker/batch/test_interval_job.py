"""An interval is a unit of its own: it can be solved anywhere, and the clip is the same."""

import pickle
from dataclasses import replace

import pytest

from baker import Options
from baker.batch.executor import Threads
from baker.interpolation.movers import solve_task
from baker.pipeline import bake_recorded

PLAIN = Options(align="none", up="z", workers=1)


class Elsewhere:
    """An executor that sends each job away, the last first, as a cluster may."""

    def run(self, function, jobs, done):
        for index, job in reversed(list(enumerate(jobs))):
            task, sent = pickle.loads(pickle.dumps((function, job)))
            yield index, task(sent)
            done(len(job))


@pytest.mark.parametrize(
    "options",
    [
        PLAIN,
        replace(PLAIN, paper=True),
        replace(PLAIN, labels="ignore"),
    ],
    ids=["default", "paper", "no labels"],
)
def test_jobs_sent_away_give_the_same_clip(write_scans, tmp_path, options):
    folder = write_scans(days=(0, 1, 2, 3))
    for name, executor in (("here", None), ("threads", Threads(3)), ("away", Elsewhere())):
        bake_recorded([folder], options, executor=executor)[0].save(tmp_path / f"{name}.gclip")
    here = (tmp_path / "here.gclip").read_bytes()
    assert (tmp_path / "threads.gclip").read_bytes() == here
    assert (tmp_path / "away.gclip").read_bytes() == here


def test_progress_reaches_all_tasks(write_scans):
    told = []
    for executor in (Threads(1), Threads(3), Elsewhere()):
        bake_recorded(
            [write_scans(name=str(len(told)))], PLAIN, lambda *step: told.append(step), executor
        )
        steps = [(done, total) for stage, done, total in told if stage == "transport"]
        assert steps[0][0] == 0
        assert steps[-1][0] == steps[-1][1] > 0


@pytest.mark.parametrize(
    ("options", "limbs"),
    [
        (PLAIN, True),
        (replace(PLAIN, transport="sinkhorn"), False),
        (replace(PLAIN, paper=True), False),
        (replace(PLAIN, paper=True, transport="exact"), False),
    ],
)
def test_the_paper_knows_of_no_limbs(write_scans, monkeypatch, options, limbs):
    asked = []

    def solve(*arguments, foot, **named):
        asked.append(foot is not None)
        return solve_task(*arguments, foot=foot, **named)

    monkeypatch.setattr("baker.batch.interval_job.solve_task", solve)
    bake_recorded([write_scans()], options)
    assert any(asked) == limbs


def test_an_error_in_a_job_ends_the_bake(write_scans, monkeypatch):
    def fail(*arguments, **named):
        raise ArithmeticError("no way")

    monkeypatch.setattr("baker.batch.interval_job.solve_task", fail)
    for executor in (Threads(1), Threads(3)):
        with pytest.raises(ArithmeticError, match="no way"):
            bake_recorded([write_scans(name=str(id(executor)))], PLAIN, executor=executor)
