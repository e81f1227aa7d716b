"""The command `play`: shows clips in a window, exports them, or prints what they contain."""

import re
from collections.abc import Callable
from functools import partial
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import gclip
import player.export
import player.view
from gclip.terminal.command import VersionOption, run_app
from gclip.terminal.progress import StageProgress
from gclip.text import printable
from player.errors import PlayerError
from player.info import info_lines
from player.ui.keys import help_text
from player.view.style import STYLE_OPTIONS, ColorMap, ColorMode, GroundChoice, Style
from shaders.effects import EFFECTS
from traits.dates import day_of

if TYPE_CHECKING:
    from gclip import Clip
    from player.export import Film

app = typer.Typer(add_completion=False, rich_markup_mode="rich")

STILL, TURNTABLE = "still", "turntable"
# Suffixes of scans, which have to be baked first
SUFFIXES = {".ply", ".pcd", ".xyz", ".txt", ".csv", ".pts", ".las", ".laz", ".e57", ".npy", ".npz"}
EPILOG = "Exit codes: 0 done, 2 wrong usage or bad input, 1 a fault of our own.\n\n"
MAX_INFO_LINE = 2000  # characters of a line of --info
MIN_SIDE, MAX_SIDE = 16, 16384  # pixels; OpenGL 4.1 guarantees textures of this size

PANELS = {
    "View": f"size camera {STYLE_OPTIONS}",
    "Export": "export force list_exports fps seconds every day title date scale_bar legend "
    "transparent",
    "Window": "profile",
}
"""Options by the panels of `play --help`, in their order."""


def _list_exports(requested: bool) -> None:
    """Print the export formats, and exit, if the option is given."""
    if requested:
        for known in player.export.FORMATS:
            others = ", ".join(known.other_suffixes)
            typer.echo(f"{known.example:18}{known.about}{'; also ' * bool(others)}{others}")
        raise typer.Exit


def _option(metavar: str, help: str, **settings: Any) -> Any:
    """Declare an option with a value, which the help calls `metavar`."""
    return typer.Option(metavar=metavar, help=help, **settings)


def _flag(help: str, *names: str) -> Any:
    """Declare an option without a value."""
    return typer.Option(*names, help=help)


def _with_effects(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command an option for each effect, instead of ``**effects``."""
    *options, _ = signature(command).parameters.values()
    for one in EFFECTS:
        declare = _flag if one.is_switch else partial(_option, "FACTOR", min=0, max=one.limit)
        option: Any = Annotated[type(one.default), declare(one.help)]
        kind = Parameter.KEYWORD_ONLY
        options.append(Parameter(one.name, kind, default=one.default, annotation=option))
    command.__signature__ = Signature(options)  # type: ignore[attr-defined]
    return command


@app.command(epilog=EPILOG + help_text())
@_with_effects
def play_command(
    context: typer.Context,
    clips: Annotated[
        list[Path], typer.Argument(metavar="CLIP", help="One clip, or two to play in step.")
    ],
    export: Annotated[Path | None, _option("PATH", "Write film.mp4, ... (--list-exports).")] = None,
    info: Annotated[bool, _flag("Print what the clip holds.")] = False,
    list_exports: Annotated[
        bool, typer.Option(help="List what can be exported.", is_eager=True, callback=_list_exports)
    ] = False,
    size: Annotated[str | None, _option("WxH", "Size in pixels; 1280x720 by default.")] = None,
    fps: Annotated[int, _option("N", "Frames a second.", min=1, max=240)] = 30,
    seconds: Annotated[float | None, _option("S", "Length of a film.", min=0.01, max=36000)] = None,
    every: Annotated[float | None, _option("T", "A frame every T days.", min=1e-6)] = None,
    day: Annotated[
        list[str] | None, _option("DAY", "Day or date to show; may be repeated.")
    ] = None,
    camera: Annotated[
        str, _option("still|turntable|PATH.json", "turntable goes round once; or a camera path.")
    ] = STILL,
    color: Annotated[
        ColorMode, _flag("Colour by scan, organ (track) or value; error needs bake --holdout.")
    ] = ColorMode.AUTO,
    colormap: Annotated[ColorMap, _flag("The colours of values, such as heights.")] = ColorMap.AUTO,
    field: Annotated[str, _option("NAME", "The field that --color field shows.")] = "",
    ground: Annotated[
        GroundChoice | None, _flag("Background; dark, or as last in the window.")
    ] = None,
    point_size: Annotated[
        float, _option("FACTOR", "Multiplies the size of points.", min=0.05, max=20)
    ] = 1.0,
    title: Annotated[str, _option("TEXT", "A title in pictures, on pages and in tables.")] = "",
    date: Annotated[bool, _flag("Write the date into pictures.")] = False,
    scale_bar: Annotated[bool, _flag("Draw a scale bar into pictures.")] = False,
    legend: Annotated[bool, _flag("Explain the colours in pictures.")] = False,
    transparent: Annotated[bool, _flag("Leave the background out of PNGs.")] = False,
    profile: Annotated[bool, _flag("Print the GPU time of each render pass at the end.")] = False,
    force: Annotated[bool, _flag("Overwrite an output that exists.")] = False,
    quiet: Annotated[bool, _flag("Say nothing but errors.", "--quiet", "-q")] = False,
    version: VersionOption = False,
    **effects: Any,
) -> None:
    """Play a growth clip in a window, or export it as a film or pictures.

    Example:  play plant.gclip --export film.mp4 --camera turntable --date
    """
    for file in clips:
        if file.is_dir() or file.suffix.lower() in SUFFIXES:
            folder = file if file.is_dir() else file.parent
            raise PlayerError(f"{file} is not a growth clip; bake the scans first: bake {folder}")
    path = None if camera in (STILL, TURNTABLE) else Path(camera)
    if path is not None and path.suffix.lower() != ".json":
        raise PlayerError(f"--camera is {camera}; still, turntable or a camera path is needed.")
    if len(clips) > 2 or (len(clips) == 2 and (export or info)) or (export and info):
        raise PlayerError("--export and --info take one clip each; the window shows one or two.")
    if every is not None and seconds is not None:
        raise PlayerError("--every and --seconds each say how many frames; give one of them.")
    style = Style(color, colormap, field, ground or GroundChoice.DARK, point_size, **effects)
    clip, turning, given = gclip.open(clips[0]), camera == TURNTABLE, _given(context)
    days = tuple(_parse_day(clip, text) for text in day or [])
    if export is not None:
        if field and field not in clip.fields:
            known = ", ".join(clip.fields) or "none"
            raise PlayerError(f"--field is {field}; the clip has {known}.")
        film = player.export.Film(
            size=_parse_size(size) if size else player.export.Film.size,
            fps=fps,
            seconds=seconds,
            turning=turning,
            style=style,
            at=days,
            every=every,
            title=printable(title),
            annotations=player.view.Annotations(date, scale_bar, legend),
            transparent=transparent,
            name=printable(clips[0].stem),
            path=None if path is None else player.view.load_path(path, clip),
        )
        _export(clip, film, export, force, given, quiet)
    elif info:
        for line in info_lines(clip, clips[0]):
            typer.echo(printable(line, MAX_INFO_LINE))
    else:
        _check_window(given, days)
        pixels = _parse_size(size) if size else None
        from player.window.launch import start

        start(clips, style, pixels, ground, turning, path, profile, *days)


def _export(
    clip: "Clip", film: "Film", output: Path, force: bool, given: list[str], quiet: bool
) -> None:
    """Export, and report progress; options without effect on the output are refused."""
    player.export.check_export(film, output, force, given)
    with StageProgress(quiet) as progress:
        player.export.export(clip, film, output, partial(progress, "exporting"), force)
    if not quiet:
        typer.echo(f"wrote {output}", err=True)


def _check_window(given: list[str], days: tuple[float, ...]) -> None:
    """Raise PlayerError for options that have no effect in the window."""
    for name in PANELS["Export"].split():
        if name in given and name != "day":
            raise PlayerError(f"--{name.replace('_', '-')} is for exports; add --export PATH.")
    if len(days) > 1:
        raise PlayerError("the window opens on one --day; for several add --export PATH.")


def _given(context: typer.Context) -> list[str]:
    """The names of the options and arguments that the command line has."""
    sources = {name: context.get_parameter_source(name) for name in context.params}
    return [name for name, source in sources.items() if source and source.name == "COMMANDLINE"]


def _parse_day(clip: "Clip", text: str) -> float:
    """Parse --day, a time as a number or as a date in the style of the scans' dates."""
    day, first, last = day_of(clip.scans, text), clip.scans[0], clip.scans[-1]
    if day is None or not first.time <= day <= last.time:
        span = f"{first.time:g} to {last.time:g}"
        dates = f" ({first.date} to {last.date})" if first.date else ""
        raise PlayerError(f"--day is {text}; a time from {span}{dates} is needed.")
    return day


def _parse_size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,6})[xX×](\d{1,6})", text)
    width, height = (int(match[1]), int(match[2])) if match else (0, 0)
    if not MIN_SIDE <= min(width, height) <= max(width, height) <= MAX_SIDE:
        expected = f"width x height in pixels, like 1280x720, each from {MIN_SIDE} to {MAX_SIDE}"
        raise PlayerError(f'--size is "{text}"; {expected}, is needed.')
    return width, height


def main(argv: list[str] | None = None) -> int:
    """Run `play` with arguments, by default those of the process; returns the exit code."""
    return run_app(app, "play", argv, PANELS)
