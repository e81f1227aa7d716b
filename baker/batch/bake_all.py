"""Bake many plants in worker processes or on a cluster, and report on each of them."""

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, as_completed
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryFile

from baker.batch.plant import Outcome, PlantJob, bake_plant
from baker.batch.workers import Submit, cluster_pool, process_pool
from baker.errors import InputError
from baker.geometry.parallel import worker_count
from baker.options import Options, Outputs
from gclip.terminal.atomic import writing
from gclip.terminal.command import DONE, OUR_FAULT
from gclip.terminal.progress import StageProgress
from gclip.text import Lossy, printable
from traits.plants import TraitsTable


def bake_all(plants: Mapping[str, Path], options: Options, outputs: Outputs) -> int:
    """Bake many plants; if one fails, continue with the others.

    plants: folders of scans by name. outputs: the clip and the report are folders. Returns the exit
    code: 1 if the program was at fault for any plant, else 2 if any input was, else 0. Raises
    InputError if no plant can be baked with these options and outputs.
    """
    if options.corrections:
        raise InputError(
            "--corrections is for one plant; of many, each one's are found beside its clip."
        )
    for folder in filter(None, (outputs.clip, outputs.report)):
        _make_folder(folder)
    table = TraitsTable(outputs.traits) if outputs.traits else None
    workers = worker_count(options.workers)
    processes = max(1, min(workers, len(plants)))  # if plants are fewer, each uses several cores
    options = replace(options, workers=1 if outputs.cluster else workers // processes)
    jobs = [_job(name, folder, options, outputs, table) for name, folder in plants.items()]
    outcomes: dict[str, Outcome] = {}
    with StageProgress(outputs.quiet) as progress:
        progress("plants", 0, len(jobs))
        address = outputs.cluster
        pool = cluster_pool(address, progress.say) if address else process_pool(processes)
        with pool as submit:
            for outcome in bake_plants(submit, jobs):
                if table:
                    table.add(outcome.name, outcome.traits)
                outcomes[outcome.name] = replace(outcome, traits="", notes=())
                progress("plants", len(outcomes), len(jobs))
                if progress.plain or outputs.verbose or outcome.state == "failed":
                    done = f"{len(outcomes)}/{len(jobs)}: {outcome.name} {outcome.state}"
                    progress.say(f"{done}, {outcome.seconds:.1f} s")
                for note in outcome.notes * outputs.verbose:
                    progress.say(f"    {note}")
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
    submit: Submit, jobs: Sequence[PlantJob], bake: Callable[[PlantJob], Outcome] = bake_plant
) -> Iterator[Outcome]:
    """Bake plants as tasks of workers, and yield their outcomes as soon as they are ready."""
    futures = {submit(bake, job): job for job in jobs}
    for future in as_completed(futures):
        job = futures.pop(future)  # frees the result as well
        try:
            outcome = future.result()
        except CancelledError:
            raise InputError(
                "The cluster's scheduler is gone; the plants that are done stay done, and the same "
                "command does the others."
            ) from None
        except Exception as error:  # of the worker, since `bake_plant` returns its exceptions
            reason = str(error).partition(". ")[0]
            sentence = (
                f"its worker ended without a result ({reason}); most likely the scans need more "
                "memory than there is: try fewer points (--voxel, --resample) or fewer processes "
                "(--workers)."
            )
            outcome = Outcome(job.name, "failed", code=OUR_FAULT, error=sentence)
        yield outcome


def _job(
    name: str, folder: Path, options: Options, outputs: Outputs, table: TraitsTable | None
) -> PlantJob:
    """The job of one plant, with absolute paths, since workers may have other working folders."""
    plant_outputs = replace(
        outputs,
        clip=outputs.clip.absolute() / f"{name}.gclip",
        report=outputs.report and outputs.report.absolute() / f"{name}.html",
        cache=outputs.cache and outputs.cache.absolute(),
    )
    options = replace(options, times=options.times and options.times.absolute())
    return PlantJob(
        name, folder.absolute(), options, plant_outputs, table.source_of(name) if table else None
    )


def _make_folder(folder: Path) -> None:
    """Make a folder for outputs; raises UserError if it can't be made or written to."""
    if folder.is_file() or folder.suffix.lower() in (".html", ".htm", ".gclip"):
        raise InputError(f"{folder} is a file's name; the outputs of many plants need a folder.")
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=folder).close()  # raises OSError if no file can be written there


def _summary(outcomes: Sequence[Outcome], outputs: Outputs, seconds: float) -> list[str]:
    """A table with a line for each plant, their total, and the paths of the outputs."""
    width = max(5, *(len(outcome.name) for outcome in outcomes))
    row = f"{{:<{width}}}{{:>10}}{{:>10}}{{:>10}}{{:>10}}  {{}}".format
    lines = ["", row("plant", "scans", "tracks", "points", "seconds", "result")]
    for plant in outcomes:
        counts = [f"{count:,}" if count else "" for count in plant.sizes]
        result = f"{plant.state}: {plant.looks}" if plant.looks else plant.state
        lines.append(row(plant.name, *counts, f"{plant.seconds:.1f}", result))
    states = Counter(plant.state for plant in outcomes)
    counted = ", ".join(f"{states[s]:,} {s}" for s in ("baked", "unchanged", "failed") if states[s])
    plants = f"{len(outcomes):,} plant{'s' * (len(outcomes) != 1)}"
    points = sum(plant.sizes[-1] for plant in outcomes)
    lines.append(f"{plants}: {counted}; {points:,} points in {seconds:.1f} s")
    paths = (("clips", outputs.clip), ("reports", outputs.report), ("traits", outputs.traits))
    return lines + [f"{kind}: {path}" for kind, path in paths if path is not None]
