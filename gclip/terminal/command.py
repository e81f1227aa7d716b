"""How the commands `bake`, `play`, `grow` and `gclip` end: with an exit code, and one sentence."""

from __future__ import annotations

import errno
import gc
import io
import os
import re
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from gclip.errors import UserError
from gclip.terminal.interrupts import until_interrupted
from gclip.text import Lossy, printable

if TYPE_CHECKING:
    from typer import Typer

DONE, OUR_FAULT, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130  # 143 by SIGTERM, 129 by SIGHUP
# What no program can help, whatever file it is about.
LIMITS = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.EIO}
TYPES = re.compile(r"<(bool|str|int|float|path|file|list\[.*\])>")
# By pydantic's name of what is wrong with a value, what the value has to be instead.
NEEDED = {
    "int_parsing": "a whole number is needed",
    "float_parsing": "a number is needed",
    "greater_than_equal": "at least {ge:g} is needed",
    "less_than_equal": "at most {le:g} is possible",
}


def run(command: str, work: Callable[[], int | None]) -> int:
    """Do `work` and turn its outcome into an exit code, with one sentence on stderr.

    Work may return another one. ``GCLIP_TRACEBACK=1`` shows the traceback of a fault of our own.
    """
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # where the terminal can't show a name's letters
    signals: list[int] = []
    try:
        return until_interrupted(work, signals) or DONE
    except KeyboardInterrupt:
        _print_error(command, "stopped; nothing half-written is left behind.")
        return 128 + signals[0] if signals else INTERRUPTED
    except (BrokenPipeError, SystemExit) as error:  # the second by rich, which writes --help
        if BrokenPipeError not in (type(error), type(error.__context__)):
            raise
        # Python flushes stdout again at exit: give it somewhere to go (see the docs of signal).
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except Exception as error:
        code, sentence = verdict(error)
        if code == OUR_FAULT and os.environ.get("GCLIP_TRACEBACK"):
            raise
        _print_error(command, sentence)
        return code


def verdict(error: Exception) -> tuple[int, str]:
    """The exit code that an error stands for, and the one sentence it is told with."""
    if isinstance(error, UserError):
        return BAD_INPUT, str(error)
    if isinstance(error, OSError) and error.filename is not None:
        name = printable(os.fsdecode(error.filename), 200)
        return BAD_INPUT, f"{name}: {error.strerror or error}."
    if isinstance(error, OSError) and error.errno in LIMITS:
        return BAD_INPUT, f"{error.strerror or error}."
    if isinstance(error, (ImportError, OSError)) and "shared object" in str(error):  # as ld.so says
        return BAD_INPUT, f"a library of the system can't be loaded: {error}."
    if isinstance(error, MemoryError):
        return BAD_INPUT, "out of memory; try fewer points, for example with `bake --voxel SIZE`."
    what = f"internal error ({type(error).__name__}: {error}); this is a fault of the program"
    return OUR_FAULT, f"{what}, please report it (set GCLIP_TRACEBACK=1 to see where)."


def _complaint(error: Any) -> str:
    """What is wrong with the words of a command line, by an exception of typer's."""
    if error.__cause__ is None:
        return str(getattr(error, "format_message", error.__str__)()).rstrip(".")
    wrong, option = error.__cause__.errors()[0], error.param.get_error_hint().replace("'", "")
    if wrong["type"] not in NEEDED:
        return f"{option}: {wrong.get('ctx', {}).get('error', wrong['msg'])}".rstrip(".")
    needed = NEEDED[wrong["type"]].format(**wrong.get("ctx", {}))
    return f"{option} is {wrong['input'] or repr('')}; {needed}"


def in_panels(panels: dict[str, str]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """List a command's options by what they are about, and its switches without a --no-.

    panels: the options' names under each title.
    """
    titles = {name: panel for panel, names in panels.items() for name in names.split()}

    def listed(command: Callable[..., Any]) -> Callable[..., Any]:
        for name, annotation in command.__annotations__.items():
            for option in getattr(annotation, "__metadata__", ()):
                option.rich_help_panel = titles.get(name)
                if annotation.__origin__ is bool and option.default is ...:  # no name was given
                    option.param_decls = (f"--{name.replace('_', '-')}",)
        return command

    return listed


def without_types(parser: Any) -> None:
    """Leave Python's types out of a command's help, and have it say ranges in words."""
    from typer import Context

    for command in (parser, *getattr(parser, "commands", {}).values()):
        for one in command.get_params(Context(command)):
            shown = one.display_type_rich
            one.display_type_rich = lambda ctx, shown=shown: TYPES.sub("", shown(ctx) or "")
            least, most = getattr(one, "min", None), getattr(one, "max", None)
            if least is not None:
                text = f"{least:g} or more" if most is None else f"{least:g} to {most:g}"
                one._get_number_range_help_str = lambda text=text: text


def run_app(app: Typer, command: str, argv: list[str] | None = None) -> int:
    """Run a typer app with `argv` (the process's own by default); returns the exit code."""
    from typer import Abort, Exit
    from typer.exceptions import TyperException
    from typer.main import get_command

    def work() -> int | None:
        parser = get_command(app)
        without_types(parser)
        try:
            with parser.make_context(command, sys.argv[1:] if argv is None else [*argv]) as context:
                code = parser.invoke(context)
            return code if isinstance(code, int) else None
        except Exit as ended:
            return ended.exit_code
        except TyperException as error:
            raise UserError(f"{_complaint(error)}; see `{command} --help`.") from None
        except Abort:
            raise KeyboardInterrupt from None

    code = run(command, work)
    if argv is None:
        gc.freeze()  # the process ends: to look for garbage once more took a third of a second
    if argv is None and code > 128:
        Lossy(sys.stdout).write("")
        os._exit(code)  # all is put away; threads deep in numbers would still be waited for
    return code


def _print_error(command: str, sentence: str) -> None:
    """On one line, whatever the names in it are made of: they come from files."""
    print(f"{command}: {printable(' '.join(sentence.split()))}", file=Lossy(sys.stderr))
