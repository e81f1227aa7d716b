"""The table of export formats, which are selected by the suffix of the output's name."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, replace
from os import PathLike
from pathlib import Path
from typing import Any, Literal

from gclip import Clip
from gclip.terminal.atomic import atomic_file, check_output
from player.errors import PlayerError
from player.export import gltf, image, ply, table, usd, video
from player.export.film import Film, Progress
from player.export.web import page
from player.output_names import check_sequence, is_numbered
from player.view.colors import Colors
from player.view.style import STYLE_OPTIONS, ColorMode, Style

MAX_FRAMES = 200_000  # larger numbers are most likely typing errors

# Options of `play` that have an effect on what a format holds,
VIEW = f"{STYLE_OPTIONS} size camera title"
OPTIONS = {
    "picture": f"{VIEW} date scale_bar legend transparent",
    "page": VIEW,
    "points": "color colormap field title",
    "numbers": "title",
}
# and that select the moments which it shows
FILM, STILL, FRAMES, TABLE = "fps seconds every", "day", "fps seconds every day", "every day"


@dataclass(frozen=True)
class Format:
    """A kind of file that a clip can be exported to."""

    example: str  #: name of an output; with a number field, the format is a sequence of files
    about: str  #: short description for users
    write: Callable[[Clip, Film, Path, Progress], None]
    content: Literal["picture", "points", "page", "numbers"]
    moments: str = ""  #: options that select the moments that are shown, by default all of them
    other_suffixes: tuple[str, ...] = ()

    @property
    def is_sequence(self) -> bool:
        """Whether the format is a numbered sequence of files."""
        return is_numbered(Path(self.example))

    @property
    def options(self) -> list[str]:
        """The names of the options of `play` that have an effect."""
        return [*OPTIONS[self.content].split(), *self.moments.split()]

    @property
    def suffixes(self) -> tuple[str, ...]:
        """All suffixes that select the format."""
        return (Path(self.example).suffix, *self.other_suffixes)


def export(
    clip: Clip,
    film: Film,
    path: Path,
    progress: Progress = lambda done, total: None,
    force: bool = True,
) -> None:
    """Write a film, picture, page, geometry file or table atomically.

    path:     its suffix selects the format.
    progress: called with the number of steps done and of all steps.
    force:    whether to overwrite an existing file.

    Raises PlayerError for an unknown suffix, a missing folder, an existing file, a size or frame
    rate that the format cannot hold, missing OpenGL, or an encoder that fails.
    """
    chosen = format_of(path, film, force)
    for day in film.at:
        clip.check_day(day)
    count = film.frame_count(clip)
    if "every" in chosen.moments and count > MAX_FRAMES:
        raise PlayerError(f"{count} frames would be written; at most {MAX_FRAMES} are.")
    mode = film.style.color_mode(clip)
    if chosen.content in ("points", "page") and mode.quantity.changes_in_time:
        others = ", ".join(one for one in ColorMode if not one.quantity.changes_in_time)
        raise PlayerError(
            f"--color {mode} changes while the plant grows, so it is for pictures and films; "
            f"{path.name} takes {others}."
        )
    colored = Colors(clip).clip_with_colors(film.style, without_scans=chosen.content == "points")
    with atomic_file(path, force, chosen.is_sequence) as part:
        chosen.write(colored, film, part, progress)


def film(clip: Clip, path: str | PathLike[str], **choices: Any) -> None:
    """Write a film, picture, page, geometry file or table, in the format of the path's suffix.

    Parameters
    ----------
    clip : gclip.Clip
    path : path
        Its suffix is one of those that ``play --list-exports`` lists.
    **choices
        Fields of `Film` and of its `Style`, such as ``seconds=10``, ``turning=True`` or
        ``color_by="height"``.

    Raises
    ------
    PlayerError
        As `export` does.
    TypeError
        For an unknown choice.
    """
    style_fields = {field.name for field in fields(Style)}
    style = Style(**{name: choices.pop(name) for name in style_fields & choices.keys()})
    export(clip, replace(Film(style=style), **choices), Path(path))


def format_of(path: Path, film: Film, force: bool = True) -> Format:
    """The format of an output path.

    Raises PlayerError if the format cannot hold the film, or if a file exists and `force` is false.
    """
    suffix = path.suffix.lower()
    candidates = [known for known in FORMATS if suffix in known.suffixes]
    if not candidates:
        names = ", ".join(dict.fromkeys(name for known in FORMATS for name in known.suffixes))
        found = f'has the unknown suffix "{suffix}"' if suffix else "has no suffix"
        raise PlayerError(f"{path} {found}; the suffix says what is written: {names}.")
    numbered = is_numbered(path)
    chosen = next((known for known in candidates if known.is_sequence == numbered), None)
    if chosen is None:
        allowed = "only pictures and point clouds can be numbered"
        raise PlayerError(f"{path.name} is numbered; {allowed}.")
    (check_sequence if numbered else check_output)(path, force)
    if len(film.at) > 1 and chosen.moments == STILL:
        raise PlayerError(f"{path.name} holds one --day; for several name it like %04d.png.")
    if film.at:
        _check_options(chosen, path, ["day"])
    if film.transparent and suffix != ".png":
        raise PlayerError(f"--transparent is for PNG pictures; {path.name} holds no transparency.")
    if film.at and film.every is not None:
        raise PlayerError("--day and --every each say which moments to show; give one of them.")
    return chosen


def check_export(film: Film, path: Path, force: bool, options: Iterable[str]) -> None:
    """Raise PlayerError as `format_of` does, and for options that have no effect on the format."""
    chosen = format_of(path, film, force)
    _check_options(chosen, path, options)
    if film.path and chosen.content == "page":
        raise PlayerError(f"{path.name} has a camera that turns or stands still, without a path.")


def _check_options(chosen: Format, path: Path, options: Iterable[str]) -> None:
    for option in options:
        takers = [known for known in FORMATS if option in known.options]
        if takers and chosen not in takers:
            examples = ", ".join(known.example for known in takers)
            name = option.replace("_", "-")
            raise PlayerError(f"--{name} has no effect on {path.name}; it is for {examples}.")


FORMATS: tuple[Format, ...] = (
    Format("film.mp4", "film that plays everywhere", video.write, "picture", FILM, (".mov",)),
    Format("film.gif", "film for pages and slides", video.write_gif, "picture", FILM),
    Format("film.webm", "film for web pages (VP9)", video.write, "picture", FILM),
    Format("still.png", "one picture", image.write, "picture", STILL, image.JPEG_SUFFIXES),
    Format("frames/%04d.png", "frames as pictures", image.write, "picture", FRAMES,
           image.JPEG_SUFFIXES),
    Format("plant.html", "one page to turn and play in any browser, offline", page.write, "page"),
    Format("cloud.ply", "one point cloud, for any program", ply.write, "points", STILL),
    Format("clouds/%04d.ply", "point clouds, one a frame, for Blender", ply.write, "points",
           FRAMES),
    Format("plant.glb", "animated points, for Blender, three.js (glTF)", gltf.write, "points",
           FILM),
    Format("plant.usd", "points with time samples, for Houdini, Omniverse, Unreal", usd.write,
           "points", FILM, (".usda", ".usdc", ".usdz")),
    Format("traits.csv", "lengths, areas, growth of each organ", table.write, "numbers", TABLE),
)  # fmt: skip
