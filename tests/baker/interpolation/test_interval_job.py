"""An interval is a unit of its own: it can be solved anywhere, and the clip is the same."""

import pickle
import threading
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from baker import Options
from baker.interpolation.interval_job import _batches, solve_interval, solve_intervals
from baker.pipeline import bake_with_survey
from baker.transport.tasks import Task

PLAIN = Options(align="none", up="z", workers=1)


def sent_away(jobs, report_progress, workers):
    """A solver that sends each job away, the last first, as a cluster may."""
    solve, sent = pickle.loads(pickle.dumps((solve_interval, jobs)))
    yield from [solve(job) for job in reversed(sent)][::-1]


@pytest.mark.parametrize(
    "options",
    [PLAIN, replace(PLAIN, paper=True), replace(PLAIN, labels="ignore")],
    ids=["default", "paper", "no labels"],
)
def test_jobs_sent_away_give_the_same_clip(write_scans, tmp_path, options):
    """Whether threads have an interval each, or share its organs."""
    folder = write_scans(days=(0, 1, 2))
    solvers = {"here": (None, 1), "few": (None, 2), "many": (None, 5), "away": (sent_away, 1)}
    for name, (solve, workers) in solvers.items():
        clip, _ = bake_with_survey([folder], replace(options, workers=workers), solve=solve)
        clip.save(tmp_path / f"{name}.gclip")
    assert len({(tmp_path / f"{name}.gclip").read_bytes() for name in solvers}) == 1


@pytest.mark.parametrize("workers", [1, 2, 5])
def test_progress_reaches_all_steps(write_scans, workers):
    reported = []
    bake_with_survey(
        [write_scans(days=(0, 1, 2))],
        replace(PLAIN, workers=workers),
        lambda stage, *counts: reported.append(counts) if stage == "transport" else None,
    )
    assert reported[0][0] == 0
    assert reported[-1][0] == reported[-1][1] > 0
    assert reported == sorted(reported)


@pytest.mark.parametrize(
    ("options", "registered"),
    [
        (PLAIN, True),
        (replace(PLAIN, transport="whole"), False),
        (replace(PLAIN, paper=True), False),
        (replace(PLAIN, paper=True, transport="exact"), False),
    ],
)
def test_the_paper_registers_no_organs(write_scans, options, registered):
    searched = []

    def solve(jobs, report_progress, threads):
        searched.extend(job.is_registered for job in jobs)
        return solve_intervals(jobs, report_progress, threads)

    bake_with_survey([write_scans()], options, solve=solve)
    assert set(searched) == {registered}


@pytest.mark.parametrize("workers", [1, 3])
def test_an_error_in_a_job_ends_the_bake(write_scans, workers):
    def solve(jobs, report_progress, threads):
        return solve_intervals([replace(job, end=None) for job in jobs], report_progress, threads)

    with pytest.raises(AttributeError):
        bake_with_survey([write_scans()], replace(PLAIN, workers=workers), solve=solve)


def test_the_threads_of_earlier_stages_end_before_the_transport(write_scans):
    left = []

    def solve(jobs, report_progress, threads):
        before = [one for one in threading.enumerate() if one.name.startswith("ThreadPool")]
        for thread in before:
            thread.join(5.0)
        left.extend(thread for thread in before if thread.is_alive())
        return solve_intervals(jobs, report_progress, threads)

    bake_with_survey([write_scans()], replace(PLAIN, workers=2), solve=solve)
    assert not left


@given(sizes=st.lists(st.integers(1, 10_000), min_size=1, max_size=60), workers=st.integers(1, 16))
def test_small_organs_are_solved_in_one_batch(sizes, workers):
    """Which has at most half of a thread's share of the points, and comes after the largest."""
    tasks = [Task("match", k, np.arange(size), np.arange(0)) for k, size in enumerate(sizes)]
    batches = _batches(tasks, workers)
    first, small, *others = ([task.organ for task in batch] for batch in batches)
    assert sorted([*first, *small, *(k for batch in others for k in batch)]) == [*range(len(sizes))]
    large = [sizes[k] for (k,) in [first, *others]]
    assert large == sorted(large, reverse=True)
    assert sum(sizes[k] for k in small) <= sum(sizes) / workers / 2
    assert max((sizes[k] for k in small), default=0) <= large[-1]
