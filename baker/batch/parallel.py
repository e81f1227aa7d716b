"""Worker processes in which a killed worker loses only its own task."""

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from queue import SimpleQueue
from typing import Any

from baker.scans.child_process import ChildEnded, ChildProcess

ATTEMPTS = 2  # at a task whose worker process is killed
PATIENCE = 20.0  # seconds until a task that is stopped is killed, on a machine that may be busy

Submit = Callable[..., "Future[Any]"]
"""``submit(function, *arguments)``"""


class WorkerDied(RuntimeError):
    """A worker process was killed during a task, most likely because memory ran out."""

    def __init__(self, times: int) -> None:
        super().__init__(
            f"a worker process was killed {times} times at the same task; most likely the scans "
            "need more memory than there is: try fewer points (--voxel, --resample) or fewer "
            "processes (--workers)."
        )


@contextmanager
def process_pool(workers: int) -> Iterator[Submit]:
    """Start worker processes; yields the function that submits tasks to them.

    If a worker is killed, its task is tried once more in a new one, and then raises WorkerDied. A
    terminal's Ctrl-C does not reach the workers, which end with this process, in whatever way. When
    the context is left, KeyboardInterrupt is raised in their tasks, so that half-written files are
    removed. Functions, arguments and results are pickled.
    """
    children = [ChildProcess(stderr=None) for _ in range(workers)]
    free: SimpleQueue[ChildProcess] = SimpleQueue()
    for child in children:
        free.put(child)

    def call(function: Callable[..., Any], *arguments: Any) -> Any:
        child = free.get()
        try:
            for _ in range(ATTEMPTS):
                with suppress(ChildEnded):
                    return child.call(-1, function, *arguments)
            raise WorkerDied(ATTEMPTS)
        finally:
            free.put(child)

    threads = ThreadPoolExecutor(workers)
    try:
        yield lambda function, *arguments: threads.submit(call, function, *arguments)
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        with ThreadPoolExecutor(workers) as stopping:
            stopping.map(partial(ChildProcess.stop, patience=PATIENCE), children)
