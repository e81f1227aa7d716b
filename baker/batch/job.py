"""One of many plants: what to bake goes to a worker, and how it went comes back."""

from __future__ import annotations

import io
import json
import os
import time
import traceback
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import gclip
from baker.alignment import align
from baker.batch.cache import Cache
from baker.interpolation.interval_job import IntervalSolver, solve_intervals
from baker.interpolation.provenance import software
from baker.options import Options, worker_count
from baker.pipeline import Register, bake_recorded
from baker.report import write_report
from baker.scans.read import list_series
from baker.scans.unchanged import digest
from gclip.terminal.command import OUR_FAULT, verdict
from traits.table import Namer, measure_days, provenance, write_table

if TYPE_CHECKING:
    from gclip.clip import Clip

TraitsSource = tuple[str, str]
"""What measured a plant's traits, and the digest of the clip that they are of."""


@dataclass(frozen=True)
class PlantJob:
    """One plant to bake."""

    name: str
    folder: Path  # of its scans
    clip: Path  # to write
    options: Options
    report: Path | None = None  # to write
    traits: bool = False  # whether to measure
    known: TraitsSource | None = None  # of the traits there are already
    force: bool = False  # bake even where the clip is up to date
    cache: Path | None = None  # folder of earlier results


@dataclass(frozen=True)
class Outcome:
    """How a plant's bake went."""

    name: str
    state: Literal["baked", "unchanged", "failed"]
    scans: int = 0
    tracks: int = 0
    points: int = 0  # of all scans
    seconds: float = 0.0  # of wall clock, all in all
    code: int = 0  # 0, or the exit code of the failure in `error`
    error: str = ""
    traits: str = ""  # rows of the table; empty where not wanted, or known already
    notes: tuple[str, ...] = ()  # what was decided and found
    looks: str = ""  # "7 of 8 intervals look right"


def bake_plant(job: PlantJob, solve: IntervalSolver | None = None) -> Outcome:
    """Bake one plant, or find that its clip is up to date. What goes wrong is in the outcome.

    solve: how its intervals are solved, by default threads of this process.
    """
    began = time.perf_counter()
    try:
        clip = None if job.force else current_clip(job)
        state: Literal["baked", "unchanged"] = "unchanged" if clip else "baked"
        clip = clip or _bake(job, solve)
        table = io.StringIO()
        if job.traits and provenance(clip) != job.known:
            write_table(table, Namer(clip, job.name), measure_days(clip))
    except Exception as error:
        code, sentence = verdict(error)
        if code == OUR_FAULT and os.environ.get("GCLIP_TRACEBACK"):
            traceback.print_exc()
        seconds = time.perf_counter() - began
        return Outcome(job.name, "failed", seconds=seconds, code=code, error=sentence)
    line = clip.provenance.get("verdict", {"line": ""})["line"]  # clips of old have none
    return Outcome(
        job.name,
        state,
        scans=len(clip.scans),
        tracks=len(clip.track_table),
        points=sum(scan.points for scan in clip.scans),
        seconds=time.perf_counter() - began,
        traits=table.getvalue().partition("\n")[2],
        notes=(*clip.provenance["decisions"], *clip.provenance["notes"], line),
        looks=line.partition(";")[0].rstrip("."),
    )


def _bake(job: PlantJob, solve: IntervalSolver | None) -> Clip:
    solve = solve or partial(solve_intervals, workers=worker_count(job.options.workers))
    register: Register = align
    if job.cache is not None:
        cache = Cache(job.cache)
        register, solve = cache.kept(register), cache.kept_intervals(solve)
    clip, record = bake_recorded([job.folder], job.options, None, register, solve)
    if job.report is not None:  # before the clip: one that is up to date has its report
        write_report(job.report, clip, record, title=job.clip.name)
    clip.save(job.clip)
    return clip


def current_clip(job: PlantJob) -> Clip | None:
    """The job's clip if it is whole and what a bake would give, else None.

    The clip itself says what it was made of. It is current if the program and its packages have the
    same versions, the options are the same, and so are the scans: their names, order, times and the
    digests of their bytes. Raises InputError where the folder holds no series of scans.
    """
    if not job.clip.exists() or not (job.report is None or job.report.exists()):
        return None
    try:
        clip = gclip.open(job.clip)
    except gclip.ClipError:
        return None
    listing = list_series([job.folder], job.options)
    entries = listing.schedule.entries
    series = listing.series((), job.options)
    resolved = job.options.for_series(series.fixed, series.length, series.root)
    made_by = software((entry.path for entry in entries), job.options.outliers)
    expected = {**made_by, "options": resolved.provenance()}
    expected = json.loads(json.dumps(expected))  # as in the clip: tuples as lists
    moments = {entry.name: (entry.moment.time, entry.moment.date) for entry in entries}
    made_of = clip.provenance.get("inputs")
    if (
        any(clip.provenance.get(key) != value for key, value in expected.items())
        or any(moments.get(scan.name) != (scan.time, scan.date) for scan in clip.scans)
        or not isinstance(made_of, list)
        or len(made_of) != len(entries)
    ):
        return None
    same = (  # last, as it reads every scan
        scan == {"name": entry.name, "sha256": digest(listing.files(entry))}
        for scan, entry in zip(made_of, entries, strict=True)
    )
    return clip if all(same) else None
