"""From what a window shows to an export of it, one at a time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from player.errors import PlayerError
from player.ui.panel import Exporting

if TYPE_CHECKING:
    from player.export.film import Film
    from player.view.state import Scene
    from player.window.export_job import Export

STILL = "still.png"


class Exports:
    """The export under way, if there is one."""

    def __init__(self) -> None:
        self._running: Export | None = None

    @property
    def progress(self) -> Exporting | None:
        if self._running is None:
            return None
        state = self._running.state
        return Exporting(self._running.name, state.done, state.total)

    def look(self) -> str:
        """What to tell the user: "" unless an export has just ended."""
        if self._running is None:
            return ""
        ended = self._running.look().ended
        if ended:
            self._running = None
        return ended

    def toggle(
        self, scene: Scene, clip: Path, name: str, area: tuple[int, int], still: bool
    ) -> str:
        """Begin an export of what the scene shows, or stop the one under way.

        clip:  its file; name: what the user calls it.
        area:  (width, height) in pixels of the part of the window that shows the plant.
        still: a picture, whatever the panel says.
        Returns a sentence for the user.
        """
        from player.atomic_write import free_name
        from player.export.formats import format_of
        from player.window.export_job import Export

        if self._running is not None:
            self._running.stop()
            return "Stopping …"
        example = STILL if still else scene.output.example
        output = free_name(name, example)
        film = film_of(scene, example, area, name)
        try:
            format_of(output, film)
        except PlayerError as error:
            return str(error)
        self._running = Export(clip, film, output)
        return f"Exporting {output}"

    def release(self) -> None:
        if self._running is not None:
            self._running.release()


def film_of(scene: Scene, example: str, area: tuple[int, int], name: str) -> Film:
    """The film that shows what the scene does: from the same place, in the same colours.

    A picture narrower than the window is taken from farther away, so that nothing is cut off.
    """
    from player.export.film import Film
    from player.export.formats import FORMATS
    from player.view.camera_animation import CameraPath

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
        transparent=scene.output.transparent and chosen.suffix == ".png",
        name=name,
        path=path,
    )
