"""Stop a command by Ctrl-C, SIGTERM or SIGHUP: at once, with nothing half-written left behind."""

import os
import signal
from contextlib import suppress
from pathlib import Path
from shutil import rmtree
from typing import NoReturn

STOPS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
ATTEMPTS = 100  # at removing folders, into which threads may still write

drafts: set[Path] = set()  #: temporary folders of this process, which are removed if it is stopped


def stop_on_signals(message: str = "") -> None:
    """From now on, stop signals end the process.

    No exception is raised, for it would be lost in ``__del__`` and while a module is imported, and
    crash native code that calls Python. Signals that the process was started to ignore, as by
    nohup, stay ignored.

    Parameters
    ----------
    message : str, optional
        Written to stderr when a signal comes.
    """

    def on_signal(number: int, frame: object) -> NoReturn:
        for other in STOPS:
            signal.signal(other, signal.SIG_IGN)
        with suppress(OSError):
            show_cursor = "\n\x1b[?25h" if os.isatty(2) else ""  # below the bars, which hide it
            os.write(2, f"{show_cursor}{message}\n".encode() if message else b"")
        stop(128 + number)

    for number in STOPS:
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, on_signal)


def stop(code: int) -> NoReturn:
    """End the process at once with this exit code; threads do not go on, and `drafts` are removed.

    Child processes end when they find that nobody listens to them.
    """
    for folder in [*drafts] * ATTEMPTS:
        rmtree(folder, ignore_errors=True)
    os._exit(code)
