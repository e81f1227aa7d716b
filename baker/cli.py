"""The command `bake`: scans in, a growth clip out."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Literal

import typer

from baker.batch.outputs import Outputs
from baker.errors import InputError
from baker.options import (
    Align,
    Colors,
    Decay,
    Ground,
    Labels,
    Options,
    Paths,
    Precision,
    Segment,
    Transport,
    Up,
)
from gclip.terminal.command import run_app
from gclip.version import VersionOption

app = typer.Typer(add_completion=False, rich_markup_mode=None)


def _folder(text: str) -> Path:
    """Not the folder one happens to be in, where a variable of the shell was empty."""
    if not text:
        raise InputError("--cache has no name of a folder.")
    return Path(text)


@app.command(epilog="Exit codes: 0 done, 2 wrong usage or bad input, 1 a fault of our own.")
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
    align: Annotated[
        Align, typer.Option(help="Bring the scans into one frame; auto searches the turn.")
    ] = Align.auto,
    labels: Annotated[
        Labels, typer.Option(help="Do labels name the same organs in all scans?")
    ] = Labels.auto,
    segment: Annotated[
        Segment,
        typer.Option(
            help="auto takes labels where there are any, else organs: stem, blades and branches; "
            "thin cuts at forks."
        ),
    ] = Segment.auto,
    up: Annotated[Up, typer.Option(help="The axis along which the plant grows.")] = Up.auto,
    root: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y,Z",
            help='Where the stem leaves the ground; "virtual" where no label is a stem.',
        ),
    ] = None,
    times: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Lines of: scan's name, day or date.")
    ] = None,
    transport: Annotated[
        Transport, typer.Option(help="How transport is solved; whole: without any segments.")
    ] = Transport.auto,
    decay: Annotated[
        Decay, typer.Option(help="What organs do that a later scan no longer has.")
    ] = Decay.fall,
    paths: Annotated[
        Paths,
        typer.Option(help="How points travel: straight, or curved as organs bend (usual)."),
    ] = Paths.auto,
    paper: Annotated[
        bool, typer.Option("--paper", help="Choose as Golla et al. (2020) do, throughout.")
    ] = False,
    bifurcation: Annotated[
        int | None,
        typer.Option(
            min=0, metavar="N", help="A branch longer than N edges makes a fork (segment thin)."
        ),
    ] = None,
    bud: Annotated[
        int | None,
        typer.Option(
            min=1, metavar="L", help="Points a new organ unfolds from; 1 % of what it grows on."
        ),
    ] = None,
    smooth: Annotated[
        bool,
        typer.Option(
            "--smooth",
            help="Steady organs that sway back and forth from scan to scan; scans are then no "
            "longer met exactly.",
        ),
    ] = False,
    even: Annotated[
        float | None,
        typer.Option(
            min=0,
            max=10,
            metavar="SHARE",
            help="Movers to add at most where they would be sparse between scans; usually 1, "
            "as many again as there are.",
        ),
    ] = None,
    colors: Annotated[
        Colors,
        typer.Option(
            help="Colours to carry: the scans' own, one for each scan's segments, or none."
        ),
    ] = Colors.scan,
    label_field: Annotated[
        str | None, typer.Option(metavar="NAME", help="The scans' field that holds the labels.")
    ] = None,
    ground: Annotated[
        Ground, typer.Option(help="Soil or table under the plant: taken out (auto), or kept.")
    ] = Ground.auto,
    voxel: Annotated[
        float | None,
        typer.Option(metavar="SIZE", help="Keep one point per organ and cube of this size."),
    ] = None,
    every: Annotated[int, typer.Option(min=1, metavar="N", help="Use only each N-th scan.")] = 1,
    outliers: Annotated[
        float | None,
        typer.Option(
            metavar="R",
            help="Drop points whose neighbours are R standard deviations too far; try 2.",
        ),
    ] = None,
    denoise: Annotated[
        int | None,
        typer.Option(
            min=4, metavar="K", help="Draw points onto planes through K neighbours; try 20."
        ),
    ] = None,
    resample: Annotated[
        int | None,
        typer.Option(min=10, metavar="N", help="Keep about N points of a scan, evenly spread."),
    ] = None,
    neighbors: Annotated[
        int, typer.Option(min=1, help="Neighbours in the transport's support (k).")
    ] = 15,
    graph_neighbors: Annotated[
        int, typer.Option(min=1, help="Neighbours in the graph of segment thin (k).")
    ] = 15,
    precision: Annotated[
        Precision, typer.Option(help="auto stores 16 bits a coordinate where that is fine enough.")
    ] = Precision.auto,
    unit: Annotated[str, typer.Option(help="The scans' length unit, e.g. mm.")] = "",
    workers: Annotated[int, typer.Option(min=0, help="Cores to use; 0 takes all.")] = 0,
    cache: Annotated[
        Path | None,
        typer.Option(
            parser=_folder,
            metavar="DIR",
            help="Keep finished intervals there, and take what an earlier bake has kept.",
        ),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Bake on the workers of this dask scheduler.",
        ),
    ] = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force", help="Of many plants, bake those again whose clips are up to date, too."
        ),
    ] = False,
    holdout: Annotated[
        int | None,
        typer.Option(
            min=2,
            metavar="N",
            help="Bake without every Nth scan (never the first or last), then compare with them.",
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="OUT.html",
            help="Write what was done and found, with pictures; of many plants into a folder.",
        ),
    ] = None,
    traits: Annotated[
        Path | None,
        typer.Option(metavar="OUT.csv", help="Write lengths, areas and growth, organ by organ."),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Say nothing but errors.")] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Say what was found in each scan.")
    ] = False,
    version: VersionOption = False,
) -> int:
    """Bake 3D scans of a growing plant into a growth clip; or of many plants, a clip each."""
    options = Options(
        align=align,
        labels=labels,
        segment=segment,
        up=up,
        root=_root(root),
        times=times,
        label_field=label_field,
        ground=ground,
        voxel=voxel,
        outliers=outliers,
        denoise=denoise,
        resample=resample,
        every=every,
        transport=transport,
        neighbors=neighbors,
        graph_neighbors=graph_neighbors,
        bifurcation=bifurcation,
        paper=paper,
        holdout=holdout,
        bud=bud,
        smooth=smooth,
        even=even,
        decay=decay,
        paths=paths,
        colors=colors,
        precision=precision,
        unit=unit,
        workers=workers,
    )
    outputs = Outputs(
        clip=Path(output),
        report=report,
        traits=traits,
        cluster=cluster,
        cache=cache,
        force=force,
        quiet=quiet,
        verbose=verbose,
    )
    from baker.batch.command import run  # and with it numpy: not for --help

    return run(inputs, output, options, outputs, list_only)


def _root(text: str | None) -> tuple[float, float, float] | Literal["virtual"] | None:
    if text is None:
        return None
    if text == "virtual":
        return "virtual"
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f'--root is "{text}"; three numbers, like 0,0,-12.5, or virtual is needed.'
        ) from None
    return x, y, z


def main(argv: list[str] | None = None) -> int:
    """Run `bake` with arguments (the process's own by default); returns the exit code."""
    # Read when numpy is loaded. How many threads share a sum decides how it is rounded: a clip's
    # bytes must not depend on the machine's cores, which have other work anyway.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    return run_app(app, "bake", argv)
