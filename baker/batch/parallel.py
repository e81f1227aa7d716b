"""Worker processes that may die one by one."""

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from threading import Thread
from typing import Any

PATIENCE = 5.0  # seconds that a task has to end once its parent has
PATIENCE_OF_PARENT = 20.0  # the same where the parent ends it, on a machine that may be busy
PRELOADED = ["baker.cli", "baker.pipeline", "numba", "scipy.spatial", "scipy.sparse.csgraph"]
# With a fork server, processes are forked from one that has our libraries and no threads.
START_METHOD = "forkserver" if sys.platform == "linux" else "spawn"

Submit = Callable[..., "Future[Any]"]
"""``submit(function, *arguments)``"""


@contextmanager
def process_pool(workers: int) -> Iterator[Submit]:
    """Worker processes to submit tasks to; one that is killed takes only its own task with it.

    They are not forked from this process, whose threads may hold locks. They leave Ctrl-C to this
    process and end with it, however it ends. Leaving the context by an exception ends their tasks
    by one, too, so that half-written files are removed. What travels has to be picklable.
    """
    from pebble import CONSTS, ProcessPool

    patience, CONSTS.term_timeout = CONSTS.term_timeout, PATIENCE_OF_PARENT
    _start_fork_server()
    context = get_context(START_METHOD)
    reader, writer = context.Pipe(duplex=False)
    pool = ProcessPool(workers, initializer=_follow_parent, initargs=[writer], context=context)
    try:
        yield lambda function, *arguments: pool.schedule(_run, [function, *arguments])
        pool.close()
    except BaseException:
        for _ in range(workers):  # one that is still starting would end with a traceback
            if reader.poll(PATIENCE / workers):
                reader.recv()
        pool.stop()
        raise
    finally:
        pool.join()
        CONSTS.term_timeout = patience


def _start_fork_server() -> None:
    """Start it before it is needed: it loads libraries meanwhile."""
    if START_METHOD != "forkserver":
        return
    from multiprocessing import forkserver, resource_tracker, set_forkserver_preload

    set_forkserver_preload(PRELOADED)
    resource_tracker.ensure_running()  # not later: it lets Ctrl-C through
    # It and all its children inherit that Ctrl-C, which reaches all, is for this process to decide.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _follow_parent(started: Connection) -> None:
    """In a worker: end with the parent, and when the parent terminates it."""
    signal.signal(signal.SIGTERM, _end_task)
    started.send(True)

    def end_with_parent() -> None:
        parent = parent_process()
        assert parent is not None
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(PATIENCE)
        os._exit(1)

    Thread(target=end_with_parent, daemon=True).start()


def _run(function: Callable[..., Any], *arguments: Any) -> Any:
    """A task. If it is ended the process ends with it, and begins none of those that wait."""
    try:
        return function(*arguments)
    except SystemExit:
        os._exit(1)


def _end_task(number: int, frame: object) -> None:
    signal.signal(number, signal.SIG_IGN)
    raise SystemExit(128 + number)
