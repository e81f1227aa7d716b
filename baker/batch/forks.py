"""Work shared out among copies of this process, where Python itself takes much of the time.

Threads of Python take turns; processes don't. A fork has all that this process has, so nothing
needs to be sent to it: only results come back. It lives for one round of work.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeVar, cast

from baker.errors import InputError
from baker.geometry.parallel import thread_map

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from threading import Thread

    from baker.batch.executor import Executor
    from baker.batch.interval_job import IntervalJob

Item = TypeVar("Item")
Result = TypeVar("Result")
Done = Callable[[int], None]

MANY = 16  # items for each fork from which on it is given one ahead, not to wait for the next
DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of prctl(2)


def on_cores(workers: int) -> tuple[Executor, ForkPool | None]:
    """Where a command solves its intervals, and where it looks at single scans.

    Forks where they are safe, else threads: other systems' own libraries don't survive them.
    """
    if sys.platform != "linux" or workers <= 1:
        from baker.batch.executor import Threads

        return Threads(workers), None
    late = _Late()
    return Forks(workers, late), ForkPool(workers, late=late)


class Forks:
    """An `Executor` on forks of this process; for commands, whose threads hold no locks.

    Several intervals are solved at once, one a core. Where there are too few of them their tasks
    are shared out instead.
    """

    def __init__(self, workers: int, late: _Late | None = None) -> None:
        self._workers = workers
        self._late = late or _Late()

    def run(
        self, function: Callable[..., Result], jobs: Sequence[IntervalJob], done: Done
    ) -> Iterator[tuple[int, Result]]:
        """See `baker.batch.executor.Executor`. Raises InputError where a fork dies."""
        pool = ForkPool(self._workers, done, self._late)
        self._late.start()
        self._late.wait()
        if 2 * len(jobs) > self._workers:
            yield from pool.unordered(lambda job: function(job, done=pool.tell), jobs)
        else:
            for index, job in enumerate(jobs):
                with thread_map(self._workers) as map:
                    yield index, function(job, map, self._workers, pool.tell)


class _Late:
    """What is imported and compiled late, loaded beside the first round of work.

    A round that needs it should come after another one, or its forks load it themselves.
    """

    def __init__(self) -> None:
        self._thread: Thread | None = None

    def start(self) -> None:
        from threading import Thread

        if self._thread is None:
            self._thread = Thread(target=self._load, daemon=True)
            self._thread.start()

    def wait(self) -> None:
        """Until it is there if it has been started: forks would keep the locks of a thread."""
        if self._thread is not None:
            self._thread.join()

    @staticmethod
    def _load() -> None:
        import numpy as np
        import scipy.sparse.csgraph
        import scipy.spatial  # noqa: F401

        import baker.pipeline  # noqa: F401  # all stages that follow the reading
        from baker.transport.solve import solve

        few = np.eye(3)
        solve(np.tile(few, (2, 1)), few)


class ForkPool:
    """Maps functions over items in up to `workers` forks, made anew for every round.

    done: called in this process, with what the functions `tell` in any.
    """

    def __init__(
        self, workers: int, done: Done = lambda steps: None, late: _Late | None = None
    ) -> None:
        self._workers = workers
        self._done = done
        self._parent: Connection | None = None  # of a fork
        self._late = late or _Late()

    def tell(self, steps: int) -> None:
        """How many more steps are done."""
        if self._parent is not None:
            self._parent.send(steps)
        else:
            self._done(steps)

    def begin(self) -> None:
        """Load what later rounds need beside the first work, whoever does it."""
        if self._parent is None:
            self._late.start()

    def map(self, function: Callable[[Item], Result], items: Sequence[Item]) -> Iterator[Result]:
        """The results in the items' order, as soon as they and those before are there."""
        early: dict[int, Result] = {}
        following = 0
        for index, result in self.unordered(function, items):
            early[index] = result
            while following in early:
                yield early.pop(following)
                following += 1

    def unordered(
        self, function: Callable[[Item], Result], items: Sequence[Item]
    ) -> Iterator[tuple[int, Result]]:
        """Each item's number and its result as they come; close it to stop at once.

        Raises what a function raises, and InputError where a fork dies of an item.
        """
        forks = 0 if self._parent is not None else min(self._workers, len(items))
        crew: dict[Connection, int] = {}
        if forks > 1:
            self._late.wait()
        try:
            with suppress(OSError):  # where no more processes are to be had, fewer do it
                for _ in range(forks if forks > 1 else 0):
                    pipe, process = self._fork(function, items, list(crew))
                    crew[pipe] = process
            if crew:
                self.begin()
                yield from self._shared_out(list(crew), len(items))
            else:
                yield from ((index, function(item)) for index, item in enumerate(items))
        finally:
            for pipe, process in crew.items():
                pipe.close()
                os.kill(process, signal.SIGKILL)
                os.waitpid(process, 0)

    def _shared_out(self, crew: Sequence[Connection], count: int) -> Iterator[tuple[int, Any]]:
        """Send forks the numbers of items, a new one for every result."""
        from multiprocessing.connection import wait

        waiting = iter(range(count))
        ahead = 2 if count >= MANY * len(crew) else 1
        for pipe, index in zip(ahead * list(crew), waiting, strict=False):
            _send(pipe, index)
        missing = count
        while missing:
            for ready in wait(crew):
                pipe = cast("Connection", ready)
                found = _received(pipe)
                if isinstance(found, int):
                    self._done(found)
                    continue
                missing -= 1
                for index in islice(waiting, 1):
                    _send(pipe, index)
                yield found

    def _fork(
        self,
        function: Callable[[Item], Result],
        items: Sequence[Item],
        others: Sequence[Connection],
    ) -> tuple[Connection, int]:
        """A fork that does the items whose numbers it is sent: its end of a pipe, and its id."""
        from multiprocessing import Pipe

        ours, theirs = Pipe()
        process = os.fork()
        if process:
            theirs.close()
            return ours, process
        # A fork ends here whatever happens: what called this is the first process's to finish.
        try:
            for pipe in (ours, *others):
                pipe.close()
            _end_with_parent()
            self._parent = theirs
            _serve(function, items, theirs)
        finally:
            os._exit(0)


def _serve(function: Callable[[Item], Result], items: Sequence[Item], pipe: Connection) -> None:
    """Do the items whose numbers come, until the pipe is closed or one fails."""
    while True:
        try:
            index = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            found = function(items[index])
        except Exception as error:
            pipe.send(_sendable(error))
            return
        pipe.send((index, found))


def _send(pipe: Connection, index: int) -> None:
    with suppress(OSError):  # it has died: what is received from it will tell
        pipe.send(index)


def _received(pipe: Connection) -> int | tuple[int, Any]:
    """Steps done, or an item's number and its result. Raises what the item raised."""
    try:
        found = pipe.recv()
    except (EOFError, OSError):
        raise InputError(
            "a process that solved a part of the bake was killed; most likely there is too little "
            "memory for these scans: try fewer points (--voxel, --resample) or one process "
            "(--workers 1)."
        ) from None
    if isinstance(found, Exception):
        raise found
    return found


def _sendable(error: Exception) -> Exception:
    """The error itself, or what it says where it can't be sent."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError("".join(traceback.format_exception(error)))
    return error


def _end_with_parent() -> None:
    """No fork outlives the command, however that ends; Ctrl-C is the command's to decide on."""
    import ctypes

    ctypes.CDLL(None).prctl(DIE_WITH_PARENT, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
