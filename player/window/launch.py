"""Opens the window with the settings of the last session, and saves them at the end."""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

if sys.platform == "darwin":  # `glfw` must use imgui-bundle's copy: two copies conflict there
    import imgui_bundle  # noqa: F401
import glfw  # noqa: F401  elsewhere first, since imgui-bundle's copy does not support Wayland

from gclip import Clip
from player.errors import PlayerError
from player.gl.gl_errors import ContextLost
from player.gl.timers import profile_table
from player.view.camera_animation import CameraPath, load_path
from player.view.playback import Timeline
from player.view.state import Scene
from player.view.style import ColorMode, GroundChoice, Style
from player.window.app import Window
from player.window.glfw_window import open_window
from player.window.opened_clip import OpenClip
from player.window.settings import Settings, load_settings, save_settings

MAX_RESETS = 3  # of the graphics driver, after which the player gives up


def start(
    files: Sequence[Path], style: Style, size: tuple[int, int] | None,
    ground: GroundChoice | None, turning: bool, path: Path | None, profile: bool,
    day: float | None = None,
) -> None:  # fmt: skip
    """Play one clip, or two side by side, for the command line.

    size, ground: None for those of the last session; path: file of a camera path to follow; day:
    at which playback starts, by default that of the first scan.
    Raises ClipError for a damaged clip, and PlayerError as `show` does.
    """
    clips = [OpenClip.from_file(file) for file in files]
    if reason := ColorMode(style.color_by).quantity.why_unavailable(clips[0].clip):
        raise PlayerError(reason)
    saved = load_settings()
    camera_path = load_path(path, clips[0].clip) if path else CameraPath()
    visible = {name: getattr(saved, name) for name in ("panel", "guides", "legend")}
    changes = {"turning": turning, "path": camera_path, "following": bool(camera_path), **visible}
    if day is not None:
        changes["timeline"] = replace(Timeline.of(clips[0].clip.times).at(day), playing=True)
    style = replace(style, ground=ground or saved.ground)
    scene, final_size = show(
        clips, style, size=size or saved.size, changes=changes, profile=profile
    )
    size = saved.size if size or scene.fullscreen else final_size
    chosen_ground = GroundChoice(scene.style.ground)
    save_settings(Settings(size, scene.panel, chosen_ground, scene.guides, scene.legend))


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
    """Play a clip, or two side by side, in a window until the user closes it.

    After a reset of the graphics driver a new window continues with the same scene.

    Parameters
    ----------
    clips : Clip or sequence of OpenClip
    style : Style, optional
        Initial style.
    name : str
        Title of a clip that is given without a name.
    size : tuple of int
        (width, height) of the window in units of 1/96 inch.
    changes : mapping
        Fields of the first scene by name.
    watch : callable
        Called with the scene after each frame.
    profile : bool
        Whether to print the GPU time of each render pass at the end.

    Returns
    -------
    Scene, tuple of int
        The last scene, and the final size of the window.

    Raises
    ------
    PlayerError
        If there is no display, no OpenGL 3.3, or too little GPU memory.
    """
    entries = tuple(clips) if isinstance(clips, Sequence) else (OpenClip(clips, name),)
    lost_scenes: list[Scene] = []
    while True:
        with open_window(size, entries[0].name) as handle:
            window = Window(handle, entries, {"style": style or Style(), **(changes or {})})
            window.watch = watch
            window.scene = lost_scenes[-1] if lost_scenes else window.scene
            try:
                result = window.run()
                if profile:
                    print(profile_table(window.timers), file=sys.stderr)
                return result
            except ContextLost:
                entries, lost_scenes = window.clips, [*lost_scenes, window.scene]
                if len(lost_scenes) > MAX_RESETS:
                    raise
            finally:
                window.release()
