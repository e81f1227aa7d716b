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
from player.export.image import save_screenshot
from player.output_names import free_name
from player.view.camera_animation import CameraPath, save_path
from player.view.choices import Wish
from player.view.dates import date_at
from player.view.state import Exporting, Scene
from player.window.opened_clip import OpenClip

PATIENCE = 5.0  # seconds that a stopped export has for tidying up
STILL = "still.png"


class Stopped(Exception):
    """The user stopped it."""


def run(clip: str, film: Film, output: str, events: Any, stop: Any) -> None:
    """What the process does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the window decides, also about Ctrl-C
    name = Path(output).name

    def progress(done: int, total: int) -> None:
        if stop.is_set():
            raise Stopped
        events.send(Exporting(name, done, total))  # fails where the window is gone

    try:
        export(gclip.open(clip), film, Path(output), progress)
        ended = saved(Path(output))
    except Stopped:
        ended = f"Stopped: {name} was not written."
    except UserError as error:
        ended = str(error)
    except Exception as error:
        ended = f"Exporting {name} failed: {error or type(error).__name__}."
    with suppress(OSError):
        events.send(Exporting(name, ended=ended))


class Exports:
    """What the user asks for once: pictures, camera paths in files, and one export at a time, in a
    process of its own, so that the window stays smooth.

    state: how far the export under way is, if there is one.
    """

    def __init__(self) -> None:
        self.state: Exporting | None = None
        self._process: Any = None

    def begin(self, clip: Path, film: Film, output: Path) -> None:
        fresh = multiprocessing.get_context("spawn")
        self.state, self._stop = Exporting(output.name), fresh.Event()
        self._events, sending = fresh.Pipe(duplex=False)
        job = (str(clip), film, str(output), sending, self._stop)
        self._process = fresh.Process(target=run, args=job, daemon=True)
        self._process.start()
        sending.close()

    def stop(self) -> None:
        """Ask the export to leave, and to leave nothing behind."""
        self._stop.set()

    def release(self) -> None:
        """Stop it now, whatever it does."""
        if self.state:
            self.stop()
            self._process.join(PATIENCE)
            self._process.kill()

    def followed(self, scene: Scene) -> Scene:
        """The scene with how far the export under way is, or how it ended."""
        state = self.state
        if state is None:
            return replace(scene, exporting=None)
        try:
            while not state.ended and self._events.poll():
                state = self._events.recv()
        except (EOFError, OSError):
            state = replace(state, ended=f"Exporting {state.name} failed.")
        if state.ended:
            self._process.join(PATIENCE)
        self.state = None if state.ended else state
        return replace(scene, exporting=self.state, notice=state.ended or scene.notice)

    def execute(
        self, scene: Scene, opened: OpenClip, area: tuple[int, int], pixels: bytes
    ) -> Scene:
        """Do what a scene wishes for; gives it without the wish, and with what came of that.

        area, pixels: (width, height) in pixels of the part of the window that shows the plant, and
                      its RGB, bottom row first.
        """
        try:
            told = self._told(scene, opened, area, pixels)
        except UserError as error:
            told = str(error)
        return replace(scene, wish=None, notice=told)

    def _told(self, scene: Scene, opened: OpenClip, area: tuple[int, int], pixels: bytes) -> str:
        output, name, example = scene.output, opened.name, scene.output.example
        if scene.wish is Wish.SAVE_PATH:
            file = Path(f"{name}.camera.json")
            save_path(scene.path, opened.clip, file)
            return saved(file)
        if scene.wish is Wish.PICTURE:
            example = STILL
            name += f" {date_at(opened.clip.scans, scene.timeline.day)}"
            if opened.file is None or (output.size is None and not output.transparent):
                return saved(save_screenshot(pixels, area, name))
        if opened.file is None:
            return "Only clips that were opened from a file can be exported."
        if self.state is not None:
            self.stop()
            return "Stopping …"
        file, film = free_name(name, example), film_of(scene, example, area, name)
        format_of(file, film)
        self.begin(opened.file, film, file)
        return f"Exporting {file}"


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
    folder = file.parent.absolute()
    home = Path.home()
    short = "~" / folder.relative_to(home) if folder.is_relative_to(home) else folder
    return f"Saved {file.name} in {short}"
