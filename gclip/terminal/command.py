"""Run the commands `bake`, `play`, `grow` and `gclip`: exit codes, error messages and help."""

from __future__ import annotations

import errno
import gc
import io
import os
import re
import sys
import warnings
from collections.abc import Callable
from signal import SIGINT
from traceback import walk_tb
from typing import Annotated, Any

from typer import Abort, Context, Exit, Option, Typer, echo
from typer.exceptions import TyperException
from typer.main import get_command

from gclip import __version__
from gclip.errors import UserError
from gclip.terminal.interrupts import until_interrupted
from gclip.text import Lossy, printable

DONE, OUR_FAULT, BAD_INPUT = 0, 1, 2  # or 128 and the number of a signal
# Errors of the system that are not the program's fault, whatever the file.
LIMITS = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.EIO}
TYPES = re.compile(r"<(bool|str|int|float|path|file|list\[.*\])>")
# pydantic's name of an error in a value -> what is needed instead.
NEEDED = {
    "int_parsing": "a whole number is needed",
    "float_parsing": "a number is needed",
    "greater_than_equal": "at least {ge:g} is needed",
    "less_than_equal": "at most {le:g} is possible",
}


def run(command: str, work: Callable[[], int | None]) -> int:
    """Call `work` and return the exit code; an exception is printed as one sentence on stderr.

    `work` may return an exit code itself. With ``GCLIP_TRACEBACK=1``, exceptions that are faults of
    the program are raised.
    """
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # for letters that the terminal can't encode
    signals: list[int] = []
    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda text, *where: _print_error(
                command, f"warning: {str(text).partition(chr(10))[0]}"
            )
            return until_interrupted(work, signals) or DONE
    except KeyboardInterrupt:
        _print_error(command, "stopped; nothing half-written is left behind.")
        return 128 + (signals[0] if signals else SIGINT)
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
    if isinstance(error, OSError) and error.filename is not None:
        name = printable(os.fsdecode(error.filename), 200)
        return BAD_INPUT, f"{name}: {error.strerror or error}."
    if isinstance(error, OSError) and error.errno in LIMITS:
        return BAD_INPUT, f"{error.strerror or error}."
    reason = str(error).rstrip(".")
    if isinstance(error, (ImportError, OSError)) and "shared object" in reason:  # as ld.so says
        return BAD_INPUT, f"a library of the system can't be loaded: {reason}."
    if isinstance(error, ValueError) and (module := _module_in_loading(error)):
        return BAD_INPUT, f"{module} can't be loaded in this environment: {reason}."
    if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
        return BAD_INPUT, "out of memory; try fewer points, for example with `bake --voxel SIZE`."
    if isinstance(error, FileNotFoundError):  # without a file's name: from os.getcwd()
        return BAD_INPUT, "the folder that the command was started in is gone."
    fault = f"internal error ({type(error).__name__}: {error}); this is a fault of the program"
    return OUR_FAULT, f"{fault}, please report it (set GCLIP_TRACEBACK=1 to see where)."


def _module_in_loading(error: Exception) -> str:
    """The module whose import raised an error, for example for a wrong environment variable."""
    frames = [frame for frame, _ in walk_tb(error.__traceback__)]
    if not any(frame.f_code.co_filename.startswith("<frozen importlib") for frame in frames):
        return ""
    return str(frames[-1].f_globals["__name__"])


def _usage_error(error: Any) -> str:
    """What is wrong with a command line, from an exception of typer's."""
    if error.__cause__ is None:
        return str(getattr(error, "format_message", error.__str__)()).rstrip(".")
    first, option = error.__cause__.errors()[0], error.param.get_error_hint().replace("'", "")
    if first["type"] not in NEEDED:
        return f"{option}: {first.get('ctx', {}).get('error', first['msg'])}".rstrip(".")
    needed = NEEDED[first["type"]].format(**first.get("ctx", {}))
    return f"{option} is {first['input'] or repr('')}; {needed}"


def in_panels(panels: dict[str, str]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Decorate a command so that its help groups the options in panels, without --no- switches.

    panels: title -> names of the options.
    """
    titles = {name: panel for panel, names in panels.items() for name in names.split()}

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        for name, annotation in command.__annotations__.items():
            for option in getattr(annotation, "__metadata__", ()):
                option.rich_help_panel = titles.get(name)
                if annotation.__origin__ is bool and option.default is ...:  # no name was given
                    option.param_decls = (f"--{name.replace('_', '-')}",)
        return command

    return decorate


def _print_version(context: Context, wanted: bool) -> None:
    if wanted:
        echo(f"{context.info_name} {__version__}")
        raise Exit


VersionOption = Annotated[
    bool, Option("--version", help="Print the version.", is_eager=True, callback=_print_version)
]


def without_types(parser: Any) -> None:
    """Remove Python's types from a command's help, and describe ranges in words."""
    for command in (parser, *getattr(parser, "commands", {}).values()):
        for parameter in command.get_params(Context(command)):
            show = parameter.display_type_rich
            parameter.display_type_rich = lambda ctx, show=show: TYPES.sub("", show(ctx) or "")
            low, high = getattr(parameter, "min", None), getattr(parameter, "max", None)
            if low is not None:
                text = f"{low:g} or more" if high is None else f"{low:g} to {high:g}"
                parameter._get_number_range_help_str = lambda text=text: text


def run_app(app: Typer, command: str, argv: list[str] | None = None) -> int:
    """Run a typer app with `argv` (by default that of the process); returns the exit code."""

    def work() -> int | None:
        parser = get_command(app)
        without_types(parser)
        try:
            with parser.make_context(command, sys.argv[1:] if argv is None else [*argv]) as context:
                code = parser.invoke(context)
            return code if isinstance(code, int) else None
        except Exit as error:
            return error.exit_code
        except TyperException as error:
            raise UserError(f"{_usage_error(error)}; see `{command} --help`.") from None
        except Abort:
            raise KeyboardInterrupt from None

    # Read when numpy is loaded. The rounding of a sum depends on the number of threads, but the
    # bytes of a file must not depend on the machine; other threads use all cores anyway.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    code = run(command, work)
    if argv is None:
        gc.freeze()  # the process ends: a last garbage collection would take 0.3 s
    if argv is None and code > 128:
        Lossy(sys.stdout).write("")
        os._exit(code)  # without waiting for threads that still calculate
    return code


def _print_error(command: str, sentence: str) -> None:
    """Print an error on one line, even if it contains the name of a file with line breaks."""
    print(f"{command}: {printable(' '.join(sentence.split()))}", file=Lossy(sys.stderr))
