"""Stop a command by Ctrl-C, SIGTERM or SIGHUP: each raises KeyboardInterrupt in it."""

import signal
import sys
import threading
from collections.abc import Callable
from contextlib import ExitStack
from itertools import takewhile
from subprocess import Popen
from tempfile import TemporaryDirectory
from traceback import walk_stack
from types import FrameType
from typing import Any, ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

STOPS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
SEND = getattr(signal, "pthread_kill", lambda thread, number: signal.raise_signal(number))
RETRY = 0.01  # seconds until a signal that could not be handled is sent again
IMPORTING = "<frozen importlib._bootstrap>"  # the file of a frame that imports a module


def uninterrupted(
    function: Callable[Arguments, Result], *arguments: Arguments.args, **named: Arguments.kwargs
) -> Result:
    """Call a function; a stop signal that comes meanwhile is handled when it has returned.

    For native code that KeyboardInterrupt would crash: it ignores that a Python function that it
    calls has raised an exception, or returns while its threads still write into arrays.
    """
    return function(*arguments, **named)


# An exception in the latter two would leave a process or folder that nobody could remove.
UNINTERRUPTED = {f.__code__ for f in (uninterrupted, Popen.__init__, TemporaryDirectory.__init__)}


def until_interrupted(work: Callable[[], int | None]) -> int | None:
    """Call `work`; the first stop signal raises KeyboardInterrupt in it, with its number.

    Later signals are ignored, so that files can be removed. The signal is sent again where the
    exception would be lost (in ``__del__``, or while a module is imported) or do harm (in
    `UNINTERRUPTED`). Signals that the process was started to ignore, as by nohup, stay ignored.
    """
    if threading.current_thread() is not threading.main_thread():
        return work()
    received: list[int] = []

    def on_signal(number: int, frame: FrameType | None) -> None:
        codes = (outer.f_code for outer, _ in walk_stack(frame))
        running = takewhile(lambda code: code is not until_interrupted.__code__, codes)
        if any(code in UNINTERRUPTED or code.co_filename == IMPORTING for code in running):
            send_again(number)
        elif not received:
            received.append(number)
            raise KeyboardInterrupt(number)

    def on_unraisable(dropped: Any) -> None:
        if not received:
            hook(dropped)
        elif issubclass(dropped.exc_type, KeyboardInterrupt):
            send_again(received.pop())
        # Else an object whose creation was stopped can't be deleted as usual, which is no fault.

    def restore_hook() -> None:
        if not received:  # objects are deleted as long as the exception is handled
            sys.unraisablehook = hook

    def send_again(number: int) -> None:
        timer = threading.Timer(RETRY, SEND, [threading.main_thread().ident, number])
        ended.callback(timer.cancel)
        timer.start()

    hook, usual = sys.unraisablehook, (signal.SIG_DFL, signal.default_int_handler)
    with ExitStack() as ended:
        ended.callback(restore_hook)
        sys.unraisablehook = on_unraisable
        for number in STOPS:
            if signal.getsignal(number) in usual:
                ended.callback(signal.signal, number, signal.signal(number, on_signal))
        return work()
