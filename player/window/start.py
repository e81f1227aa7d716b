"""Opens the window as the command line and the last time left it, and remembers how it ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from player.ui.layout import stands_beside
from player.view.camera_animation import load_path
from player.view.holdout_error import Errors
from player.view.playback import AtEnd
from player.view.state import Scene
from player.window.app import show
from player.window.opened_clip import Shown
from player.window.settings import Settings, load_settings, save_settings

if TYPE_CHECKING:
    from player.view.style import Style

SIZE = (1280, 720)


@dataclass(frozen=True)
class Wanted:
    """What the command line asks for; None leaves it to the last time's settings.

    path:  file of a camera path to follow.
    kiosk: full screen, over and over, nothing to press.
    """

    size: tuple[int, int] | None = None
    ground: str | None = None
    turning: bool = False
    path: Path | None = None
    kiosk: bool = False


def start(files: Sequence[Path], style: Style, wanted: Wanted) -> None:
    """Play one clip, or two in step. Raises ClipError, and PlayerError, as `show` does."""
    shown = [Shown.opened(file) for file in files]
    if style.color_by == "error":
        Errors(shown[0].clip)
    last = load_settings()
    path = None if wanted.path is None else load_path(wanted.path, shown[0].clip)
    style = replace(style, ground=wanted.ground or last.ground or style.ground)
    size = wanted.size or last.size or SIZE
    beside = stands_beside(size[0])  # else it would lie over the plant: it waits to be called

    def prepare(scene: Scene) -> Scene:
        scene = replace(
            scene,
            turning=wanted.turning,
            panel=last.panel is not False and beside,
            guides=last.guides is not False,
            legend=last.legend is not False,
        )
        if path is not None:
            scene = replace(scene, path=path, following=True, turning=False)
        if wanted.kiosk:
            endless = replace(scene.timeline, at_end=AtEnd.LOOP)
            scene = replace(scene, timeline=endless, kiosk=True, fullscreen=True)
        return scene

    scene, size = show(shown, style, size=size, prepare=prepare)
    if not wanted.kiosk:
        kept = last.size if wanted.size or scene.fullscreen else size
        panel = scene.panel if beside else last.panel
        save_settings(Settings(kept, panel, scene.style.ground, scene.guides, scene.legend))
