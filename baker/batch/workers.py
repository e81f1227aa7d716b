"""Workers that bake plants: processes on this machine, or those of a dask cluster.

Both contexts yield the function that submits tasks, as `concurrent.futures.Executor.submit` does.
If a worker is killed, its task is tried again by another one, and raises an exception at last.
"""

import logging
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from threading import local
from typing import Any

from baker.errors import InputError
from baker.interpolation.provenance import software
from baker.scans.child_process import ChildEnded, ChildProcess

ATTEMPTS = 2  # number of times that a task is tried if its worker process is killed
PATIENCE = 20.0  # seconds from stopping a task to killing it, on a machine that may be busy
TIMEOUT = 5  # seconds to connect to a scheduler
LOGGERS = ("distributed", "distributed.client", "distributed.worker", "asyncio")

Submit = Callable[..., "Future[Any]"]
"""``submit(function, *arguments)``; functions, arguments and results are pickled."""


@contextmanager
def process_pool(workers: int) -> Iterator[Submit]:
    """Start worker processes. A task that ends its process `ATTEMPTS` times raises ChildEnded.

    A terminal's Ctrl-C does not reach them. They end when this process ends, however it ends, or
    when the context is left, and remove half-written files.
    """
    children = [ChildProcess(stderr=None) for _ in range(workers)]
    unused, thread_state = list(children), local()

    def start_thread() -> None:
        thread_state.child = unused.pop()

    def call(function: Callable[..., Any], *arguments: Any) -> Any:
        for _ in range(ATTEMPTS):
            with suppress(ChildEnded):
                return thread_state.child.call(-1, function, *arguments)
        raise ChildEnded(f"tried {ATTEMPTS} times")

    threads = ThreadPoolExecutor(workers, initializer=start_thread)
    try:
        yield lambda function, *arguments: threads.submit(call, function, *arguments)
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        with ThreadPoolExecutor(workers) as stopping:
            stopping.map(partial(ChildProcess.stop, patience=PATIENCE), children)


@contextmanager
def cluster_pool(address: str, say: Callable[[str], None]) -> Iterator[Submit]:
    """Connect to a cluster, whose workers read scans and write clips in folders that all share.

    A task is tried `distributed.scheduler.allowed-failures` times before it raises KilledWorker.

    address: of the scheduler, or the name of the scheduler's file. say: called with messages for
    the user. Raises InputError if dask.distributed is not installed, no scheduler answers, or a
    worker lacks the program or has other versions of it or of its packages.
    """
    try:
        import distributed
    except ImportError:
        raise InputError(
            "--cluster needs dask.distributed, which is not installed: "
            'pip install "plant-growth-clips[cluster]"'
        ) from None
    for logger in LOGGERS:  # errors are raised as InputError instead
        logging.getLogger(logger).setLevel(logging.CRITICAL)
    scheduler = {"scheduler_file" if Path(address).is_file() else "address": address}
    try:
        client = distributed.Client(**scheduler, timeout=TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        reason = str(error).strip().partition("\n")[0] or type(error).__name__
        raise InputError(
            f"--cluster {address}: no scheduler answers there within {TIMEOUT} s; is it "
            f"running, and is that its address? ({reason})"
        ) from None
    with client:
        if not client.nthreads():
            say(f"{address} has no workers yet; waiting for them")
        require_same_versions(client)
        executor = client.get_executor(pure=False)
        try:
            yield executor.submit
        finally:
            executor.shutdown(wait=False)


def versions() -> set[str]:
    """The versions of this program and of its packages, such as "numpy 2.0"."""
    program, packages = software().values()
    names_and_versions = {program["name"]: program["version"], **packages}
    return {f"{name} {version}" for name, version in names_and_versions.items()}


def require_same_versions(client: Any) -> None:
    """Wait for a worker of a cluster; raise InputError if a worker has other `versions` or none."""
    try:
        client.submit(versions, pure=False).result()  # some clusters start workers for tasks only
        on_workers = client.run(versions)
    except (ImportError, RuntimeError) as error:  # of a worker, of the scheduler
        reason = str(error).partition(".")[0]
        raise InputError(
            f"The cluster lacks the program ({reason}); install it on its scheduler and workers."
        ) from None
    expected = versions()
    for worker, actual in on_workers.items():
        if actual != expected:
            differences = (actual - expected, expected - actual)
            other, own = (", ".join(sorted(difference)) for difference in differences)
            raise InputError(
                f"The cluster's worker {worker} has {other}, but here it is {own}; install the "
                "same on both."
            )
