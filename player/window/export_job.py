"""Exports in a process of their own, which the window follows and can stop."""

import multiprocessing
import signal
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import gclip
from gclip.errors import UserError
from player.export.film import Film
from player.export.formats import FORMATS, STILL, export, format_of
from player.output_names import unused_path
from player.view.annotations import Annotations
from player.view.camera_animation import CameraPath, load_path, save_path
from player.view.choices import Request
from player.view.state import ExportProgress, Scene
from player.window.opened_clip import OpenClip
from traits.dates import date_at

STOP_SECONDS = 5.0  # for which a stopped export may remove temporary files before it is killed


def run_export(clip: str, film: Film, output: Path, events: Any) -> None:
    """Export in this process; sending progress fails, and so ends it, once `events` is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # on Ctrl-C the window stops this process
    progress = partial(ExportProgress, output.name)
    try:
        export(gclip.open(clip), film, output, lambda *steps: events.send(progress(*steps)))
        ended = saved_notice(output)
    except Exception as error:
        failure = f"Exporting {output.name} failed: {error or type(error).__name__}."
        ended = str(error) if isinstance(error, UserError) else failure
    with suppress(OSError):
        events.send(progress(ended=ended))


class ExportJob:
    """Carries out a scene's requests; exports run one at a time in a process of their own.

    state: progress of the running export, if there is one.
    """

    def __init__(self) -> None:
        self.state: ExportProgress | None = None

    def begin(self, clip: Path, film: Film, output: Path) -> None:
        """Start an export."""
        spawning = multiprocessing.get_context("spawn")
        self.state = ExportProgress(output.name)
        self._events, sending = spawning.Pipe(duplex=False)
        arguments = (str(clip), film, output, sending)
        self._process: Any = spawning.Process(target=run_export, args=arguments, daemon=True)
        self._process.start()
        sending.close()

    def stop(self) -> None:
        """Make the export fail when it next reports progress, so that it removes its files."""
        self._events.close()

    def release(self) -> None:
        """Stop the export, and kill its process if it does not end soon."""
        if self.state:
            self.stop()
            self._process.join(STOP_SECONDS)
            self._process.kill()

    def with_progress(self, scene: Scene) -> Scene:
        """Update the scene's progress of the export, or report its end."""
        if self.state is None:
            return replace(scene, exporting=None)
        exited, ended = not self._process.is_alive(), ""
        try:
            while not self.state.ended and self._events.poll():
                self.state = self._events.recv()
            ended = self.state.ended
        except EOFError:
            ended = f"Exporting {self.state.name} failed."
        except OSError:  # `stop` closed the pipe
            ended = f"Stopped exporting {self.state.name}." if exited else ""
        self.state = None if ended else self.state
        return replace(scene, exporting=self.state, notice=ended or scene.notice)

    def handle_request(self, scene: Scene, opened: OpenClip, area: tuple[int, int]) -> Scene:
        """Carry out a scene's request, and return the scene without it and with a notice.

        area: (width, height) in pixels of the part of the window that shows the plant.
        Raises UserError if a file cannot be written.
        """
        request, example, name = scene.request, scene.output.example, opened.name
        scene, day = replace(scene, request=None), scene.timeline.day
        if request is Request.CAMERA_KEY:
            file = (opened.file or Path(name)).parent / f"{name}.camera.json"
            previous = load_path(file, opened.clip) if file.exists() else scene.path
            path = previous.with_key(day, scene.camera)
            save_path(path, opened.clip, file)
            return replace(scene, path=path, notice=f"{saved_notice(file)}, {len(path.keys)} keys")
        if opened.file is None:
            return scene.with_notice("Only clips that were opened from a file can be exported.")
        if self.state is not None and request is Request.EXPORT:
            self.stop()
            return scene.with_notice("Stopping …")
        if self.state is not None:
            return scene.with_notice(f"{self.state.name} is being exported; E stops it.")
        if request is Request.PICTURE:
            example, name = "still.png", f"{name} {date_at(opened.clip.scans, day)}"
        file, film = unused_path(name, example), film_of(scene, example, area, name)
        format_of(file, film)
        self.begin(opened.file, film, file)
        return scene.with_notice(f"Exporting {file}")


def film_of(scene: Scene, example: str, area: tuple[int, int], name: str) -> Film:
    """A film with camera, style and annotations of a scene, in a format named by its example.

    If the film is narrower than the window, the camera moves back so that nothing is cut off.
    area: (width, height) in pixels of the part of the window that shows the plant.
    """
    chosen = next(known for known in FORMATS if known.example == example)
    width, height = scene.output.size or (area[0] // 2 * 2, area[1] // 2 * 2)
    zoom = min((width / height) / (area[0] / area[1]), 1.0)
    cameras = scene.path.keys if scene.following else ((scene.timeline.day, scene.camera),)
    return Film(
        size=(max(width, 16), max(height, 16)),
        turning=scene.turning,
        style=scene.style,
        at=(scene.timeline.day,) if chosen.moments == STILL else (),
        transparent=scene.output.transparent and chosen.suffixes[0] == ".png",
        name=name,
        path=CameraPath(tuple((day, camera.zoom(zoom)) for day, camera in cameras)),
        annotations=Annotations(False, scene.guides, scene.legend and scene.color_mode != "scan"),
    )


def saved_notice(file: Path) -> str:
    """A notice with name and folder of a new file."""
    return f"Saved {file.name} in {file.parent.resolve()}"
