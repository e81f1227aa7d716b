"""Bake on the workers of a cluster with dask.distributed.

Of many plants, each is a task: the workers read the scans and write the clips in folders that all
machines share. If a worker dies, its plants are given to others (up to
`distributed.scheduler.allowed-failures` times). Of one plant, each interval is a task, which needs
no shared folder.
"""

import logging
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

from baker.batch.parallel import Submit, WorkerDied
from baker.errors import InputError
from baker.geometry.parallel import ReportProgress
from baker.interpolation.interval_job import IntervalJob, IntervalSolver, solve_by
from baker.interpolation.provenance import software
from gclip.clip import Interval

LOGS = ("distributed", "distributed.client", "distributed.worker", "asyncio")
TIMEOUT = 5  # seconds to connect to a scheduler
CONFIG = {"distributed.admin.large-graph-warning-threshold": "1TB"}  # jobs contain scans


@contextmanager
def cluster_pool(address: str, say: Callable[[str], None]) -> Iterator[Submit]:
    """The workers of a cluster; yields the function that submits tasks to them.

    address: of the scheduler, or the name of the scheduler's file; say: called with messages for
    the user. Raises InputError if dask.distributed is not installed, no scheduler answers, or a
    worker has other versions.
    """
    with _connected(address) as client:
        if not client.nthreads():
            say(f"{address} has no workers yet; it is waited for them")
        executor, ours = client.get_executor(pure=False), versions()
        try:
            yield lambda function, job: executor.submit(Checked(function, ours), job)
        finally:
            executor.shutdown(wait=False)


@contextmanager
def interval_solver(address: str) -> Iterator[IntervalSolver]:
    """A solver of one plant's intervals on a cluster. Raises InputError as `cluster_pool`."""
    with _connected(address) as client:
        yield partial(_solve, client)


def versions() -> dict[str, str]:
    """The versions of this program and of its packages, by name."""
    program, packages = software().values()
    return {program["name"]: program["version"], **packages, "distributed": version("distributed")}


@dataclass(frozen=True)
class Checked:
    """A task that raises InputError on workers that have other versions than this process.

    Every task checks, since workers may join at any time.
    """

    function: Callable[[Any], Any]
    versions: dict[str, str] = field(default_factory=versions)

    def __call__(self, job: Any) -> Any:
        from distributed import get_worker

        for name, found in versions().items():
            if found != (ours := self.versions.get(name)):
                raise InputError(
                    f"The cluster's worker {get_worker().address} has {name} {found}, but here it "
                    f"is {ours}; install the same on both."
                )
        return self.function(job)


def _solve(
    client: Any, jobs: Sequence[IntervalJob], report_progress: ReportProgress
) -> Iterator[Interval]:
    executor = client.get_executor(pure=False)
    with task_errors():
        yield from solve_by(
            lambda solve, jobs: executor.map(Checked(solve), jobs), jobs, report_progress
        )


@contextmanager
def task_errors() -> Iterator[None]:
    """Turn exceptions of dask about a task into ours, with a sentence for the user."""
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
def _connected(address: str) -> Iterator[Any]:
    """A `distributed.Client` of the scheduler."""
    try:
        import dask
        import distributed
    except ImportError:
        raise InputError(
            "--cluster needs dask.distributed, which is not installed: "
            'pip install "plant-growth-clips[cluster]"'
        ) from None
    for log in LOGS:  # errors are raised as InputError instead
        logging.getLogger(log).setLevel(logging.CRITICAL)
    scheduler = {"scheduler_file" if Path(address).is_file() else "address": address}
    with dask.config.set(CONFIG):
        try:
            client = distributed.Client(**scheduler, timeout=TIMEOUT, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = str(error).strip().partition("\n")[0] or type(error).__name__
            raise InputError(
                f"--cluster {address}: no scheduler answers there within {TIMEOUT} s; is it "
                f"running, and is that its address? ({reason})"
            ) from None
        with client:
            yield client
