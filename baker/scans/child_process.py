"""A child process for native code that may end the process it runs in, or ask for all its memory.

It is none of `multiprocessing`: workers of pebble and of dask may have no such children, and a
script without ``if __name__ == "__main__"`` would be run again in them.
"""

import os
import pickle
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from subprocess import DEVNULL, PIPE, Popen
from threading import Lock
from typing import Any, Self

from gclip.terminal.interrupts import STOPS


class ChildEnded(Exception):
    """The child process ended, or ran out of memory, instead of returning something."""


class ChildProcess:
    """Calls functions in a child process, one after the other.

    It starts at the first call, and again at the next one after a call that ended it. However this
    process ends, it ends, too.
    """

    def __init__(self) -> None:
        self._process: Popen[bytes] | None = None
        self._lock = Lock()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.communicate()

    def call(self, memory: int, function: Callable[..., Any], *arguments: Any) -> Any:
        """What the function returns, or raises; both, and the arguments, have to be picklable.

        memory: bytes that it may take (on Linux). Raises ChildEnded where that is too little, or
        the process ends.
        """
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                self._process = _started()
            orders, results = self._process.stdin, self._process.stdout
            assert orders
            assert results
            try:
                pickle.dump((memory, function, arguments), orders)
                orders.flush()
                result, error = pickle.load(results)
            except (EOFError, OSError, pickle.UnpicklingError):
                self._process.communicate()
                code = self._process.returncode
                how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
                raise ChildEnded(f"its reader was ended {how}") from None
        if isinstance(error, MemoryError):
            raise ChildEnded(f"reading it takes more than {memory >> 30} GiB of memory")
        if error is not None:
            raise error
        return result


def _started() -> Popen[bytes]:
    code = (
        f"import sys; sys.path[:] = {[*map(str, sys.path)]}; from {__name__} import serve; serve()"
    )
    return Popen([sys.executable, "-c", code], stdin=PIPE, stdout=PIPE, stderr=DEVNULL)


def serve() -> None:
    """In the child: do what the parent asks for, until it ends."""
    for number in STOPS:  # they are for the parent to decide
        signal.signal(number, signal.SIG_IGN)
    orders, results = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print is no result
    with suppress(EOFError):
        while True:
            memory, function, arguments = pickle.load(orders)
            _limit(memory)
            outcome: tuple[Any, BaseException | None]
            try:
                outcome = function(*arguments), None
            except BaseException as error:
                outcome = None, error
            pickle.dump(outcome, results, pickle.HIGHEST_PROTOCOL)  # without copies
            results.flush()


def _limit(memory: int) -> None:
    with suppress(ImportError, ValueError):  # not on Windows; not more than the user's own limit
        import resource

        _, most = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (memory, most))
