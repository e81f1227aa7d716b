"""A pool of worker processes in which a killed worker loses only its own task."""

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

ORPHAN_TIMEOUT = 5.0  # seconds that a task may take to end once the parent process has ended
TERM_TIMEOUT = 20.0  # the same once the parent process terminates it, on a machine that may be busy
PRELOADED = ["baker.cli", "baker.pipeline", "numba", "scipy.spatial", "scipy.sparse.csgraph"]
# A fork server forks workers from a process that has loaded our libraries and has no threads.
START_METHOD = "forkserver" if sys.platform == "linux" else "spawn"

Submit = Callable[..., "Future[Any]"]
"""``submit(function, *arguments)``"""


@contextmanager
def process_pool(workers: int) -> Iterator[Submit]:
    """Start worker processes; yields the function that submits tasks to them.

    If a worker is killed, its future raises `pebble.ProcessExpired` and a new worker is started.
    The workers are not forked from this process, whose threads may hold locks. They ignore Ctrl-C
    and end with this process, in whatever way. If the context is left by an exception, SystemExit
    is raised in their tasks, so that half-written files are removed. Functions, arguments and
    results are pickled.
    """
    from pebble import CONSTS, ProcessPool

    term_timeout, CONSTS.term_timeout = CONSTS.term_timeout, TERM_TIMEOUT
    _start_fork_server()
    context = get_context(START_METHOD)
    reader, writer = context.Pipe(duplex=False)
    pool = ProcessPool(workers, initializer=_follow_parent, initargs=[writer], context=context)
    try:
        yield lambda function, *arguments: pool.schedule(_run, [function, *arguments])
        pool.close()
    except BaseException:
        for _ in range(workers):  # a worker stopped while it starts would print a traceback
            if reader.poll(ORPHAN_TIMEOUT / workers):
                reader.recv()
        pool.stop()
        raise
    finally:
        pool.join()
        CONSTS.term_timeout = term_timeout


def _start_fork_server() -> None:
    """Start the fork server before it is needed, so that it loads libraries meanwhile."""
    if START_METHOD != "forkserver":
        return
    from multiprocessing import forkserver, resource_tracker, set_forkserver_preload

    set_forkserver_preload(PRELOADED)
    resource_tracker.ensure_running()  # before SIGINT is blocked, since starting it unblocks it
    # The fork server and its children inherit the mask: only this process reacts to Ctrl-C.
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _follow_parent(started: Connection) -> None:
    """Run in a worker as it starts: make it end with the parent process, or when terminated."""
    signal.signal(signal.SIGTERM, _end_task)
    started.send(True)

    def end_with_parent() -> None:
        parent = parent_process()
        assert parent is not None
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(ORPHAN_TIMEOUT)
        os._exit(1)

    Thread(target=end_with_parent, daemon=True).start()


def _run(function: Callable[..., Any], *arguments: Any) -> Any:
    """Run a task in a worker; if it is terminated, end the process, which starts no other task."""
    try:
        return function(*arguments)
    except SystemExit:
        os._exit(1)


def _end_task(number: int, frame: object) -> None:
    signal.signal(number, signal.SIG_IGN)
    raise SystemExit(128 + number)
