"""The workers of a cluster, by dask.distributed.

Of many plants each is a task: workers read the scans and write the clips themselves, in folders
that all machines share, and only names, numbers and rows of traits travel. A window of plants is
under way at a time, so neither the scheduler nor this process ever holds much. The plants of a
worker that dies are given to others (up to `distributed.scheduler.allowed-failures` times).
Of one plant each interval is a task, which needs no folders.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from baker.batch.job import Outcome, PlantJob, bake_plant
from baker.batch.parallel import WorkerDied, as_they_complete
from baker.errors import InputError
from baker.geometry.parallel import ReportProgress
from baker.interpolation.interval_job import IntervalJob, IntervalSolver, solve_by
from baker.interpolation.provenance import software
from baker.options import worker_count
from gclip.clip import Interval
from gclip.terminal.command import OUR_FAULT

if TYPE_CHECKING:
    from distributed import Client

LOGS = ("distributed", "distributed.client", "distributed.nanny", "distributed.worker", "asyncio")
MAX_LOCAL_WORKERS = 256
PATIENCE = 5  # seconds that a scheduler has to answer
MIN_PLANTS_UNDER_WAY = 64  # so that a cluster that grows with its load does grow
CONFIG = {
    "distributed.worker.profile.enabled": False,  # its records grow for an hour
    "distributed.admin.large-graph-warning-threshold": "1TB",  # scans are large, and meant to go
}


def bake_on_cluster(
    jobs: Sequence[PlantJob], address: str, say: Callable[[str], None]
) -> Generator[Outcome]:
    """Bake with all workers of a cluster; outcomes come as they are ready.

    address: of the scheduler, or the name of its file; ``local`` or ``local:N`` starts workers.
    say: called with what the user should know meanwhile. Raises InputError where there is no
    dask.distributed, no scheduler, or a worker that can't take part.
    """
    missing = partial(_missing, _versions(), _folders(jobs))
    with _connected(address, missing) as client:

        def cores() -> int:
            return sum(client.nthreads().values())

        def window() -> int:
            return max(MIN_PLANTS_UNDER_WAY, 2 * cores())

        if not cores():
            say(f"{address} has no workers yet; it is waited for them")
        bake = partial(_bake_there, missing=missing, split=len(jobs) < cores())
        executor, whole = client.get_executor(pure=False), map(_absolute, jobs)
        try:
            for job, future in as_they_complete(executor, bake, whole, window):
                yield _outcome(job, future.result, address)
        finally:
            executor.shutdown(wait=False)


@contextmanager
def interval_solver(address: str) -> Iterator[IntervalSolver]:
    """Have one plant's intervals solved by a cluster. Raises InputError as `bake_on_cluster`."""
    with _connected(address, partial(_missing, _versions(), ())) as client:
        yield partial(_solve, client)


def _missing(versions: dict[str, str], folders: tuple[Path, ...]) -> str:
    """What the worker that calls this lacks of the same software and folders; empty for nothing."""
    found = _versions()
    for name, ours in versions.items():
        if found[name] != ours:
            return f"has {name} {found[name]}, but here it is {ours}; install the same on both"
    for folder in folders:
        if not folder.is_dir():
            return (
                f"does not see the folder '{folder}': scans and clips must lie where all "
                "machines find them under the same name"
            )
    return ""


def _bake_there(job: PlantJob, missing: Callable[[], str], split: bool) -> Outcome:
    """A task. Raises InputError where its worker can't take part.

    split: have the plant's intervals solved as tasks of their own.
    """
    from distributed import get_worker

    if lacks := missing():  # workers may have come after `_connected` checked them
        raise InputError(f"The cluster's worker {get_worker().address} {lacks}.")
    return bake_plant(job, _solve_from_worker if split else None)


def _solve(
    client: Client, jobs: Sequence[IntervalJob], report_progress: ReportProgress
) -> Iterator[Interval]:
    from distributed import KilledWorker

    try:
        yield from solve_by(client.get_executor(pure=False).map, jobs, report_progress)
    except KilledWorker as error:
        raise WorkerDied(error.allowed_failures + 1) from None


def _solve_from_worker(
    jobs: Sequence[IntervalJob], report_progress: ReportProgress
) -> Iterator[Interval]:
    """While a task waits for others, its worker takes some of them."""
    from distributed import worker_client

    with worker_client() as client:
        yield from _solve(client, jobs, report_progress)


def _outcome(job: PlantJob, result: Callable[[], Outcome], address: str) -> Outcome:
    from distributed import KilledWorker

    try:
        return result()
    except KilledWorker as error:
        died = WorkerDied(error.allowed_failures + 1)
        return Outcome(job.name, "failed", code=OUR_FAULT, error=str(died))
    except CancelledError:
        raise InputError(
            f"--cluster {address}: the scheduler is gone; the plants that are done stay done, and "
            "the same command does the others."
        ) from None
    except ImportError as error:
        raise InputError(f"A worker of the cluster lacks the program: {error}.") from None


@contextmanager
def _connected(address: str, missing: Callable[[], str]) -> Iterator[Client]:
    """A client of the cluster, or of one started here, whose workers have what they need."""
    try:
        import dask
        import distributed
    except ImportError:
        raise InputError(
            "--cluster needs dask.distributed, which is not installed: "
            'pip install "plant-growth-clips[cluster]"'
        ) from None
    with ExitStack() as stack:
        for log in map(logging.getLogger, LOGS):  # what goes wrong is reported in our own words
            stack.callback(log.setLevel, log.level)
            log.setLevel(logging.CRITICAL)
        stack.enter_context(dask.config.set(CONFIG))
        where: dict[str, Any] = {"address": address}
        if address.partition(":")[0] == "local":
            where["address"] = stack.enter_context(
                distributed.LocalCluster(
                    n_workers=_local_workers(address),
                    threads_per_worker=1,
                    dashboard_address=":0",
                    local_directory=stack.enter_context(TemporaryDirectory()),
                    silence_logs=logging.CRITICAL,
                )
            )
        elif Path(address).is_file():
            where = {"scheduler_file": address}
        try:
            client = distributed.Client(**where, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = str(error).strip().partition("\n")[0] or type(error).__name__
            raise InputError(
                f"--cluster {address}: no scheduler answers there within {PATIENCE} s; is it "
                f"running, and is that its address? ({reason})"
            ) from None
        stack.enter_context(client)
        for worker, lacks in client.run(missing, on_error="return").items():
            if isinstance(lacks, Exception):
                program = "ModuleNotFoundError" in repr(lacks)
                advice = "; install the program there, too" if program else ""
                lacks = f"can't take part ({lacks}){advice}"
            if lacks:
                raise InputError(f"The cluster's worker {worker} {lacks}.")
        yield client


def _local_workers(address: str) -> int:
    count = address.partition(":")[2]
    if count and not (count.isdecimal() and 0 < int(count[:9]) <= MAX_LOCAL_WORKERS):
        raise InputError(
            f"--cluster {address}: local:N starts N workers, from 1 to {MAX_LOCAL_WORKERS}, such "
            "as local:2."
        )
    return worker_count(int(count or 0))


def _versions() -> dict[str, str]:
    program, packages = software().values()
    return {program["name"]: program["version"], **packages, "distributed": version("distributed")}


def _folders(jobs: Sequence[PlantJob]) -> tuple[Path, ...]:
    outputs = [path for job in jobs for path in (job.folder, job.clip, job.report) if path]
    return tuple(sorted({_whole(path.parent) for path in outputs}))


def _absolute(job: PlantJob) -> PlantJob:
    """The job on one core, under names that hold in other processes' working folders."""
    times = job.options.times and _whole(job.options.times)
    options = replace(job.options, workers=1, times=times)
    report, cache = job.report and _whole(job.report), job.cache and _whole(job.cache)
    folder, clip = _whole(job.folder), _whole(job.clip)
    return replace(job, folder=folder, clip=clip, options=options, report=report, cache=cache)


def _whole(path: Path) -> Path:
    return Path(os.path.abspath(path))
