"""How a command is stopped: Ctrl-C, SIGTERM and SIGHUP all end its work, and none gets lost."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

AGAIN = 0.01
"""Seconds until a stop that came at a bad moment is asked for again."""


def until_stopped(work: Callable[[], int | None], signals: list[int]) -> int | None:
    """Do `work`; being asked to end is a KeyboardInterrupt in it, and `signals` tells by which.

    Once is enough: what comes while things are put away is ignored. A stop that an import or Python
    itself would swallow is asked for again a moment later: modules written in C take what is raised
    while they load for a failure of theirs or for none, and what is raised in a callback of a weak
    reference or in ``__del__`` is dropped.
    """
    if threading.current_thread() is not threading.main_thread():
        return work()
    again: list[threading.Timer] = []

    def ask_again(number: int) -> None:
        again.append(threading.Timer(AGAIN, _ask, [number]))
        again[-1].start()

    def stop(number: int, frame: FrameType | None) -> None:
        if not signals and _importing(frame):
            ask_again(number)
            return
        signals.append(number)
        if len(signals) == 1:
            raise KeyboardInterrupt

    def dropped(unraisable: sys.UnraisableHookArgs) -> None:
        if signals and issubclass(unraisable.exc_type, KeyboardInterrupt):
            ask_again(signals[0])
            signals.clear()
        else:
            hook(unraisable)

    hook, before = sys.unraisablehook, _usual_handlers()
    try:
        sys.unraisablehook = dropped
        for number in before:
            signal.signal(number, stop)
        return work()
    finally:
        sys.unraisablehook = hook
        for timer in again:
            timer.cancel()
        for number, handler in before.items():
            signal.signal(number, handler)


def _usual_handlers() -> dict[int, Any]:
    """Of the signals that ask a command to end: not those that are ignored, as by nohup."""
    names = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP
    found = {
        getattr(signal, name): signal.getsignal(getattr(signal, name))
        for name in names
        if hasattr(signal, name)
    }
    usual = (signal.SIG_DFL, signal.default_int_handler)
    return {number: handler for number, handler in found.items() if handler in usual}


def _importing(frame: FrameType | None) -> bool:
    """Whether a module is being loaded in `frame`, by the work of this command."""
    while frame is not None and frame.f_code is not until_stopped.__code__:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False


def _ask(number: int) -> None:
    """Send the process itself a signal; it wakes its main thread, where the system can do that."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, number)
    else:
        signal.raise_signal(number)
