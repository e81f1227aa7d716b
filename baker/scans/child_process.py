"""Call functions in a child process: a crash there, or too much memory, is an exception here.

`multiprocessing` can't be used: worker processes of dask may not start its children, and it would
run a script without ``if __name__ == "__main__"`` a second time.
"""

import os
import pickle
import signal
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from queue import SimpleQueue
from subprocess import DEVNULL, PIPE, Popen, TimeoutExpired
from threading import Lock, Thread
from typing import Any

from gclip.terminal.interrupts import stop, stop_on_signals


class ChildEnded(Exception):
    """The child process ended, or ran out of memory, before the function returned."""


class ChildProcess(AbstractContextManager):
    """A child process that calls functions, one after the other.

    It is started by the first call, and started again by the first call after a crash. It ends when
    this process ends, however it ends.

    stderr: as in `subprocess.Popen`; by default, the output of the child is discarded.
    """

    def __init__(self, stderr: int | None = DEVNULL) -> None:
        self._stderr = stderr
        self._process: Popen[bytes] | None = None
        self._is_stopped = False
        self._lock = Lock()

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self, patience: float = 0.0) -> None:
        """End the child, which removes its half-written files; kill it after `patience` seconds."""
        self._is_stopped = True
        if self._process is not None:
            assert self._process.stdin
            self._process.stdin.close()
            with suppress(TimeoutExpired):
                self._process.wait(patience)
            self._process.kill()
            self._process.wait()

    def call(self, memory: int, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call ``function(*arguments)`` in the child process; return or raise what it does.

        memory: limit of the child's memory in bytes (on Linux), -1 for none. Arguments, result and
        exception are pickled. Raises ChildEnded where the limit is exceeded or the process ends.
        """
        with self._lock:
            if self._is_stopped:
                raise ChildEnded("it was stopped")
            if self._process is None or self._process.poll() is not None:
                path = f"sys.path[:] = {[*map(str, sys.path)]}"
                program = f"import sys; {path}; from {__name__} import serve; serve()"
                command = [sys.executable, "-c", program]
                # In a process group of its own, which a terminal's Ctrl-C does not reach.
                self._process = Popen(
                    command, stdin=PIPE, stdout=PIPE, stderr=self._stderr, process_group=0
                )
            calls, results = self._process.stdin, self._process.stdout
            assert calls
            assert results
            try:
                pickle.dump(pickle.dumps((memory, function, arguments)), calls)
                calls.flush()
                result = pickle.load(results)
            except (EOFError, OSError, pickle.UnpicklingError):
                self._process.communicate()
                code = self._process.returncode
                how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
                raise ChildEnded(f"its reader was ended {how}") from None
        if isinstance(result, MemoryError) and memory > 0:
            raise ChildEnded(f"reading it takes more than {memory >> 30} GiB of memory")
        if isinstance(result, BaseException):
            raise result
        return result


def serve() -> None:
    """Call the functions that the parent process sends, until it stops this process or ends."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries may print to stdout, which is the pipe of the results
    calls: SimpleQueue[bytes] = SimpleQueue()

    def receive() -> None:
        with suppress(EOFError):
            while True:
                calls.put(pickle.load(sys.stdin.buffer))
        stop(1)  # also while a function is called

    Thread(target=receive, daemon=True).start()
    stop_on_signals()
    while True:
        memory, function, arguments = pickle.loads(calls.get())
        # Windows has no `resource`; a limit above the user's own is refused.
        with suppress(ImportError, ValueError):
            import resource

            _, hard_limit = resource.getrlimit(resource.RLIMIT_DATA)
            resource.setrlimit(resource.RLIMIT_DATA, (memory, hard_limit))
        try:
            result = function(*arguments)
        except Exception as error:
            result = error
        try:
            pickle.dump(result, results, pickle.HIGHEST_PROTOCOL)  # which copies no arrays
            results.flush()
        except BrokenPipeError:
            stop(1)
