"""Call functions in a child process: a crash there, or too much memory, is an exception here.

`multiprocessing` can't be used: worker processes of pebble and dask may not start its children, and
it would run a script without ``if __name__ == "__main__"`` a second time.
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
    """The child process ended, or ran out of memory, before the function returned."""


class ChildProcess:
    """A child process that calls functions, one after the other.

    It is started by the first call, and started again by the first call after a crash. It ends when
    this process ends, in whatever way.
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
        """Call ``function(*arguments)`` in the child process; return or raise what it does.

        memory: limit of the child's memory in bytes (on Linux). Arguments, result and exception are
        pickled. Raises ChildEnded where the limit is exceeded or the process ends.
        """
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                path = f"sys.path[:] = {[*map(str, sys.path)]}"
                program = f"import sys; {path}; from {__name__} import serve; serve()"
                command = [sys.executable, "-c", program]
                self._process = Popen(command, stdin=PIPE, stdout=PIPE, stderr=DEVNULL)
            calls, results = self._process.stdin, self._process.stdout
            assert calls
            assert results
            try:
                pickle.dump((memory, function, arguments), calls)
                calls.flush()
                result = pickle.load(results)
            except (EOFError, OSError, pickle.UnpicklingError):
                self._process.communicate()
                code = self._process.returncode
                how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
                raise ChildEnded(f"its reader was ended {how}") from None
        if isinstance(result, MemoryError):
            raise ChildEnded(f"reading it takes more than {memory >> 30} GiB of memory")
        if isinstance(result, BaseException):
            raise result
        return result


def serve() -> None:
    """Run in the child process: call what the parent sends, until the parent ends."""
    for number in STOPS:  # the parent handles these signals and ends the child
        signal.signal(number, signal.SIG_IGN)
    calls, results = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries may print to stdout, which is the pipe of the results
    with suppress(EOFError):
        while True:
            memory, function, arguments = pickle.load(calls)
            _limit_memory(memory)
            try:
                result = function(*arguments)
            except BaseException as error:
                result = error
            pickle.dump(result, results, pickle.HIGHEST_PROTOCOL)  # which copies no arrays
            results.flush()


def _limit_memory(memory: int) -> None:
    # Windows has no `resource`; a limit above the user's own is refused.
    with suppress(ImportError, ValueError):
        import resource

        _, hard_limit = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (memory, hard_limit))
