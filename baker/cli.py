"""The command `bake`: scans in, a growth clip out."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import fields
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

import typer

from baker.batch.outputs import Outputs
from baker.errors import InputError
from baker.options import Options
from gclip.terminal.command import run_app
from gclip.version import VersionOption

app = typer.Typer(add_completion=False, rich_markup_mode=None)


def _folder(text: str) -> Path:
    """Not the folder one happens to be in, where a variable of the shell was empty."""
    if not text:
        raise InputError("--cache has no name of a folder.")
    return Path(text)


def _root(text: str) -> tuple[float, float, float] | Literal["virtual"]:
    if text == "virtual":
        return "virtual"
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f'--root is "{text}"; three numbers, like 0,0,-12.5, or virtual is needed.'
        ) from None
    return x, y, z


FLAGS: dict[str, Any] = {
    "align": typer.Option(help="Bring scans into one frame; auto leaves those that share one."),
    "labels": typer.Option(help="Do labels name the same organs in all scans?"),
    "segment": typer.Option(
        help="auto takes labels where there are any, else organs: stem, blades and branches; "
        "thin cuts at forks."
    ),
    "up": typer.Option(help="The axis along which the plant grows."),
    "root": typer.Option(
        parser=_root,
        metavar="X,Y,Z",
        help='Where the stem leaves the ground; "virtual" where no label is a stem.',
    ),
    "times": typer.Option(metavar="FILE", help="Lines of: scan's name, day or date."),
    "transport": typer.Option(help="How transport is solved; whole: without any segments."),
    "decay": typer.Option(help="What organs do that a later scan no longer has."),
    "paths": typer.Option(help="How points travel: straight, or curved as organs bend (usual)."),
    "paper": typer.Option("--paper", help="Choose as Golla et al. (2020) do, throughout."),
    "bifurcation": typer.Option(
        min=0, metavar="N", help="A branch longer than N edges makes a fork (segment thin)."
    ),
    "bud": typer.Option(
        min=1, metavar="L", help="Points a new organ unfolds from; 1 % of what it grows on."
    ),
    "smooth": typer.Option(
        "--smooth",
        help="Steady organs that sway back and forth from scan to scan; scans are then no longer "
        "met exactly.",
    ),
    "even": typer.Option(
        min=0,
        max=10,
        metavar="SHARE",
        help="Movers to add at most where they would be sparse between scans; usually 1, as many "
        "again as there are.",
    ),
    "colors": typer.Option(
        help="Colours to carry: the scans' own, one for each scan's segments, or none."
    ),
    "label_field": typer.Option(metavar="NAME", help="The scans' field that holds the labels."),
    "drop_label": typer.Option(metavar="L", help="Leave out the points of label L; of more: L,M."),
    "columns": typer.Option(
        metavar="NAMES", help="What a text's columns are, as x,y,z,r,g,b,-,label."
    ),
    "scale": typer.Option(metavar="FACTOR", help="Multiply all coordinates by this."),
    "ground": typer.Option(help="Soil or table under the plant: taken out (auto), or kept."),
    "voxel": typer.Option(metavar="SIZE", help="Keep one point per organ and cube of this size."),
    "every": typer.Option(min=1, metavar="N", help="Use only each N-th scan."),
    "outliers": typer.Option(
        metavar="R",
        help="Drop points whose neighbours are R standard deviations too far; try 2.",
    ),
    "denoise": typer.Option(
        min=4, metavar="K", help="Draw points onto planes through K neighbours; try 20."
    ),
    "resample": typer.Option(
        min=10, metavar="N", help="Keep about N points of a scan, evenly spread."
    ),
    "neighbors": typer.Option(min=1, help="Neighbours in the transport's support (k)."),
    "graph_neighbors": typer.Option(min=1, help="Neighbours in the graph of segment thin (k)."),
    "precision": typer.Option(help="auto stores 16 bits a coordinate where that is fine enough."),
    "unit": typer.Option(help="The scans' length unit, e.g. mm."),
    "workers": typer.Option(min=0, help="Cores to use; 0 takes all."),
    "holdout": typer.Option(
        min=2,
        metavar="N",
        help="Bake without every Nth scan (never the first or last), then compare with them.",
    ),
    "cache": typer.Option(
        parser=_folder,
        metavar="DIR",
        help="Keep finished intervals there, and take what an earlier bake has kept.",
    ),
    "cluster": typer.Option(metavar="ADDRESS", help="Bake on the workers of this dask scheduler."),
    "force": typer.Option(
        "--force", help="Of many plants, bake those again whose clips are up to date, too."
    ),
    "report": typer.Option(
        metavar="OUT.html",
        help="Write what was done and found, with pictures; of many plants into a folder.",
    ),
    "traits": typer.Option(
        metavar="OUT.csv", help="Write lengths, areas and growth, organ by organ."
    ),
    "quiet": typer.Option("--quiet", "-q", help="Say nothing but errors."),
    "verbose": typer.Option("--verbose", "-v", help="Say what was found in each scan."),
}
"""How the command line says each field of `Options` and of `Outputs`."""


def _with_flags(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command a parameter for each of `FLAGS`, with the field's type and default."""
    defaults = {field.name: field.default for kind in (Options, Outputs) for field in fields(kind)}
    hints = get_type_hints(Options) | get_type_hints(Outputs) | {"root": str | None}
    own = signature(command, eval_str=True).parameters
    parameters = [own[name].replace(kind=Parameter.KEYWORD_ONLY) for name in own if name != "flags"]
    parameters += [
        Parameter(
            name,
            Parameter.KEYWORD_ONLY,
            default=defaults[name],
            annotation=Annotated[hints[name], flag],
        )
        for name, flag in FLAGS.items()
    ]
    command.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
    command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return command


@app.command(epilog="Exit codes: 0 done, 2 wrong usage or bad input, 1 a fault of our own.")
@_with_flags
def bake_command(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="INPUT...",
            readable=False,  # told later: of many plants one may be unreadable
            help="A folder of scans, or the files in order; several folders, or a folder of such "
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
        bool,
        typer.Option("--list", help="Only say what would be baked, and what is not sure of it."),
    ] = False,
    version: VersionOption = False,
    **flags: Any,
) -> int:
    """Bake 3D scans of a growing plant into a growth clip; or of many plants, a clip each."""
    options = Options(**{f.name: flags[f.name] for f in fields(Options)})
    written = {f.name: flags[f.name] for f in fields(Outputs) if f.name in flags}
    from baker.batch.command import run  # and with it numpy: not for --help

    return run(inputs, output, options, Outputs(clip=Path(output), **written), list_only)


def main(argv: list[str] | None = None) -> int:
    """Run `bake` with arguments (the process's own by default); returns the exit code."""
    # Read when numpy is loaded. How many threads share a sum decides how it is rounded: a clip's
    # bytes must not depend on the machine's cores, which have other work anyway.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    return run_app(app, "bake", argv)
