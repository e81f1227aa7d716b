"""How a command is stopped: Ctrl-C, SIGTERM and SIGHUP end its work with a KeyboardInterrupt."""

import signal
import sys
import threading
from collections.abc import Callable
from itertools import takewhile
from subprocess import Popen
from tempfile import TemporaryDirectory
from traceback import walk_stack
from types import FrameType
from typing import ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

STOPS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
RETRY = 0.01  # seconds until a stop that came at a bad moment is sent again


def uninterrupted(
    function: Callable[Arguments, Result], *arguments: Arguments.args, **named: Arguments.kwargs
) -> Result:
    """Call native code that calls Python in turn, and crashes if that raises: a stop waits."""
    return function(*arguments, **named)


# What Popen and TemporaryDirectory begin, nobody knows of before they return, and nobody would end.
UNDISTURBED = {one.__code__ for one in (uninterrupted, Popen.__init__, TemporaryDirectory.__init__)}


def until_interrupted(work: Callable[[], int | None], received: list[int]) -> int | None:
    """Do `work`; the first signal to stop is a KeyboardInterrupt in it and told in `received`.

    Later ones are ignored: things are being put away. Python drops an exception that is raised in
    ``__del__``, extensions may swallow one that is raised while they load, and a process or folder
    that is just being made would stay: then, as in `uninterrupted`, the signal is sent again. Those
    that the process was started to ignore, as by nohup, stay ignored.
    """
    main_thread = threading.main_thread()
    if threading.current_thread() is not main_thread:
        return work()

    def on_signal(number: int, frame: FrameType | None) -> None:
        codes = (above.f_code for above, _ in walk_stack(frame))
        work = takewhile(lambda code: code is not until_interrupted.__code__, codes)
        loading = "<frozen importlib._bootstrap>"
        if not received and any(c in UNDISTURBED or c.co_filename == loading for c in work):
            send_again(number)
        elif not received:
            received.append(number)
            raise KeyboardInterrupt

    def on_unraisable(dropped: "sys.UnraisableHookArgs") -> None:
        if received and issubclass(dropped.exc_type, KeyboardInterrupt):
            send_again(received.pop())
        else:
            hook(dropped)

    def send_again(number: int) -> None:
        send = getattr(signal, "pthread_kill", lambda thread, number: signal.raise_signal(number))
        threading.Timer(RETRY, send, [main_thread.ident, number]).start()

    hook, default = sys.unraisablehook, (signal.SIG_DFL, signal.default_int_handler)
    before = {n: signal.getsignal(n) for n in STOPS if signal.getsignal(n) in default}
    try:
        sys.unraisablehook = on_unraisable
        for number in before:
            signal.signal(number, on_signal)
        return work()
    finally:
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)
