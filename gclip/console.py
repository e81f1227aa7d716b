"""What the commands `bake`, `play` and `grow` share: exit codes and one-sentence errors.

Exit codes: 0 done, 1 our own fault, 2 wrong usage or bad input, 130 stopped with Ctrl-C, 143 by
SIGTERM, 129 by SIGHUP.
"""

from __future__ import annotations

import errno
import io
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

from gclip.errors import UserError
from gclip.text import printable

if TYPE_CHECKING:
    from typer import Typer

DONE, OUR_FAULT, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
AGAIN = 0.01
"""Seconds until a stop that came at a bad moment is asked for again."""
ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.EIO}
"""Errors of the system that no program can help, whatever file they are about."""


def run(command: str, work: Callable[[], int | None]) -> int:
    """Do `work` and turn its outcome into an exit code, with one sentence on stderr.

    Work that has told its failures itself returns the exit code.

    Set the environment variable ``GCLIP_TRACEBACK=1`` to see the traceback of a fault of our own.
    """
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # where the terminal can't show a name's letters
    signals: list[int] = []
    try:
        with _stopped_by(signals):
            return work() or DONE
    except KeyboardInterrupt:
        _say(command, "stopped; nothing half-written is left behind.")
        return 128 + signals[0] if signals else INTERRUPTED
    except BrokenPipeError:
        # Python flushes stdout again at exit: give it somewhere to go (see the docs of signal).
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except Exception as error:
        code, sentence = verdict(error)
        if code == OUR_FAULT and os.environ.get("GCLIP_TRACEBACK"):
            raise
        _say(command, sentence)
        return code


@contextmanager
def _stopped_by(signals: list[int]) -> Iterator[None]:
    """Being asked to end is a KeyboardInterrupt, as Ctrl-C is; `signals` tells by which.

    Once is enough: what comes while things are put away is ignored. A stop that an import or Python
    itself would swallow is asked for again a moment later: modules written in C take what is raised
    while they load for a failure of theirs or for none, and what is raised in a callback of a weak
    reference or in ``__del__`` is dropped.
    """
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

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    usual = (signal.SIG_DFL, signal.default_int_handler)  # not those that are ignored, as by nohup
    names = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP
    stops = [getattr(signal, name) for name in names if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in stops}
    before = {number: handler for number, handler in before.items() if handler in usual}
    hook = sys.unraisablehook
    try:
        sys.unraisablehook = dropped
        for number in before:
            signal.signal(number, stop)
        yield
    finally:
        sys.unraisablehook = hook
        for timer in again:
            timer.cancel()
        for number, handler in before.items():
            signal.signal(number, handler)


def _importing(frame: FrameType | None) -> bool:
    """Whether a module is being loaded in `frame`, by the work of this command."""
    while frame is not None and frame.f_code is not run.__code__:
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


def verdict(error: Exception) -> tuple[int, str]:
    """The exit code that an error stands for, and the one sentence it is told with."""
    if isinstance(error, UserError):
        return BAD_INPUT, str(error)
    if isinstance(error, OSError) and (error.filename is not None or error.errno in ROOM):
        named = error.filename is not None
        where = f"{printable(os.fsdecode(error.filename), 200)}: " if named else ""
        return BAD_INPUT, f"{where}{error.strerror or error}."
    if isinstance(error, MemoryError):
        return (
            BAD_INPUT,
            "out of memory; try fewer points, for example with `bake --voxel SIZE`.",
        )
    return (
        OUR_FAULT,
        f"internal error ({type(error).__name__}: {error}); this is a fault of the program, "
        "please report it (set GCLIP_TRACEBACK=1 to see where).",
    )


def run_app(app: Typer, command: str, argv: list[str] | None = None) -> int:
    """Run a typer app with `argv` (the process's own by default); returns the exit code."""
    from typer import Abort
    from typer.exceptions import TyperException
    from typer.main import get_command

    def work() -> int | None:
        try:
            code = get_command(app).main(args=argv, prog_name=command, standalone_mode=False)
            if code == INTERRUPTED:  # what typer makes of Ctrl-C
                raise KeyboardInterrupt
        except TyperException as error:
            message = getattr(error, "format_message", error.__str__)()
            raise UserError(f"{message.rstrip('.')}; see `{command} --help`.") from None
        except Abort:
            raise KeyboardInterrupt from None
        if code == INTERRUPTED:  # typer's own word for Ctrl-C
            raise KeyboardInterrupt
        return code if isinstance(code, int) else None

    code = run(command, work)
    if code > 128 and argv is None:
        # All is put away that has to be; threads deep in numbers would still be waited for.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    return code


def _say(command: str, sentence: str) -> None:
    """On one line, whatever the names in it are made of: they come from files."""
    sentence = printable(" ".join(sentence.split()))
    print(f"{command}: {sentence}", file=sys.stderr)
