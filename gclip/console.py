"""What the commands `bake`, `play` and `grow` share: exit codes and one-sentence errors.

Exit codes: 0 done, 1 our own fault, 2 wrong usage or bad input, 130 stopped with Ctrl-C, 143 by
SIGTERM, 129 by SIGHUP.
"""

from __future__ import annotations

import errno
import gc
import io
import os
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

from gclip.errors import UserError
from gclip.stopping import until_stopped
from gclip.text import printable

if TYPE_CHECKING:
    from typer import Typer

DONE, OUR_FAULT, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
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
        return until_stopped(work, signals) or DONE
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
    if argv is None:
        gc.freeze()  # the process ends: to look for garbage once more took a third of a second
    return code


def _say(command: str, sentence: str) -> None:
    """On one line, whatever the names in it are made of: they come from files."""
    sentence = printable(" ".join(sentence.split()))
    print(f"{command}: {sentence}", file=sys.stderr)
