"""What can be exported, by the suffix of the output's name: one table that all messages read."""

from collections.abc import Callable
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
from player.view.annotations import Annotations
from player.view.colors import Colors
from player.view.style import Style

MAX_FRAMES = 200_000  # more are most likely a typing error


@dataclass(frozen=True)
class Format:
    """A kind of file that a clip can be exported to."""

    #: the name of an output, whose suffix selects the format; with a place for a number, such as
    #: %04d, the format is a sequence of files
    example: str
    about: str  #: what the file is, and for which programs
    write: Callable[[Clip, Film, Path, Progress], None]
    #: a picture is drawn, with everything that is written into it; points have one colour each; a
    #: page has colours and a camera; a table has numbers only
    content: Literal["picture", "points", "page", "numbers"]
    days: int = 0  #: how many --day the format takes: 0, 1, or 2 for any number
    also: tuple[str, ...] = ()  #: other suffixes

    @property
    def sequence(self) -> bool:
        return is_numbered(Path(self.example))

    @property
    def suffixes(self) -> tuple[str, ...]:
        return (Path(self.example).suffix, *self.also)


def export(
    clip: Clip,
    film: Film,
    path: Path,
    progress: Progress = lambda done, total: None,
    force: bool = True,
) -> None:
    """Write a clip's film, picture, page, geometry or table to `path`: whole or not at all.

    Raises PlayerError for an unknown suffix, a missing folder, a size or speed that the format
    can't hold, no OpenGL, or an encoder that fails; unless it is forced, for what is there already.
    """
    chosen = format_of(path, film, force)
    count = film.frame_count(clip)
    if count > MAX_FRAMES:
        raise PlayerError(f"{count} frames would be written; at most {MAX_FRAMES} are.")
    colored = Colors(clip).clip_with_colors(film.style, as_file=chosen.content == "points")
    with atomic_file(path, force, chosen.sequence) as part:
        chosen.write(colored, film, part, progress)


def film(clip: Clip, path: str | PathLike[str], **choices: Any) -> None:
    """Write a clip's film, picture, page, geometry or table, as the suffix of `path` says.

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
        For a choice that there is not.
    """
    look = {one.name for one in fields(Style)}
    style = Style(**{name: choices.pop(name) for name in look & choices.keys()})
    export(clip, replace(Film(style=style), **choices), Path(path))


def format_of(path: Path, film: Film, force: bool = True) -> Format:
    """The format of an output, by its suffix.

    Raises PlayerError if the format can't hold what is asked for, or a file exists and `force` is
    not given.
    """
    suffix = path.suffix.lower()
    known = [one for one in FORMATS if suffix in one.suffixes]
    if not known:
        names = ", ".join(dict.fromkeys(name for one in FORMATS for name in one.suffixes))
        found = f'has the unknown suffix "{suffix}"' if suffix else "has no suffix"
        raise PlayerError(f"{path} {found}; the suffix says what is written: {names}.")
    numbered = any(one.sequence for one in known) and is_numbered(path)
    chosen = next(one for one in known if one.sequence == numbered)
    (check_sequence if numbered else check_output)(path, force)
    if len(film.at) > 1 and chosen.days == 1:
        raise PlayerError(f"{path.name} holds one --day; for several name it like %04d.png.")
    if film.at and not chosen.days:
        raise PlayerError(f"--day is for pictures, clouds and tables; {path.name} shows all days.")
    if film.transparent and suffix != ".png":
        raise PlayerError(f"--transparent is for PNG pictures; {path.name} holds no transparency.")
    if film.at and film.every is not None:
        raise PlayerError("--day and --every each say which moments to show; give one of them.")
    return chosen


def check_look(film: Film, path: Path, force: bool) -> None:
    """Raise PlayerError as `format_of` does, and for a style that the format can't hold."""
    content = format_of(path, film, force).content
    if film.annotations != Annotations() and content != "picture":
        raise PlayerError(
            f"--date, --scale-bar and --legend write into pictures and films; {path} is neither."
        )
    if content == "numbers" and (film.style != Style() or film.turning or film.path):
        raise PlayerError(f"{path} holds numbers alone: it has no colours, no floor, no camera.")


FORMATS: tuple[Format, ...] = (
    Format("film.mp4", "film that plays everywhere", video.write, "picture", also=(".mov",)),
    Format("film.gif", "film for pages and slides", video.write_gif, "picture"),
    Format("film.webm", "film for web pages (VP9)", video.write, "picture"),
    Format("still.png", "one picture", image.write, "picture", 1, image.JPEG_SUFFIXES),
    Format("frames/%04d.png", "frames as pictures", image.write, "picture", 2, image.JPEG_SUFFIXES),
    Format("plant.html", "one page to turn and play in any browser, offline", page.write, "page"),
    Format("cloud.ply", "one point cloud, for any program", ply.write, "points", 1),
    Format("clouds/%04d.ply", "point clouds, one a frame, for Blender", ply.write, "points", 2),
    Format("plant.glb", "animated points, for Blender, three.js (glTF)", gltf.write, "points"),
    Format(
        "plant.usd",
        "points with time samples, for Houdini, Omniverse, Unreal",
        usd.write,
        "points",
        also=(".usda", ".usdc", ".usdz"),
    ),
    Format("traits.csv", "lengths, areas, growth of each organ", table.write, "numbers", 2),
)
