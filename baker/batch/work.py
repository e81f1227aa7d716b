"""One plant's bake as a piece of work: what goes in and what comes out fits through a pipe."""

from __future__ import annotations

import os
import time
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from baker.options import Options
from gclip.terminal.command import OUR_FAULT, verdict

if TYPE_CHECKING:
    from baker.batch.executor import Executor
    from baker.geometry.parallel import MapLike
    from gclip import Clip

About = tuple[str, str]
"""What measured a plant's traits, and the digest of the clip they are of."""


@dataclass(frozen=True)
class Job:
    """One plant to bake.

    clip, report: files to write; no report where None.
    traits:       whether to measure, too; `known` says of which clip there are traits already.
    force:        bake even where the clip stands.
    cache:        folder of finished intervals, None where none are kept.
    """

    name: str
    folder: Path
    clip: Path
    options: Options
    report: Path | None = None
    traits: bool = False
    known: About | None = None
    force: bool = False
    cache: Path | None = None


@dataclass(frozen=True)
class Outcome:
    """How it went.

    code:    0, or the exit code of the failure that `error` tells in one sentence.
    points:  of all scans; seconds: of wall clock, all in all.
    traits:  rows of the table, "" where not asked for or known already.
    notes:   what was decided and found.
    """

    name: str
    state: Literal["baked", "unchanged", "failed"]
    scans: int = 0
    tracks: int = 0
    points: int = 0
    seconds: float = 0.0
    code: int = 0
    error: str = ""
    traits: str = ""
    notes: tuple[str, ...] = ()


def bake_plant(job: Job, executor: Executor | None = None, map: MapLike | None = None) -> Outcome:
    """Bake one plant, or find that its clip stands. Whatever goes wrong is in the outcome.

    executor: where its intervals are solved; map: where its scans are looked at; both by default
    on threads of this process.
    """
    began = time.perf_counter()
    try:
        clip, state = _baked_or_standing(job, executor, map)
        traits = _traits(clip, job) if job.traits else ""
    except Exception as error:
        code, sentence = verdict(error)
        if code == OUR_FAULT and os.environ.get("GCLIP_TRACEBACK"):
            traceback.print_exc()
        seconds = time.perf_counter() - began
        return Outcome(job.name, "failed", seconds=seconds, code=code, error=sentence)
    return Outcome(
        job.name,
        state,
        scans=len(clip.scans),
        tracks=len(clip.track_table),
        points=sum(scan.points for scan in clip.scans),
        seconds=time.perf_counter() - began,
        traits=traits,
        notes=tuple(clip.provenance["decisions"] + clip.provenance["notes"]),
    )


def _baked_or_standing(
    job: Job, executor: Executor | None, map: MapLike | None
) -> tuple[Clip, Literal["baked", "unchanged"]]:
    from baker.batch.fresh import standing_clip

    if not job.force and job.clip.exists() and (job.report is None or job.report.exists()):
        clip = standing_clip(job.clip, job.folder, job.options)
        if clip is not None:
            return clip, "unchanged"
    return _baked(job, executor, map), "baked"


def _baked(job: Job, executor: Executor | None, map: MapLike | None) -> Clip:
    from baker.batch.cache import IntervalCache
    from baker.pipeline import bake_recorded
    from baker.report import write_report
    from baker.report.verification import verify

    cache = None if job.cache is None else IntervalCache(job.cache)
    clip, record = bake_recorded([job.folder], job.options, None, executor, cache, map)
    if job.report is not None:
        # Before the clip: a clip that stands has its report.
        errors = verify(clip, record, _silent)
        write_report(
            job.report,
            clip,
            record,
            title=job.clip.name,
            errors=errors,
            seconds={},
            workers=job.options.workers,
            progress=_silent,
        )
    clip.save(job.clip)
    return clip


def _traits(clip: Clip, job: Job) -> str:
    import io

    from traits import measure_days, write_table
    from traits.table import Namer, provenance

    if provenance(clip) == job.known:
        return ""
    table = io.StringIO()
    write_table(table, Namer(clip, job.name), measure_days(clip))
    return table.getvalue().partition("\n")[2]


def _silent(stage: str, done: int, total: int) -> None:
    """Nobody watches the stages of one of many plants."""
