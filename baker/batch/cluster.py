"""Plants shared out among the workers of a cluster, with dask.distributed.

Workers read the scans and write the clips themselves, in folders that all machines share: only
names, numbers and rows of traits travel. A window of plants is under way at a time, so neither
the scheduler nor this process ever holds much, however many plants there are. A worker that dies
costs nothing: the scheduler gives its plants to others (up to `distributed.scheduler.
allowed-failures` times, 3 by default), and a clip is written whole or not at all.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import cache
from importlib.metadata import version
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from baker.batch.local import lost, with_cores
from baker.batch.work import Job, Outcome, bake_plant
from baker.errors import InputError

if TYPE_CHECKING:
    from distributed import Client, Future

    from baker.batch.executor import Executor

LOGS = ("distributed", "distributed.client", "distributed.nanny", "distributed.worker", "asyncio")
MOST_LOCAL = 256  # workers on one machine
PATIENCE = 5  # seconds that a scheduler has to answer
WINDOW = 64  # plants under way at least, so that a cluster that grows with its load does grow
LEAN = {"distributed.worker.profile.enabled": False}  # its records grow for an hour
LOOK_AGAIN = 5  # seconds until workers are counted anew


def bake_on_cluster(
    jobs: Sequence[Job], address: str, say: Callable[[str], None]
) -> Generator[Outcome, None, None]:
    """Bake with all workers of the cluster at `address`; outcomes come as they are ready.

    address: where the scheduler listens, the name of its scheduler file, or `local` or `local:N`
             for N workers that are started here.
    say:     called with what is worth telling meanwhile.

    Raises InputError: no dask.distributed, nobody there, or a worker that can't take part.
    """
    need = _need(jobs)
    with connected(address) as client:
        _require_fit(client, need)
        if not client.nthreads():
            say(f"{address} has no workers yet; it is waited for them")
        yield from _bake(client, address, jobs, need)


@contextmanager
def intervals_on(address: str) -> Iterator[Executor]:
    """Where one plant's intervals are solved by the cluster, the rest here: its workers need no
    folders. Raises InputError as `bake_on_cluster` does.
    """
    from baker.batch.cluster_intervals import ClusterIntervals

    with connected(address) as client:
        _require_fit(client, Need(_software(), ()))
        yield ClusterIntervals(lambda: nullcontext(client))


@contextmanager
def connected(address: str) -> Iterator[Client]:
    """A client of the cluster, or of one started here; closed at the end.

    Raises InputError where dask.distributed is missing or nobody answers.
    """
    try:
        import dask
        import distributed
    except ImportError:
        raise InputError(
            "--cluster needs dask.distributed, which is not installed: "
            'pip install "plant-growth-clips[cluster]"'
        ) from None
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        where: dict[str, Any] = {"address": address}
        if address.partition(":")[0] == "local":
            stack.enter_context(dask.config.set(LEAN))
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
            raise InputError(
                f"--cluster {address}: no scheduler answers there within {PATIENCE} s; is it "
                f"running, and is that its address? ({_first_line(error)})"
            ) from None
        yield stack.enter_context(client)


@dataclass(frozen=True)
class Need:
    """What every worker must have: the same software, for the same bytes, and the folders."""

    software: dict[str, str]
    folders: tuple[Path, ...]

    def missing(self) -> str:
        """What the worker that calls this lacks; "" where it fits."""
        found = _software()
        for name, ours in self.software.items():
            theirs = found[name]
            if theirs != ours:
                return f"has {name} {theirs}, but here it is {ours}; install the same on both"
        for folder in self.folders:
            if not folder.is_dir():
                return (
                    f"does not see the folder '{folder}': scans and clips must lie where all "
                    "machines find them under the same name"
                )
        return ""


def bake_there(job: Job, need: Need, split: bool) -> Outcome:
    """A task: runs on a worker. Raises InputError where that can't take part.

    split: have the plant's intervals solved as tasks of their own.
    """
    from baker.batch.cluster_intervals import on_this_worker

    missing = need.missing()
    if missing:
        raise InputError(_unfit(_own_address(), missing))
    return bake_plant(job, on_this_worker() if split else None)


def _bake(
    client: Client, address: str, jobs: Sequence[Job], need: Need
) -> Generator[Outcome, None, None]:
    from distributed import as_completed

    waiting = (with_cores(_absolute(job), 1) for job in jobs)
    under_way: dict[Future, Job] = {}
    ready = as_completed([], loop=client.loop)
    cores, counted = 0, float("-inf")
    try:
        while True:
            if time.monotonic() - counted > LOOK_AGAIN:
                cores = sum(client.nthreads().values())
                counted = time.monotonic()
            window = max(WINDOW, 2 * cores)
            for job in islice(waiting, window - len(under_way)):
                # A window full of plants keeps all cores busy; few plants share their intervals.
                split = len(jobs) < cores
                future = client.submit(bake_there, job, need, split, pure=False)
                under_way[future] = job
                ready.add(future)
            if not under_way:
                return
            future = next(ready)
            yield _outcome(future, under_way.pop(future), address)
    finally:
        if under_way:
            client.cancel(list(under_way), force=True)


def _outcome(future: Future, job: Job, address: str) -> Outcome:
    from concurrent.futures import CancelledError

    from distributed import KilledWorker

    try:
        found: Outcome = future.result()
    except KilledWorker as error:
        return lost(job.name, f"its worker died {error.allowed_failures + 1} times")
    except CancelledError:
        raise InputError(
            f"--cluster {address}: the scheduler is gone; the plants that are done stay done, and "
            "the same command does the others."
        ) from None
    except ImportError as error:
        raise InputError(f"A worker of the cluster lacks the program: {error}.") from None
    return found


def _require_fit(client: Client, need: Need) -> None:
    """Ask every worker there is; those that come later are asked with each plant."""
    for worker, missing in client.run(need.missing, on_error="return").items():
        if isinstance(missing, Exception):
            lacks = "ModuleNotFoundError" in repr(missing)
            advice = "; install the program there, too" if lacks else ""
            missing = f"can't take part ({missing}){advice}"
        if missing:
            raise InputError(_unfit(worker, missing))


def _unfit(worker: str, missing: str) -> str:
    return f"The cluster's worker {worker} {missing}."


def _own_address() -> str:
    from distributed import get_worker

    return str(get_worker().address)


def _need(jobs: Sequence[Job]) -> Need:
    folders = {job.clip.parent for job in jobs} | {job.folder.parent for job in jobs}
    folders |= {job.report.parent for job in jobs if job.report is not None}
    return Need(_software(), tuple(sorted(map(_whole, folders))))


@cache
def _software() -> dict[str, str]:
    from baker.batch.provenance import software

    ours = software()
    program = {ours["program"]["name"]: ours["program"]["version"]}
    return {**program, **ours["packages"], "distributed": version("distributed")}


def _absolute(job: Job) -> Job:
    """Under names that hold in other processes' working folders."""
    options = job.options
    if options.times is not None:
        options = replace(options, times=_whole(options.times))
    return replace(
        job,
        folder=_whole(job.folder),
        clip=_whole(job.clip),
        options=options,
        report=None if job.report is None else _whole(job.report),
        cache=None if job.cache is None else _whole(job.cache),
    )


def _whole(path: Path) -> Path:
    return Path(os.path.abspath(path))


def _local_workers(address: str) -> int:
    from baker.options import worker_count

    count = address.partition(":")[2]
    if count and not (count.isdecimal() and 0 < int(count[:9]) <= MOST_LOCAL):
        raise InputError(
            f"--cluster {address}: local:N starts N workers, from 1 to {MOST_LOCAL}, such as "
            "local:2."
        )
    return worker_count(int(count or 0))


@contextmanager
def _quiet() -> Iterator[None]:
    """What goes wrong is told in our own words."""
    logs = [logging.getLogger(name) for name in LOGS]
    levels = [log.level for log in logs]
    for log in logs:
        log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for log, level in zip(logs, levels, strict=True):
            log.setLevel(level)


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0] or type(error).__name__
