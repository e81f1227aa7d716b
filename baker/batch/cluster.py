"""The workers of a cluster, by dask.distributed.

Of many plants each is a task: workers read the scans and write the clips themselves, in folders
that all machines share, and only names, numbers and rows of traits travel. The plants of a worker
that dies are given to others (up to `distributed.scheduler.allowed-failures` times). Of one plant
each interval is a task, which needs no folders.
"""

import logging
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from baker.batch.plant import Outcome, PlantJob, WorkerDied, bake_plant
from baker.errors import InputError
from baker.geometry.parallel import ReportProgress
from baker.interpolation.interval_job import IntervalJob, IntervalSolver, solve_by
from baker.interpolation.provenance import software
from gclip.clip import Interval

if TYPE_CHECKING:
    from distributed import Client

LOGS = ("distributed", "distributed.client", "distributed.worker", "asyncio")
PATIENCE = 5  # seconds that a scheduler has to answer
CONFIG = {"distributed.admin.large-graph-warning-threshold": "1TB"}  # scans are meant to travel


def bake_on_cluster(
    jobs: Sequence[PlantJob], address: str, say: Callable[[str], None]
) -> Generator[Outcome]:
    """Bake with all workers of a cluster; outcomes come as they are ready.

    address: of the scheduler, or the name of its file. say: called with what the user should know
    meanwhile. Raises InputError where there is no dask.distributed, no scheduler, or a worker that
    can't take part.
    """
    with _connected(address) as client:
        cores = sum(client.nthreads().values())
        if not cores:
            say(f"{address} has no workers yet; it is waited for them")
        # Where there are fewer plants than cores, a plant's intervals are tasks of their own.
        solve = _solve_from_worker if len(jobs) < cores else None
        bake, executor = Checked(partial(bake_plant, solve=solve)), client.get_executor(pure=False)
        jobs = [replace(job, options=replace(job.options, workers=1)) for job in jobs]
        futures = {executor.submit(bake, job): job for job in jobs}
        try:
            for future in as_completed(futures):
                job = futures.pop(future)  # and with it what came back
                try:
                    with _task_faults():
                        yield future.result()
                except WorkerDied as died:
                    yield died.outcome(job)
        finally:
            executor.shutdown(wait=False)


@contextmanager
def interval_solver(address: str) -> Iterator[IntervalSolver]:
    """Have one plant's intervals solved by a cluster. Raises InputError as `bake_on_cluster`."""
    with _connected(address) as client:
        yield partial(_solve, client)


def versions() -> dict[str, str]:
    """Of this program and its packages, by name."""
    program, packages = software().values()
    return {program["name"]: program["version"], **packages, "distributed": version("distributed")}


@dataclass(frozen=True)
class Checked:
    """A task, done by workers that have the versions of here; others raise InputError.

    Each task checks it, as workers come and go.
    """

    function: Callable[[Any], Any]
    versions: dict[str, str] = field(default_factory=versions)

    def __call__(self, job: Any) -> Any:
        from distributed import get_worker

        found = versions()
        for name, ours in self.versions.items():
            if found[name] != ours:
                raise InputError(
                    f"The cluster's worker {get_worker().address} has {name} {found[name]}, but "
                    f"here it is {ours}; install the same on both."
                )
        return self.function(job)


def _solve(
    client: "Client", jobs: Sequence[IntervalJob], report_progress: ReportProgress
) -> Iterator[Interval]:
    def map_on_cluster(function: Callable, jobs: Sequence[IntervalJob]) -> Iterator[Interval]:
        return client.get_executor(pure=False).map(Checked(function), jobs)

    with _task_faults():
        yield from solve_by(map_on_cluster, jobs, report_progress)


def _solve_from_worker(
    jobs: Sequence[IntervalJob], report_progress: ReportProgress
) -> Iterator[Interval]:
    """While a task waits for others, its worker takes some of them."""
    from distributed import worker_client

    with worker_client() as client:
        yield from _solve(client, jobs, report_progress)


@contextmanager
def _task_faults() -> Iterator[None]:
    """What dask raises about a task, in a sentence."""
    from distributed import KilledWorker

    try:
        yield
    except KilledWorker as error:
        raise WorkerDied(error.allowed_failures + 1) from None
    except CancelledError:
        raise InputError(
            "The cluster's scheduler is gone; the plants that are done stay done, and the same "
            "command does the others."
        ) from None
    except ImportError as error:
        raise InputError(
            f"A worker of the cluster lacks the program ({error}); install it there, too."
        ) from None


@contextmanager
def _connected(address: str) -> Iterator["Client"]:
    try:
        import dask
        import distributed
    except ImportError:
        raise InputError(
            "--cluster needs dask.distributed, which is not installed: "
            'pip install "plant-growth-clips[cluster]"'
        ) from None
    for log in LOGS:  # what goes wrong is reported in our own words
        logging.getLogger(log).setLevel(logging.CRITICAL)
    place = {"scheduler_file" if Path(address).is_file() else "address": address}
    with dask.config.set(CONFIG):
        try:
            client = distributed.Client(**place, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = str(error).strip().partition("\n")[0] or type(error).__name__
            raise InputError(
                f"--cluster {address}: no scheduler answers there within {PATIENCE} s; is it "
                f"running, and is that its address? ({reason})"
            ) from None
        with client:
            yield client
