"""Opens the window as the command line and the last time left it, and remembers how it ends."""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

if sys.platform == "darwin":  # two copies of GLFW clash there: `glfw` takes imgui-bundle's
    import imgui_bundle  # noqa: F401
import glfw  # noqa: F401  elsewhere before imgui-bundle, whose copy of GLFW knows no Wayland

from gclip import Clip
from player.errors import PlayerError
from player.gl.gl_errors import ContextLost
from player.gl.timers import profile_table
from player.view.camera_animation import CameraPath, load_path
from player.view.state import Scene
from player.view.style import ColorMode, GroundChoice, Style
from player.window.app import Window
from player.window.glfw_window import opened
from player.window.opened_clip import OpenClip
from player.window.settings import Settings, load_settings, save_settings

RESETS = 3  # of the graphics driver that are put up with


def start(
    files: Sequence[Path], style: Style, size: tuple[int, int] | None,
    ground: GroundChoice | None, turning: bool, path: Path | None, profile: bool,
) -> None:  # fmt: skip
    """Play one clip, or two in step, as the command line and the last time left the window.

    size, ground: None for those of the last time; path: file of a camera path to follow.
    Raises ClipError, and PlayerError as `show` does.
    """
    clips = [OpenClip.of(file) for file in files]
    if lacking := ColorMode(style.color_by).lacking(clips[0].clip):
        raise PlayerError(lacking)
    last = load_settings()
    camera_path = load_path(path, clips[0].clip) if path else CameraPath()
    kept = {name: getattr(last, name) for name in ("panel", "guides", "legend")}
    changes = {"turning": turning, "path": camera_path, "following": bool(camera_path), **kept}
    style = replace(style, ground=ground or last.ground)
    scene, shown = show(clips, style, size=size or last.size, changes=changes, profile=profile)
    size = last.size if size or scene.fullscreen else shown
    light = GroundChoice(scene.style.ground)
    save_settings(Settings(size, scene.panel, light, scene.guides, scene.legend))


def show(
    clips: Clip | Sequence[OpenClip],
    style: Style | None = None,
    *,
    name: str = "plant",
    size: tuple[int, int] = Settings().size,
    changes: Mapping[str, Any] | None = None,
    watch: Callable[[Scene], None] = lambda scene: None,
    profile: bool = False,
) -> tuple[Scene, tuple[int, int]]:
    """Play a clip, or two in step, in a window until the user closes it.

    Where the graphics driver is reset, a new window goes on where the lost one was.

    Parameters
    ----------
    clips : Clip or sequence of OpenClip
    style : Style, optional
        How it looks at first.
    name : str
        What to call a bare clip in the titles.
    size : tuple of int
        (width, height) of the window in units of 1/96 inch.
    changes : mapping
        Fields of the first scene that are not as usual.
    watch : callable
        Is called with the scene after each picture.
    profile : bool
        Whether to print at the end what each pass of a frame took on the GPU.

    Returns
    -------
    Scene, tuple of int
        The last scene, and the window's size.

    Raises
    ------
    PlayerError
        Where there is no display, no OpenGL 3.3, or too little of the GPU's memory.
    """
    shown = tuple(clips) if isinstance(clips, Sequence) else (OpenClip(clips, name),)
    lost: list[Scene] = []
    while True:
        with opened(size, shown[0].name) as handle:
            window = Window(handle, shown, {"style": style or Style(), **(changes or {})})
            window.watch = watch
            window.scene = lost[-1] if lost else window.scene
            try:
                ended = window.run()
                if profile:
                    print(profile_table(window.viewports.timers), file=sys.stderr)
                return ended
            except ContextLost:
                shown, lost = window.clips, [*lost, window.scene]
                if len(lost) > RESETS:
                    raise
            finally:
                window.release()
