"""Exports beside the window: in a process of their own, with progress, and easily stopped."""

import multiprocessing
import signal
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import gclip
from gclip.errors import UserError
from player.export.film import Film
from player.export.formats import FORMATS, export, format_of
from player.output_names import free_name
from player.view.camera_animation import CameraPath, load_path, save_path
from player.view.choices import Wish
from player.view.dates import date_at
from player.view.state import Exporting, Scene
from player.window.opened_clip import OpenClip

PATIENCE = 5.0  # seconds that a stopped export has for tidying up


def run(clip: str, film: Film, output: Path, events: Any) -> None:
    """What the process does, until nobody listens to its events any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the window decides, also about Ctrl-C
    name = output.name
    try:
        export(
            gclip.open(clip), film, output,
            lambda done, total: events.send(Exporting(name, done, total)),
        )  # fmt: skip
        ended = saved(output)
    except Exception as error:
        failed = f"Exporting {name} failed: {error or type(error).__name__}."
        ended = str(error) if isinstance(error, UserError) else failed
    with suppress(OSError):
        events.send(Exporting(name, ended=ended))


class Exports:
    """What the user asks for once: camera paths in files, and one export at a time, in a process of
    its own, so that the window stays smooth.

    state: how far the export under way is, if there is one.
    """

    def __init__(self) -> None:
        self.state: Exporting | None = None

    def begin(self, clip: Path, film: Film, output: Path) -> None:
        fresh = multiprocessing.get_context("spawn")
        self.state, (self._events, sending) = Exporting(output.name), fresh.Pipe(duplex=False)
        job = (str(clip), film, output, sending)
        self._process: Any = fresh.Process(target=run, args=job, daemon=True)
        self._process.start()
        sending.close()

    def stop(self) -> None:
        """Ask the export to leave, and to leave nothing behind."""
        self._events.close()

    def release(self) -> None:
        """Stop it now, whatever it does."""
        if self.state:
            self.stop()
            self._process.join(PATIENCE)
            self._process.kill()

    def followed(self, scene: Scene) -> Scene:
        """The scene with how far the export under way is, or how it ended."""
        if self.state is None:
            return replace(scene, exporting=None)
        left, ended = not self._process.is_alive(), ""
        try:
            while not self.state.ended and self._events.poll():
                self.state = self._events.recv()
            ended = self.state.ended
        except EOFError:
            ended = f"Exporting {self.state.name} failed."
        except OSError:  # it was stopped
            ended = f"Stopped exporting {self.state.name}." if left else ""
        self.state = None if ended else self.state
        return replace(scene, exporting=self.state, notice=ended or scene.notice)

    def granted(self, scene: Scene, opened: OpenClip, area: tuple[int, int]) -> Scene:
        """Do what a scene wishes for; gives it without the wish, and with what came of that.

        area: (width, height) in pixels of the part of the window that shows the plant.
        Raises UserError.
        """
        wish, example, name = scene.wish, scene.output.example, opened.name
        scene, day = replace(scene, wish=None), scene.timeline.day
        if wish is Wish.CAMERA_KEY:
            file = Path(f"{name}.camera.json")
            before = load_path(file, opened.clip) if file.exists() else scene.path
            path = before.with_key(day, scene.camera)
            save_path(path, opened.clip, file)
            return replace(scene, path=path, notice=f"{saved(file)}, {len(path.keys)} keys")
        if opened.file is None:
            return scene.with_notice("Only clips that were opened from a file can be exported.")
        if self.state is not None and wish is Wish.EXPORT:
            self.stop()
            return scene.with_notice("Stopping …")
        if self.state is not None:
            return scene.with_notice(f"{self.state.name} is being exported; E stops it.")
        if wish is Wish.PICTURE:
            example, name = "still.png", f"{name} {date_at(opened.clip.scans, day)}"
        file, film = free_name(name, example), film_of(scene, example, area, name)
        format_of(file, film)
        self.begin(opened.file, film, file)
        return scene.with_notice(f"Exporting {file}")


def film_of(scene: Scene, example: str, area: tuple[int, int], name: str) -> Film:
    """The film that shows what the scene does: from the same place, in the same colours.

    A picture narrower than the window is taken from farther away, so that nothing is cut off.
    """
    chosen = next(one for one in FORMATS if one.example == example)
    width, height = scene.output.size or (area[0] // 2 * 2, area[1] // 2 * 2)
    wider = min((width / height) / (area[0] / area[1]), 1.0)
    cameras = scene.path.keys if scene.following else ((scene.timeline.day, scene.camera),)
    path = CameraPath(tuple((day, camera.zoom(wider)) for day, camera in cameras))
    return Film(
        size=(max(width, 16), max(height, 16)),
        turning=scene.turning,
        style=scene.style,
        at=(scene.timeline.day,) if chosen.days == 1 else (),
        transparent=scene.output.transparent and chosen.suffixes[0] == ".png",
        name=name,
        path=path,
    )


def saved(file: Path) -> str:
    """What to tell the user of a new file: its name, and the folder that it is in."""
    return f"Saved {file.name} in {file.parent.absolute()}"
