"""What can be exported, by the suffix of the output's name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from player.errors import PlayerError
from player.export import gif, mp4, png
from player.export.film import Film
from player.export.output import check_folder

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gclip import Clip
    from player.render import Offscreen

Progress = Callable[[int, int], None]  # frames drawn, frames in all
Writer = Callable[["Clip", Film, Path, Progress], None]


def export(
    clip: Clip, film: Film, path: Path, progress: Progress = lambda done, total: None
) -> None:
    """Draw a film or a picture into `path`: whole or not at all.

    Raises PlayerError for an unknown suffix, a missing folder, a size or speed that the format
    can't hold, no OpenGL, or an encoder that fails.
    """
    writer = format_of(path, film)
    writer(clip, film, path, progress)


def format_of(path: Path, film: Film) -> Writer:
    """How to write `path`; refuses here, before any work, what can't come out well."""
    writers = {".mp4": _mp4, ".gif": _gif, ".png": _png}
    suffix = path.suffix.lower()
    if path.is_dir():
        raise PlayerError(f"{path} is a folder; a file's name, like film.mp4, is needed.")
    if suffix not in writers:
        raise PlayerError(
            f'{path}: "{suffix}" is no known suffix; film.mp4, film.gif, still.png and '
            "frames/%04d.png are."
        )
    sequence = suffix == ".png" and png.is_sequence(path)
    check_folder(path.parent if sequence else path)
    if suffix == ".png" and not sequence:
        if len(film.at) > 1:
            raise PlayerError(f"{path.name} holds one --day; for several name it like %04d.png.")
        return _still
    if film.at and suffix != ".png":
        raise PlayerError(f"--day is for pictures, like still.png; {path.name} is a film.")
    if suffix == ".mp4":
        mp4.check(film)
    if suffix == ".gif":
        gif.check(film)
    return writers[suffix]


def _mp4(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    with _offscreen(clip, film) as offscreen:
        mp4.write(_counted(film, clip, offscreen, progress), film, path)


def _gif(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    with _offscreen(clip, film) as offscreen:
        days, camera = film.days(clip), film.camera(clip)
        chosen = days[:: max(1, len(days) // gif.SAMPLES)]
        samples = [offscreen.picture(day, camera, film.style)[::2, ::2] for day in chosen]
        gif.write(_counted(film, clip, offscreen, progress), film, path, samples)


def _png(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    views = [camera.matrix(film.aspect) for camera in film.cameras(clip)]
    with _offscreen(clip, film) as offscreen:
        png.write_sequence(_counted(film, clip, offscreen, progress), path, views)


def _still(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    day = film.at[0] if film.at else clip.times[-1]
    camera = film.camera(clip)
    with _offscreen(clip, film) as offscreen:
        picture = offscreen.picture(day, camera, film.style)
        png.write_one(picture, path, camera.matrix(film.aspect))
    progress(1, 1)


def _offscreen(clip: Clip, film: Film) -> Offscreen:
    from player.render import Offscreen

    return Offscreen(clip, film.size)


def _counted(film: Film, clip: Clip, offscreen: Offscreen, progress: Progress) -> Iterator[NDArray]:
    total = film.frame_count(clip)
    progress(0, total)
    for done, picture in enumerate(film.frames(clip, offscreen), start=1):
        yield picture
        progress(done, total)
