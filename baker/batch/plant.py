"""One plant: baked and written, here or in a worker, where it is one of many."""

import io
import json
import os
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Literal

import gclip
from baker.batch.cache import Cache
from baker.batch.outputs import Outputs
from baker.geometry.parallel import worker_count
from baker.interpolation.interval_job import IntervalSolver, solve_intervals
from baker.interpolation.provenance import software
from baker.options import Options, parse_corrections
from baker.pipeline import Progress, bake_recorded
from baker.report import write_report
from baker.report.verification import HoldoutError, verify
from baker.scans import Finding
from baker.scans.read import digest, list_series
from gclip.clip import Clip
from gclip.corrections import corrections_file
from gclip.terminal.command import OUR_FAULT, verdict
from traits.table import Namer, measure_days, provenance, write_table


@dataclass(frozen=True)
class PlantJob:
    """One plant of many, to bake in a worker."""

    name: str
    folder: Path  # of its scans
    options: Options
    outputs: Outputs  # the plant's own
    known: tuple[str, str] | None = None  # `provenance` of the traits there are already


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


class WorkerDied(RuntimeError):
    """A worker process was killed by its task, most likely for want of memory."""

    def __init__(self, times: int) -> None:
        super().__init__(
            f"a worker process was killed {times} times at the same task; most likely the scans "
            "need more memory than there is: try fewer points (--voxel, --resample) or fewer "
            "processes (--workers)."
        )

    def outcome(self, job: PlantJob) -> Outcome:
        return Outcome(job.name, "failed", code=OUR_FAULT, error=str(self))


def bake_plant(job: PlantJob, solve: IntervalSolver | None = None) -> Outcome:
    """Bake one plant, or find that its clip is up to date. What goes wrong is in the outcome.

    solve: how its intervals are solved, by default threads of this process.
    """
    began, outputs = time.perf_counter(), job.outputs
    try:
        job = replace(job, options=with_corrections(job.options, outputs.clip))
        clip = None if outputs.force else current_clip(job)
        state: Literal["baked", "unchanged"] = "unchanged" if clip else "baked"
        if clip is None:
            cache = Cache(outputs.cache) if outputs.cache else None
            clip, _ = bake_into(outputs, [job.folder], job.options, cache, solve)
        table = io.StringIO()
        if outputs.traits and provenance(clip) != job.known:
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


def with_corrections(options: Options, clip: Path) -> Options:
    """The options with the corrections that lie beside the clip, where they name none."""
    beside = corrections_file(clip)
    if options.corrections is not None or not os.path.lexists(beside):
        return options
    return replace(options, corrections=parse_corrections(str(beside)))


def bake_into(
    outputs: Outputs,
    inputs: Sequence[Path],
    options: Options,
    cache: Cache | None = None,
    solve: IntervalSolver | None = None,
    progress: Progress = lambda stage, done, total: None,
    announce: Callable[[Sequence[Finding]], None] | None = None,
) -> tuple[Clip, list[HoldoutError]]:
    """Bake a plant and write its clip, and its report; see `baker.pipeline.bake_recorded`."""
    if cache is not None:
        solve = solve or partial(solve_intervals, workers=worker_count(options.workers))
        solve = cache.kept_intervals(solve)
    clip, record = bake_recorded(inputs, options, progress, solve, announce=announce)
    progress("writing", 0, 1)
    clip.save(outputs.clip)
    progress("writing", 1, 1)
    errors = verify(clip, record, progress)
    if outputs.report is not None:
        write_report(
            outputs.report,
            clip,
            record,
            errors,
            title=outputs.clip.name,
            workers=options.workers,
            report_progress=progress,
        )
    return clip, errors


def current_clip(job: PlantJob) -> Clip | None:
    """The job's clip if it is whole and what a bake would give, else None.

    The clip itself says what it was made of. It is current if the program and its packages have the
    same versions, the options are the same, and so are the scans: their names, order, times and the
    digests of their bytes. Raises InputError where the folder holds no series of scans.
    """
    path, report = job.outputs.clip, job.outputs.report
    if not path.exists() or (report and not report.exists()):
        return None
    if report and report.stat().st_mtime < path.stat().st_mtime:  # stopped between the two
        return None
    try:
        clip = gclip.open(path)
    except gclip.ClipError:
        return None
    listing = list_series([job.folder], job.options)
    series = listing.series
    resolved = job.options.for_series(series.fixed, series.length, series.root)
    moments = {scan.name: (scan.time, scan.date) for scan in series.scans}
    if any(moments.get(scan.name) != (scan.time, scan.date) for scan in clip.scans):
        return None
    expected = {
        **software((scan.path for scan in series.scans), job.options.outliers),
        "options": resolved.provenance(),
        "inputs": [{"name": s.name, "sha256": digest(listing.files(s))} for s in series.scans],
    }
    found = {key: clip.provenance.get(key) for key in expected}
    return clip if found == json.loads(json.dumps(expected)) else None  # tuples as lists
