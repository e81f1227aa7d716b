"""The command `bake`: scans in, a growth clip out."""

import ctypes
import gc
from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from baker.options import Options, Outputs
from gclip.terminal.command import VersionOption, run_app

M_ARENA_MAX = -8  # in glibc's malloc.h

app = typer.Typer(add_completion=False, rich_markup_mode="rich")

PANELS = {
    "Input": "times label_field drop_label columns fields scale unit ground voxel outliers "
    "resample every",
    "Alignment": "align up root",
    "Organs": "labels corrections segment graph_neighbors bifurcation",
    "Motion": "decay paths bud even smooth transport neighbors gamma tolerance iterations paper",
    "Output": "report traits colors precision holdout cache cluster workers force quiet verbose",
}
"""Panel of `bake --help` -> names of its options, in their order there."""


def _with_flags(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command one parameter for each field of `Options` and `Outputs` in `PANELS`."""
    *declared, _ = signature(command, eval_str=True).parameters.values()  # without **flags
    parameters = [parameter.replace(kind=Parameter.KEYWORD_ONLY) for parameter in declared]
    hints = get_type_hints(Options) | get_type_hints(Outputs)
    hints |= {"root": str | None, "corrections": str | None}  # typer parses the text
    by_name = {field.name: field for field in (*fields(Options), *fields(Outputs))}
    for name in " ".join(PANELS.values()).split():
        settings = dict(by_name[name].metadata["settings"])
        names = [f"--{name.replace('_', '-')}", *settings.pop("short", [])]
        option = typer.Option(*names, **settings, case_sensitive=False)  # allows --up Z
        flag = Parameter(name, Parameter.KEYWORD_ONLY, default=by_name[name].default)
        parameters.append(flag.replace(annotation=Annotated[hints[name], option]))
    command.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
    command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return command


@app.command(epilog="Exit codes: 0 done, 2 wrong usage or bad input, 1 a fault of our own.")
@_with_flags
def bake_command(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="INPUT",
            readable=False,  # checked later: of many plants, one may be unreadable
            help="A folder of scans, or the files in order. Several folders, or a folder of such "
            "folders, are many plants.",
        ),
    ],
    output: Annotated[
        str,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT",
            help="The clip to write, OUT.gclip; of many plants the folder of their clips, OUT/.",
        ),
    ] = "",
    list_only: Annotated[
        bool, typer.Option("--list", help="Only say what would be baked, and how sure that is.")
    ] = False,
    version: VersionOption = False,
    **flags: Any,
) -> int:
    """Turn 3D scans of a growing plant into a growth clip, an animation that `play` shows.

    Example:  bake scans/ -o plant.gclip --unit mm --report report.html
    """
    options = Options(**{f.name: flags[f.name] for f in fields(Options)})
    written = {f.name: flags[f.name] for f in fields(Outputs) if f.name in flags}
    from baker.batch.command import run  # imports numpy, which --help does not need

    return run(inputs, output, options, Outputs(clip=Path(output), **written), list_only)


def share_arena() -> None:
    """Let all threads allocate from one arena of glibc's malloc.

    Memory that one stage has freed then serves the threads of the next one: two scans of 440,000
    points take 364 instead of 406 MB, in the same time.
    """
    with suppress(AttributeError, OSError, TypeError):  # other C libraries have no arenas
        ctypes.CDLL(None).mallopt(M_ARENA_MAX, 1)


def main(argv: list[str] | None = None) -> int:
    """Run `bake` with these arguments (by default those of the process); returns the exit code."""
    share_arena()
    gc.disable()  # a bake makes few reference cycles, and is 4 % faster if none are looked for
    try:
        return run_app(app, "bake", argv, PANELS)
    finally:
        gc.enable()
