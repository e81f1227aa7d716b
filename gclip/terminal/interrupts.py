"""How a command is stopped: Ctrl-C, SIGTERM and SIGHUP end its work with a KeyboardInterrupt."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable
from types import FrameType

STOPS = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP
IMPATIENT = 1.0  # seconds after a stop in which others are taken for the same one
RETRY = 0.01  # seconds until a stop that came while a module loads is sent again


def until_interrupted(work: Callable[[], int | None], received: list[int]) -> int | None:
    """Do `work`; a signal to stop is a KeyboardInterrupt in it and told in `received`.

    Signals that the process was started to ignore, as by nohup, stay ignored. Extensions may
    swallow an exception that is raised while they load, so then the signal waits.
    """
    if threading.current_thread() is not threading.main_thread():
        return work()
    last = -IMPATIENT

    def on_signal(number: int, frame: FrameType | None) -> None:
        nonlocal last
        if time.monotonic() < last + IMPATIENT:
            return  # things are being put away
        if _is_importing(frame):
            threading.Timer(RETRY, _send, [number]).start()
            return
        last = time.monotonic()
        received.append(number)
        raise KeyboardInterrupt

    numbers = [getattr(signal, name) for name in STOPS if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in numbers}
    default = (signal.SIG_DFL, signal.default_int_handler)
    try:
        for number in numbers:
            if before[number] in default:
                signal.signal(number, on_signal)
        return work()
    finally:
        for number in numbers:
            if before[number] in default:
                signal.signal(number, before[number])


def _is_importing(frame: FrameType | None) -> bool:
    """Whether the work is loading a module in `frame`."""
    while frame is not None and frame.f_code.co_filename != __file__:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False


def _send(number: int) -> None:
    """Send the process itself a signal; it wakes its main thread, where the system can do that."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, number)
    else:
        signal.raise_signal(number)
