"""The table of export formats, which are selected by the suffix of the output's name."""

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

MAX_FRAMES = 200_000  # larger numbers are most likely typing errors


@dataclass(frozen=True)
class Format:
    """A kind of file that a clip can be exported to."""

    example: str  #: name of an output; with a number field, the format is a sequence of files
    about: str  #: short description for users
    write: Callable[[Clip, Film, Path, Progress], None]
    #: what styles and annotations apply to: pictures take all of them, points one colour each,
    #: pages colours and a camera, and tables of numbers none
    content: Literal["picture", "points", "page", "numbers"]
    max_days: int = 0  #: number of days that can be selected: 0, 1, or 2 for any number
    other_suffixes: tuple[str, ...] = ()

    @property
    def is_sequence(self) -> bool:
        """Whether the format is a numbered sequence of files."""
        return is_numbered(Path(self.example))

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
    count = film.frame_count(clip)
    if count > MAX_FRAMES:
        raise PlayerError(f"{count} frames would be written; at most {MAX_FRAMES} are.")
    colored = Colors(clip).clip_with_colors(film.style, as_file=chosen.content == "points")
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
    numbered = any(known.is_sequence for known in candidates) and is_numbered(path)
    chosen = next(known for known in candidates if known.is_sequence == numbered)
    (check_sequence if numbered else check_output)(path, force)
    if len(film.at) > 1 and chosen.max_days == 1:
        raise PlayerError(f"{path.name} holds one --day; for several name it like %04d.png.")
    if film.at and not chosen.max_days:
        raise PlayerError(f"--day is for pictures, clouds and tables; {path.name} shows all days.")
    if film.transparent and suffix != ".png":
        raise PlayerError(f"--transparent is for PNG pictures; {path.name} holds no transparency.")
    if film.at and film.every is not None:
        raise PlayerError("--day and --every each say which moments to show; give one of them.")
    return chosen


def check_look(film: Film, path: Path, force: bool) -> None:
    """Raise PlayerError as `format_of` does, and for a style that the format ignores."""
    content = format_of(path, film, force).content
    if film.annotations != Annotations() and content != "picture":
        raise PlayerError(
            f"--date, --scale-bar and --legend write into pictures and films; {path} is neither."
        )
    if content == "numbers" and (film.style != Style() or film.turning or film.path):
        raise PlayerError(f"{path} holds numbers alone: it has no colours, no floor, no camera.")


FORMATS: tuple[Format, ...] = (
    Format("film.mp4", "film that plays everywhere", video.write, "picture", 0, (".mov",)),
    Format("film.gif", "film for pages and slides", video.write_gif, "picture"),
    Format("film.webm", "film for web pages (VP9)", video.write, "picture"),
    Format("still.png", "one picture", image.write, "picture", 1, image.JPEG_SUFFIXES),
    Format("frames/%04d.png", "frames as pictures", image.write, "picture", 2, image.JPEG_SUFFIXES),
    Format("plant.html", "one page to turn and play in any browser, offline", page.write, "page"),
    Format("cloud.ply", "one point cloud, for any program", ply.write, "points", 1),
    Format("clouds/%04d.ply", "point clouds, one a frame, for Blender", ply.write, "points", 2),
    Format("plant.glb", "animated points, for Blender, three.js (glTF)", gltf.write, "points"),
    Format("plant.usd", "points with time samples, for Houdini, Omniverse, Unreal", usd.write,
           "points", 0, (".usda", ".usdc", ".usdz")),
    Format("traits.csv", "lengths, areas, growth of each organ", table.write, "numbers", 2),
)  # fmt: skip
