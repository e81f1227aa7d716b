"""Run the commands `bake`, `play`, `grow` and `gclip`: exit codes, error messages and help."""

import errno
import gc
import io
import os
import sys
import warnings
from collections.abc import Callable
from signal import SIGINT
from traceback import walk_tb
from typing import Annotated, Any

from typer import Context, Exit, Option, Typer, echo
from typer.exceptions import TyperException
from typer.main import get_command

from gclip import __version__
from gclip.errors import UserError
from gclip.terminal.interrupts import stop_on_signals
from gclip.text import Lossy, printable

DONE, OUR_FAULT, BAD_INPUT = 0, 1, 2  # or 128 and the number of a signal
STOPPED = "stopped; nothing half-written is left behind."
# Errors of the system that are not the program's fault, whatever the file.
LIMITS = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.EIO}


def run(command: str, work: Callable[[], int | None]) -> int:
    """Call `work` and return the exit code; an exception is printed as one sentence on stderr.

    `work` may return an exit code itself. With ``GCLIP_TRACEBACK=1``, exceptions that are faults of
    the program are raised.
    """
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # for letters that the terminal can't encode
    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda text, *where: _print_error(
                command, f"warning: {str(text).partition(chr(10))[0]}"
            )
            return work() or DONE
    except KeyboardInterrupt:  # in Python; `run_app` stops a process otherwise
        _print_error(command, STOPPED)
        return 128 + SIGINT
    except (BrokenPipeError, SystemExit) as error:  # rich turns the first into the second
        if BrokenPipeError not in (type(error), type(error.__context__)):
            raise
        # Python flushes stdout again at exit, which must not fail (see the docs of signal).
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except Exception as error:
        code, sentence = verdict(error)
        if code == OUR_FAULT and os.environ.get("GCLIP_TRACEBACK"):
            raise
        _print_error(command, sentence)
        return code


def verdict(error: Exception) -> tuple[int, str]:
    """The exit code and the message for an exception."""
    if isinstance(error, UserError):
        return BAD_INPUT, str(error)
    if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
        return BAD_INPUT, "out of memory; try fewer points, for example with `bake --voxel SIZE`."
    if isinstance(error, OSError) and (error.filename is not None or error.errno in LIMITS):
        name = f"{printable(os.fsdecode(error.filename), 200)}: " if error.filename else ""
        return BAD_INPUT, f"{name}{error.strerror or error}."
    if isinstance(error, FileNotFoundError):  # without a file's name: from os.getcwd()
        return BAD_INPUT, "the folder that the command was started in is gone."
    # A library of the system is missing, or a wrong environment variable was read by an import.
    reason = str(error).rstrip(".")
    codes = (frame.f_code.co_name for frame, _ in walk_tb(error.__traceback__))
    if "shared object" in reason or (isinstance(error, ValueError) and "<module>" in codes):
        return BAD_INPUT, f"a library can't be loaded in this environment: {reason}."
    fault = f"internal error ({type(error).__name__}: {error}); this is a fault of the program"
    return OUR_FAULT, f"{fault}, please report it (set GCLIP_TRACEBACK=1 to see where)."


def _usage_error(error: Any) -> str:
    """What is wrong with a command line, from an exception of typer's."""
    if error.__cause__ is None:
        return error.format_message()
    wrong = error.__cause__.errors()[0]  # pydantic's, which has the value
    option, value = error.param.get_error_hint().replace("'", ""), repr(wrong["input"])
    return f"{option} is {printable(value, 80)}; {wrong.get('ctx', {}).get('error', wrong['msg'])}"


def _print_version(context: Context, wanted: bool) -> None:
    if wanted:
        echo(f"{context.info_name} {__version__}")
        raise Exit


VersionOption = Annotated[
    bool, Option("--version", help="Print the version.", is_eager=True, callback=_print_version)
]


def run_app(
    app: Typer, command: str, argv: list[str] | None = None, panels: dict[str, str] | None = None
) -> int:
    """Run a typer app with `argv` (by default that of the process); returns the exit code.

    panels: title -> names of the options that the help groups under it. Flags that are on by
    default have a --no- form, other ones not.
    """

    def work() -> Any:
        parser: Any = get_command(app)
        titles = {name: title for title, names in (panels or {}).items() for name in names.split()}
        for option in parser.params:
            option.rich_help_panel = titles.get(option.name)
            if getattr(option, "is_flag", False):
                option.metavar = ""  # not <bool>
                option.secondary_opts = option.secondary_opts if option.default else []
        try:
            with parser.make_context(command, sys.argv[1:] if argv is None else [*argv]) as context:
                return parser.invoke(context)
        except Exit as error:
            return error.exit_code
        except TyperException as error:
            raise UserError(f"{_usage_error(error).rstrip('.')}; see `{command} --help`.") from None

    # Read when numpy is loaded. The rounding of a sum depends on the number of threads, but the
    # bytes of a file must not depend on the machine; other threads use all cores anyway.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    if argv is None:
        stop_on_signals(f"{command}: {STOPPED}")
    code = run(command, work)
    if argv is None:
        gc.freeze()  # the process ends: a last garbage collection would take 0.3 s
    return code


def _print_error(command: str, sentence: str) -> None:
    """Print an error on one line, even if it contains the name of a file with line breaks."""
    print(f"{command}: {printable(' '.join(sentence.split()))}", file=Lossy(sys.stderr))
