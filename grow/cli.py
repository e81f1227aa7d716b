"""The command `grow`: write scans of a procedural plant, and its true shape."""

from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import Annotated, Any

import typer

from baker.errors import InputError
from gclip.terminal.command import VersionOption, run_app

app = typer.Typer(add_completion=False, rich_markup_mode="rich")


PANELS = {
    "Plant": "scans days seed points",
    "Scanner": "noise unlabelled shuffle_labels pose colors suffix truth",
    "Depth camera": "per_day size label_shift",
}
"""Panel of `grow --help` -> names of its options, in their order there."""


class Kind(StrEnum):
    """The plants of `KINDS`, and the one of the depth camera."""

    maize = "maize"
    tomato = "tomato"
    tree = "tree"
    tree1 = "tree1"
    tree2 = "tree2"
    komatsuna = "komatsuna"


class Format(StrEnum):
    """The suffixes of `grow.formats.WRITERS`."""

    ply = "ply"
    txt = "txt"
    xyz = "xyz"
    csv = "csv"
    pcd = "pcd"
    las = "las"
    laz = "laz"


@app.command(epilog="Exit codes: 0 done, 2 wrong usage or bad input, 1 a fault of our own.")
def grow_command(
    kind: Annotated[
        Kind,
        typer.Argument(
            metavar="PLANT",
            help="The plant: maize, tomato or tree; tree1 and tree2 are bare trees of the sizes in "
            "the paper, komatsuna is a rosette, seen by a depth camera instead of scanned.",
        ),
    ],
    folder: Annotated[Path, typer.Argument(metavar="OUTDIR", help="Where to write the scans.")],
    scans: Annotated[
        int | None, typer.Option(metavar="N", help="How many scans, evenly spread.")
    ] = None,
    points: Annotated[
        str | None,
        typer.Option(
            metavar="N", help="Points of each scan; or FIRST,LAST, growing with the plant."
        ),
    ] = None,
    days: Annotated[
        float | None, typer.Option(metavar="N", help="How many days the series spans.")
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Another number, another plant.")] = 0,
    noise: Annotated[
        float | None,
        typer.Option(metavar="MM", help="Standard deviation of the points' noise, in mm."),
    ] = None,
    unlabelled: Annotated[bool, typer.Option(help="Leave the labels out.")] = False,
    colors: Annotated[
        bool, typer.Option("--colors/--no-colors", help="Write the plant's colours.")
    ] = True,
    suffix: Annotated[Format, typer.Option("--format", help="Format of the scans.")] = Format.ply,
    truth: Annotated[
        str | None,
        typer.Option(
            metavar="DAYS",
            help="Write the true plant at these days, such as 5,6.5, to OUTDIR/truth.",
        ),
    ] = None,
    shuffle_labels: Annotated[
        bool, typer.Option(help="Renumber the organs in every scan.")
    ] = False,
    pose: Annotated[
        bool, typer.Option(help="Turn and shift every scan but the first at random.")
    ] = False,
    per_day: Annotated[
        int | None, typer.Option(metavar="N", help="Images a day of komatsuna; 6 by default.")
    ] = None,
    size: Annotated[
        str | None,
        typer.Option(metavar="WxH", help="Size of its images in pixels; 480x360 by default."),
    ] = None,
    label_shift: Annotated[
        float | None,
        typer.Option(metavar="PIXELS", help="How far its labels are misplaced; 0 by default."),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Overwrite the scans that OUTDIR holds.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Say nothing.")] = False,
    version: VersionOption = False,
) -> None:
    """Grow a plant and scan it: labelled, coloured point clouds, and what is true between them.

    Example:  grow maize scans --truth 5,6.5 && bake scans -o maize.gclip
    """
    for_images: dict[str, object] = {
        "--per-day": per_day,
        "--size": size,
        "--label-shift": label_shift,
    }
    for_scans: dict[str, object] = {
        "--scans": scans,
        "--points": points,
        "--no-colors": not colors,
        "--format": suffix is not Format.ply,
        "--truth": truth,
        "--shuffle-labels": shuffle_labels,
        "--pose": pose,
    }
    _refuse(kind, for_scans if kind is Kind.komatsuna else for_images)

    def report_progress(name: str, count: int) -> None:
        if not quiet:
            unit = "labelled pixels" if kind is Kind.komatsuna else "points"
            print(f"{name}  {count:,} {unit}", flush=True)

    if kind is Kind.komatsuna:
        from grow import images

        faults = images.Faults(**_specified(noise=noise, labels=label_shift))
        specified = _specified(days=_whole_days(days), per_day=per_day, size=_size(size))
        image_plan = images.ImagePlan(seed=seed, labels=not unlabelled, faults=faults, **specified)
        images.write_images(image_plan, folder, force, report_progress)
        return

    from grow import series

    plan = series.Plan(
        kind=kind.value,
        seed=seed,
        scans=scans,
        days=days,
        points=_points(points),
        noise=noise,
        labels=not unlabelled,
        colors=colors,
        suffix=suffix.value,
        truth=() if truth is None else _numbers("--truth", truth),
        shuffle=shuffle_labels,
        pose=pose,
    )
    series.write_series(plan, folder, force, report_progress)


def _refuse(kind: Kind, options: dict[str, object]) -> None:
    """Raise InputError for options that the user set but that do not apply to this plant."""
    for name, value in options.items():
        if value is not None and value is not False:
            raise InputError(f"{name} means nothing for {kind.value}; see grow --help.")


def _specified(**values: Any) -> dict[str, Any]:
    """The values that are not None, which replace defaults."""
    return {name: value for name, value in values.items() if value is not None}


def _whole_days(days: float | None) -> int | None:
    """The argument of --days as a whole number."""
    if days is not None and not days.is_integer():
        raise InputError(f"--days {days:g}: komatsuna takes whole days.")
    return None if days is None else int(days)


def _size(text: str | None) -> tuple[int, int] | None:
    """Parse the argument of --size, width and height in pixels."""
    if text is None:
        return None
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise InputError(f"--size {text}: width and height are needed, as 480x360.")
    return int(width), int(height)


def _points(text: str | None) -> tuple[int, int] | None:
    """Parse the argument of --points: the numbers of points of the first and last scan."""
    if text is None:
        return None
    numbers = _numbers("--points", text)
    if len(numbers) > 2 or any(number != int(number) for number in numbers):
        raise InputError(f"--points {text}: give one whole number, or two, as 1700,5000.")
    return int(numbers[0]), int(numbers[-1])


def _numbers(option: str, text: str) -> tuple[float, ...]:
    """Parse finite numbers separated by commas, the argument of an option."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if not numbers or not all(isfinite(number) for number in numbers):
        raise InputError(f"{option} {text}: numbers separated by commas are needed, as 5,6.5.")
    return numbers


def main(argv: list[str] | None = None) -> int:
    """Run `grow` with these arguments (by default those of the process); returns the exit code."""
    return run_app(app, "grow", argv, PANELS)
