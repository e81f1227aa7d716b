"""Bake all plants of a greenhouse: the one place where finding, sharing out and telling meet."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Generator, Sequence
from contextlib import closing, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path

from baker.batch.local import bake_here
from baker.batch.plant_traits import TraitsTable
from baker.batch.plants import Plant
from baker.batch.plants_progress import PlantProgress
from baker.batch.table import exit_code, result_lines, sum_line
from baker.batch.work import Job, Outcome
from baker.errors import InputError
from baker.options import Options, worker_count
from gclip.terminal.text import printable


@dataclass(frozen=True)
class Order:
    """What to do with all plants, besides the options of each.

    clips:   the folder of the clips; made if it is not there.
    reports: the folder of the reports, or none are written.
    traits:  the table of all plants' traits, or none is written.
    force:   bake plants whose clips stand, too.
    cluster: where a scheduler of dask.distributed listens; on this machine where None.
    cache:   the folder of finished intervals, or none are kept.
    """

    clips: Path
    reports: Path | None = None
    traits: Path | None = None
    force: bool = False
    cluster: str | None = None
    cache: Path | None = None
    quiet: bool = False
    verbose: bool = False


def bake_all(plants: Sequence[Plant], options: Options, order: Order) -> int:
    """Bake each plant, tell how each one went, go on whatever fails; returns the exit code.

    Raises InputError where nothing can be begun with.
    """
    began = time.perf_counter()
    for folder in (order.clips, order.reports):
        if folder is not None:
            _require_folder(folder)
    names = [plant.name for plant in plants]
    with closing(TraitsTable(order.traits)) if order.traits else nullcontext() as table:
        jobs = [_job(plant, options, order, table) for plant in plants]
        outcomes = []
        with (
            PlantProgress(len(jobs), order.quiet, order.verbose) as progress,
            closing(_outcomes(jobs, options, order, progress)) as found,
        ):
            for outcome in found:
                progress(outcome)
                if table:
                    table.add(outcome.name, outcome.traits)
                outcomes.append(replace(outcome, traits="", notes=()))
        place = {name: number for number, name in enumerate(names)}
        outcomes.sort(key=lambda one: place[one.name])
        if table:
            table.save(one.name for one in outcomes if one.state != "failed")
    _tell(outcomes, order, time.perf_counter() - began)
    return exit_code(outcomes)


def _outcomes(
    jobs: Sequence[Job], options: Options, order: Order, progress: PlantProgress
) -> Generator[Outcome, None, None]:
    if order.cluster is None:
        return bake_here(jobs, worker_count(options.workers))
    from baker.batch.cluster import bake_on_cluster

    return bake_on_cluster(jobs, order.cluster, progress.say)


def _job(plant: Plant, options: Options, order: Order, table: TraitsTable | None) -> Job:
    return Job(
        name=plant.name,
        folder=plant.folder,
        clip=order.clips / f"{plant.name}.gclip",
        options=options,
        report=order.reports / f"{plant.name}.html" if order.reports else None,
        traits=table is not None,
        known=table.known(plant.name) if table else None,
        force=order.force,
        cache=order.cache,
    )


def _require_folder(folder: Path) -> None:
    """Made if it is not there yet."""
    if folder.is_file() or folder.suffix.lower() in (".html", ".htm"):
        raise InputError(f"{folder} is a file's name; many plants' reports need a folder's.")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} can't be made: {error.strerror or error}.") from None
    if not os.access(folder, os.W_OK):
        raise InputError(f"{folder} can't be written to.")


def _tell(outcomes: Sequence[Outcome], order: Order, seconds: float) -> None:
    """The table and the sum, then what failed with its sentence: that even when quiet."""
    lines: list[str] = []
    if not order.quiet:
        lines += ["", *result_lines(outcomes), sum_line(outcomes, seconds)]
        lines += [f"{what}: {path}" for what, path in _written(order)]
    failed = [one for one in outcomes if one.state == "failed"]
    if failed:
        lines += ["", f"{len(failed)} of {len(outcomes)} plants failed:"]
        lines += [f"  {one.name}: {one.error}" for one in failed]
    if lines:
        print("\n".join(map(printable, lines)), file=sys.stderr)


def _written(order: Order) -> list[tuple[str, Path]]:
    places = (("clips", order.clips), ("reports", order.reports), ("traits", order.traits))
    return [(what, path) for what, path in places if path is not None]
