"""Bake one plant and write its outputs, in this process or in a worker."""

import io
import json
import os
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import gclip
from baker.batch.cache import Cache
from baker.interpolation.provenance import software
from baker.options import Options, Outputs, parse_corrections
from baker.pipeline import Progress, bake_with_survey
from baker.report.page import write_report
from baker.scans.read import digest, list_series
from baker.scans.scan import Finding
from corrections import corrections_file
from gclip.clip import Clip
from gclip.terminal.command import OUR_FAULT, verdict
from traits.holdout_error import HoldoutError, verify
from traits.table import NamedPlant, measure_days, provenance, write_table


@dataclass(frozen=True)
class PlantJob:
    """One plant of many that a worker bakes."""

    name: str
    folder: Path  # of its scans
    options: Options
    outputs: Outputs  # of this plant
    listed: tuple[str, str] | None = None  # `provenance` of the traits in an existing table


@dataclass(frozen=True)
class Outcome:
    """The result of one plant's bake."""

    name: str
    state: Literal["baked", "unchanged", "failed"]
    sizes: tuple[int, int, int] = (0, 0, 0)  # numbers of scans, tracks, and points of all scans
    seconds: float = 0.0  # wall clock time
    code: int = 0  # 0, or the exit code of the failure in `error`
    error: str = ""
    traits: str = ""  # rows of the table; "" if not requested, or in the table already
    notes: tuple[str, ...] = ()  # decisions and notes of the clip's provenance
    looks: str = ""  # the verdict's first clause, such as "7 of 8 intervals look right"


def bake_plant(job: PlantJob) -> Outcome:
    """Bake one plant unless its clip is up to date. Exceptions are returned in the outcome."""
    start, outputs = time.perf_counter(), job.outputs
    try:
        job = replace(job, options=with_corrections(job.options, outputs.clip))
        clip = None if outputs.force else current_clip(job)
        state: Literal["baked", "unchanged"] = "unchanged" if clip else "baked"
        if clip is None:
            cache = Cache(outputs.cache) if outputs.cache else None
            outputs = replace(outputs, force=True)
            clip, _ = bake_into(outputs, [job.folder], job.options, cache)
        table = io.StringIO()
        if outputs.traits and provenance(clip) != job.listed:
            write_table(table, NamedPlant(clip, job.name), measure_days(clip))
    except Exception as error:
        code, sentence = verdict(error)
        if code == OUR_FAULT and os.environ.get("GCLIP_TRACEBACK"):
            traceback.print_exc()
        seconds = time.perf_counter() - start
        return Outcome(job.name, "failed", seconds=seconds, code=code, error=sentence)
    line, points = clip.provenance["verdict"]["line"], sum(scan.points for scan in clip.scans)
    return Outcome(
        job.name,
        state,
        sizes=(len(clip.scans), len(clip.track_table), points),
        seconds=time.perf_counter() - start,
        traits=table.getvalue().partition("\n")[2],
        notes=(*clip.provenance["decisions"], *clip.provenance["notes"], line),
        looks=line.partition(";")[0].rstrip("."),
    )


def with_corrections(options: Options, clip: Path) -> Options:
    """Add the corrections in the file next to the clip, unless the options have corrections."""
    file = corrections_file(clip)
    if options.corrections is not None or not os.path.lexists(file):
        return options
    return replace(options, corrections=parse_corrections(str(file)))


def bake_into(
    outputs: Outputs,
    inputs: Sequence[Path],
    options: Options,
    cache: Cache | None = None,
    progress: Progress = lambda stage, done, total: None,
    report_findings: Callable[[Sequence[Finding]], None] | None = None,
) -> tuple[Clip, list[HoldoutError]]:
    """Bake a plant, write its clip and report, and compare it with the scans held out.

    inputs: a folder of scans, or the scans' files. cache: of solved intervals. options, progress,
    report_findings: as in `bake_with_survey`. Returns the clip and its distances from these scans.
    """
    solve = cache.solve_intervals if cache else None
    clip, survey = bake_with_survey(
        inputs, options, progress, solve, report_findings=report_findings
    )
    progress("writing", 0, 1)
    clip.save(outputs.clip, outputs.force)  # raises if another bake has written it meanwhile
    progress("writing", 1, 1)
    errors = verify(clip, progress)
    if outputs.report is not None:
        title = outputs.clip.name
        write_report(outputs.report, clip, survey, errors, title=title, report_progress=progress)
    return clip, errors


def current_clip(job: PlantJob) -> Clip | None:
    """Read the job's clip if it is complete and up to date, else None.

    It is up to date if its provenance has the same versions of the program and its packages, the
    same options and the same scans: names, order, times and digests. Raises InputError if the
    folder holds no series of scans.
    """
    path, report = job.outputs.clip, job.outputs.report
    try:
        clip = gclip.open(path)
        if report and report.stat().st_mtime < path.stat().st_mtime:  # of an earlier bake
            return None
    except (OSError, gclip.ClipError):
        return None
    listing = list_series([job.folder], job.options)
    series = listing.series
    resolved = job.options.for_series(series.fixed, series.length, series.root)
    expected = {
        **software((scan.path for scan in series.scans), job.options.outliers),
        "options": resolved.provenance(),
        "inputs": [{"name": s.name, "sha256": digest(listing.files(s))} for s in series.scans],
    }
    times = {(scan.name, scan.time, scan.date) for scan in series.scans}
    is_current = times >= {(scan.name, scan.time, scan.date) for scan in clip.scans}
    actual = {key: clip.provenance.get(key) for key in expected}
    is_current &= actual == json.loads(json.dumps(expected))  # tuples as lists
    return clip if is_current else None
