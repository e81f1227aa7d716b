"""Many plants: shared out, reported one by one, and listed in the end."""

import sys
from collections import Counter
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future, as_completed
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from baker.batch.cluster import bake_on_cluster
from baker.batch.outputs import Outputs, check_output
from baker.batch.parallel import process_pool
from baker.batch.plant import Outcome, PlantJob, WorkerDied, bake_plant
from baker.batch.progress import StageProgress
from baker.errors import InputError
from baker.geometry.parallel import worker_count
from baker.options import Options
from gclip.terminal.atomic import check_writable, writing
from gclip.terminal.command import DONE, OUR_FAULT
from gclip.text import Lossy, printable
from traits.plants import TraitsTable

ATTEMPTS = 2  # at a plant whose worker is killed


def bake_all(plants: Mapping[str, Path], options: Options, outputs: Outputs) -> int:
    """Bake each plant, report how it went, and go on whatever fails.

    Returns the exit code: 1 if the program was at fault anywhere, else 2 if any input was, else 0.
    Raises InputError where nothing can be begun with.
    """
    check_output(outputs.traits, True, "a table of traits", ".csv")  # what it holds stays known
    if options.corrections:
        raise InputError(
            "--corrections is for one plant; of many, each one's are found beside its clip."
        )
    for folder in filter(None, (outputs.clip, outputs.report)):
        _make_folder(folder)
    table = TraitsTable(outputs.traits) if outputs.traits else None
    jobs = [_job(name, plants[name], options, outputs, table) for name in plants]
    outcomes: dict[str, Outcome] = {}
    with StageProgress(outputs.quiet) as progress:
        progress("plants", 0, len(jobs))
        if outputs.cluster is None:
            found = bake_here(jobs, worker_count(options.workers))
        else:
            found = bake_on_cluster(jobs, outputs.cluster, progress.say)
        with closing(found):
            for outcome in found:
                _report(outcome, len(outcomes) + 1, len(jobs), progress, outputs.verbose)
                if table:
                    table.add(outcome.name, outcome.traits)
                outcomes[outcome.name] = replace(outcome, traits="", notes=())
    listed = [outcomes[name] for name in plants]
    if table:
        table.save(outcome.name for outcome in listed if outcome.state != "failed")
    lines = [] if outputs.quiet else _summary(listed, outputs, sum(progress.seconds.values()))
    if failed := [f"  {one.name}: {one.error}" for one in listed if one.state == "failed"]:
        lines += ["", f"{len(failed)} of {len(listed)} plants failed:", *failed]
    Lossy(sys.stderr).write("".join(f"{printable(line)}\n" for line in lines))
    codes = {outcome.code for outcome in listed}
    return OUR_FAULT if OUR_FAULT in codes else max(codes, default=DONE)


def bake_here(
    jobs: Sequence[PlantJob], workers: int, bake: Callable[[PlantJob], Outcome] = bake_plant
) -> Generator[Outcome]:
    """Bake in worker processes, one plant a core; where there are fewer plants, they share cores.

    Outcomes come as they are ready. Close the iterator to stop at once.
    """
    from pebble import ProcessExpired

    processes = max(1, min(workers, len(jobs)))
    cores = workers // processes
    jobs = [replace(job, options=replace(job.options, workers=cores)) for job in jobs]
    with process_pool(processes) as submit:
        for attempt in range(1, ATTEMPTS + 1):
            futures: dict[Future, PlantJob] = {submit(bake, job): job for job in jobs}
            jobs = []
            for future in as_completed(futures):
                job = futures.pop(future)  # and with it what came back
                try:
                    yield future.result()
                except ProcessExpired:
                    if attempt < ATTEMPTS:
                        jobs.append(job)
                    else:
                        yield WorkerDied(attempt).outcome(job)


def _report(
    outcome: Outcome, done: int, total: int, progress: StageProgress, verbose: bool
) -> None:
    progress("plants", done, total)
    if progress.plain or verbose or outcome.state == "failed":
        progress.say(f"{done}/{total}: {outcome.name} {outcome.state}, {outcome.seconds:.1f} s")
    for note in outcome.notes * verbose:
        progress.say(f"    {note}")


def _job(
    name: str, folder: Path, options: Options, outputs: Outputs, table: TraitsTable | None
) -> PlantJob:
    """The job under names that hold in other processes' working folders."""
    clip, report = outputs.clip / f"{name}.gclip", outputs.report
    own = replace(
        outputs,
        clip=clip.absolute(),
        report=report and (report / f"{name}.html").absolute(),
        cache=outputs.cache and outputs.cache.absolute(),
    )
    options = replace(options, times=options.times and options.times.absolute())
    known = table.known(name) if table else None
    return PlantJob(name, folder.absolute(), options, own, known)


def _make_folder(folder: Path) -> None:
    if folder.is_file() or folder.suffix.lower() in (".html", ".htm"):
        raise InputError(f"{folder} is a file's name; many plants' reports need a folder's.")
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    check_writable(folder)


def _summary(outcomes: Sequence[Outcome], outputs: Outputs, seconds: float) -> list[str]:
    """A line a plant, their sum, and where all was written."""
    width = max(5, *(len(outcome.name) for outcome in outcomes))
    row = f"{{:<{width}}}{{:>10}}{{:>10}}{{:>10}}{{:>10}}  {{}}".format
    lines = ["", row("plant", "scans", "tracks", "points", "seconds", "result")]
    for one in outcomes:
        counts = [f"{count:,}" if count else "" for count in (one.scans, one.tracks, one.points)]
        result = f"{one.state}: {one.looks}" if one.looks else one.state
        lines.append(row(one.name, *counts, f"{one.seconds:.1f}", result))
    states = Counter(one.state for one in outcomes)
    found = ", ".join(f"{states[s]:,} {s}" for s in ("baked", "unchanged", "failed") if states[s])
    plants = f"{len(outcomes):,} plant{'s' * (len(outcomes) != 1)}"
    points = sum(one.points for one in outcomes)
    lines.append(f"{plants}: {found}; {points:,} points in {seconds:.1f} s")
    places = (("clips", outputs.clip), ("reports", outputs.report), ("traits", outputs.traits))
    return lines + [f"{what}: {path}" for what, path in places if path is not None]
