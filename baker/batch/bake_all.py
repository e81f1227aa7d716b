"""Bake many plants in worker processes or on a cluster, and report on each of them."""

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryFile

from baker.batch.cluster import cluster_pool, task_errors
from baker.batch.outputs import Outputs, check_output
from baker.batch.parallel import Submit, WorkerDied, process_pool
from baker.batch.plant import Outcome, PlantJob, bake_plant
from baker.errors import InputError
from baker.geometry.parallel import worker_count
from baker.options import Options
from gclip.terminal.atomic import writing
from gclip.terminal.command import DONE, OUR_FAULT
from gclip.terminal.progress import StageProgress
from gclip.text import Lossy, printable
from traits.plants import TraitsTable


def bake_all(plants: Mapping[str, Path], options: Options, outputs: Outputs) -> int:
    """Bake many plants, folders of scans by name; if one fails, go on with the others.

    outputs: the clip and the report are folders. Returns the exit code: 1 if the program was at
    fault for any plant, else 2 if any input was, else 0. Raises InputError if no plant can be baked
    with these options and outputs.
    """
    check_output(outputs.traits, True, "a table of traits", ".csv")  # an old table is extended
    if options.corrections:
        raise InputError(
            "--corrections is for one plant; of many, each one's are found beside its clip."
        )
    for folder in filter(None, (outputs.clip, outputs.report)):
        _make_folder(folder)
    table = TraitsTable(outputs.traits) if outputs.traits else None
    jobs = [_job(name, plants[name], options, outputs, table) for name in plants]
    workers = worker_count(options.workers)
    processes = max(1, min(workers, len(jobs)))  # fewer plants than cores use several cores each
    outcomes: dict[str, Outcome] = {}
    with StageProgress(outputs.quiet) as progress:
        progress("plants", 0, len(jobs))
        if outputs.cluster:
            pool, cores = cluster_pool(outputs.cluster, progress.say), 1
        else:
            pool, cores = process_pool(processes), workers // processes
        with pool as submit:
            errors = task_errors if outputs.cluster else nullcontext
            for outcome in bake_plants(submit, jobs, cores, errors):
                _report(outcome, len(outcomes) + 1, len(jobs), progress, outputs.verbose)
                if table:
                    table.add(outcome.name, outcome.traits)
                outcomes[outcome.name] = replace(outcome, traits="", notes=())
    listed = [outcomes[name] for name in plants]
    if table:
        table.save(outcome.name for outcome in listed if outcome.state != "failed")
    lines = [] if outputs.quiet else _summary(listed, outputs, sum(progress.seconds.values()))
    if failed := [f"  {plant.name}: {plant.error}" for plant in listed if plant.state == "failed"]:
        lines += ["", f"{len(failed)} of {len(listed)} plants failed:", *failed]
    Lossy(sys.stderr).write("".join(f"{printable(line)}\n" for line in lines))
    codes = {outcome.code for outcome in listed}
    return OUR_FAULT if OUR_FAULT in codes else max(codes, default=DONE)


def bake_plants(
    submit: Submit,
    jobs: Sequence[PlantJob],
    cores: int,
    task_errors: Callable[[], AbstractContextManager[None]] = nullcontext,
    bake: Callable[[PlantJob], Outcome] = bake_plant,
) -> Iterator[Outcome]:
    """Bake plants as tasks of an executor; yields their outcomes as soon as they are ready.

    cores: number of cores for each plant; task_errors: a context that may raise WorkerDied.
    """
    jobs = [replace(job, options=replace(job.options, workers=cores)) for job in jobs]
    futures = {submit(bake, job): job for job in jobs}
    for future in as_completed(futures):
        job = futures.pop(future)  # frees the result as well
        try:
            with task_errors():
                outcome = future.result()
        except WorkerDied as died:
            outcome = Outcome(job.name, "failed", code=OUR_FAULT, error=str(died))
        yield outcome


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
    """The job of one plant, with absolute paths, since workers may have other working folders."""
    current = Path.cwd()
    plant_outputs = replace(
        outputs,
        clip=current / outputs.clip / f"{name}.gclip",
        report=outputs.report and current / outputs.report / f"{name}.html",
        cache=outputs.cache and current / outputs.cache,
    )
    options = replace(options, times=options.times and current / options.times)
    known = table.known(name) if table else None
    return PlantJob(name, current / folder, options, plant_outputs, known)


def _make_folder(folder: Path) -> None:
    if folder.is_file() or folder.suffix.lower() in (".html", ".htm", ".gclip"):
        raise InputError(f"{folder} is a file's name; the outputs of many plants need a folder.")
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=folder).close()  # whether files can be written there


def _summary(outcomes: Sequence[Outcome], outputs: Outputs, seconds: float) -> list[str]:
    """A table with a line for each plant, their total, and the paths of the outputs."""
    width = max(5, *(len(outcome.name) for outcome in outcomes))
    row = f"{{:<{width}}}{{:>10}}{{:>10}}{{:>10}}{{:>10}}  {{}}".format
    lines = ["", row("plant", "scans", "tracks", "points", "seconds", "result")]
    for plant in outcomes:
        sizes = (plant.scans, plant.tracks, plant.points)
        counts = [f"{count:,}" if count else "" for count in sizes]
        result = f"{plant.state}: {plant.looks}" if plant.looks else plant.state
        lines.append(row(plant.name, *counts, f"{plant.seconds:.1f}", result))
    states = Counter(plant.state for plant in outcomes)
    found = ", ".join(f"{states[s]:,} {s}" for s in ("baked", "unchanged", "failed") if states[s])
    plants = f"{len(outcomes):,} plant{'s' * (len(outcomes) != 1)}"
    points = sum(plant.points for plant in outcomes)
    lines.append(f"{plants}: {found}; {points:,} points in {seconds:.1f} s")
    paths = (("clips", outputs.clip), ("reports", outputs.report), ("traits", outputs.traits))
    return lines + [f"{kind}: {path}" for kind, path in paths if path is not None]
