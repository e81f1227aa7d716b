"""Worker processes: an executor of `concurrent.futures` whose processes may die one by one."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from concurrent.futures.process import BrokenProcessPool
from itertools import islice
from multiprocessing import get_context, parent_process
from threading import Thread, current_thread, get_ident, main_thread
from typing import Any, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

ATTEMPTS = 2  # at a task whose process dies
PATIENCE = 5.0  # seconds that a task has to end before its process is killed
PRELOADED = ["baker.cli", "baker.pipeline", "numba", "scipy.spatial", "scipy.sparse.csgraph"]
# With a fork server, processes are forked from one that has our libraries and no threads.
START_METHOD = "forkserver" if sys.platform == "linux" else "spawn"


class WorkerDied(RuntimeError):
    """A worker process was killed by its task, most likely for want of memory."""

    def __init__(self, times: int) -> None:
        super().__init__(
            f"a worker process was killed {times} times at the same task; most likely the scans "
            "need more memory than there is: try fewer points (--voxel, --resample) or fewer "
            "processes (--workers)."
        )


def as_they_complete(
    executor: Executor,
    function: Callable[[Item], Result],
    items: Iterable[Item],
    window: Callable[[], int],
) -> Iterator[tuple[Item, Future[Result]]]:
    """Each item with its finished future, in any order; those that wait are not submitted yet.

    window: called for how many items to have under way.
    """
    waiting = iter(items)
    under_way: dict[Future[Result], Item] = {}
    while True:
        for item in islice(waiting, window() - len(under_way)):
            under_way[executor.submit(function, item)] = item
        if not under_way:
            return
        for future in wait(under_way, return_when=FIRST_COMPLETED).done:
            yield under_way.pop(future), future


class ProcessExecutor(Executor):
    """Run functions in at most `workers` processes, each started when it is first needed.

    Each process is a pool of its own, so that one that is killed takes only its own task with it;
    that is done once more in a new process. They are not forked from this process, whose threads
    may hold locks. They leave Ctrl-C to this process and end with it, however it ends. Leaving the
    context by an exception ends them at once. What travels has to be picklable.
    """

    def __init__(self, workers: int) -> None:
        _start_fork_server()
        self._threads = ThreadPoolExecutor(workers)
        self._pools: dict[int, ProcessPoolExecutor] = {}  # by the thread that waits for its process
        self._under_way: set[Future[Any]] = set()
        self._stopped = False

    def submit(
        self, function: Callable[..., Result], /, *arguments: Any, **named: Any
    ) -> Future[Result]:
        """See `concurrent.futures.Executor`; the future raises `WorkerDied` after two attempts."""
        future = self._threads.submit(self._run, function, arguments, named)
        self._under_way.add(future)
        future.add_done_callback(self._under_way.discard)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """See `concurrent.futures.Executor`."""
        self._threads.shutdown(wait=wait, cancel_futures=cancel_futures)
        for pool in self._pools.values():
            pool.shutdown()

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        if kind is not None:
            self._stop_at_once()
        self.shutdown()

    def _stop_at_once(self) -> None:
        """End tasks by an exception in their processes, so that half-written files are removed."""
        self._stopped = True
        self._threads.shutdown(wait=False, cancel_futures=True)
        deadline = time.monotonic() + PATIENCE
        while self._under_way:  # repeated, as a process that is just starting is not there yet
            self._end_processes(kill=time.monotonic() > deadline)
            time.sleep(0.01)
        self._end_processes(kill=True)  # threads of an ended task may go on

    def _end_processes(self, kill: bool) -> None:
        # Public from Python 3.14 on, as `terminate_workers` and `kill_workers`.
        for pool in list(self._pools.values()):
            for process in list((getattr(pool, "_processes", None) or {}).values()):
                process.kill() if kill else process.terminate()

    def _run(self, function: Callable[..., Result], arguments: Any, named: Any) -> Result:
        for _ in range(ATTEMPTS):
            if not self._stopped:
                pool = self._pools.get(get_ident()) or self._new_process()
                try:
                    return pool.submit(function, *arguments, **named).result()
                except BrokenProcessPool:
                    self._pools.pop(get_ident()).shutdown()
        raise WorkerDied(ATTEMPTS)

    def _new_process(self) -> ProcessPoolExecutor:
        """A pool of one process for the calling thread, started with its first task."""
        pool = ProcessPoolExecutor(1, get_context(START_METHOD), _follow_parent)
        return self._pools.setdefault(get_ident(), pool)


def _start_fork_server() -> None:
    """Start it before it is needed: it loads libraries meanwhile."""
    if START_METHOD != "forkserver":
        return
    from multiprocessing import forkserver, set_forkserver_preload

    set_forkserver_preload(PRELOADED)
    if current_thread() is not main_thread():
        forkserver.ensure_running()
        return
    # It and all its children inherit that Ctrl-C, which reaches all, is for this process to decide.
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        forkserver.ensure_running()
    finally:
        signal.signal(signal.SIGINT, handler)


def _follow_parent() -> None:
    """In a worker: end with the parent, and when the parent terminates it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end_task)

    def end_with_parent() -> None:
        parent = parent_process()
        assert parent is not None
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(PATIENCE)
        os._exit(1)

    Thread(target=end_with_parent, daemon=True).start()


def _end_task(number: int, frame: object) -> None:
    signal.signal(number, signal.SIG_IGN)
    raise SystemExit(128 + number)
