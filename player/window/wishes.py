"""What the user wishes for once: pictures, exports, camera paths in files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from player.errors import PlayerError
from player.export.image import save_screenshot
from player.view.camera_animation import save_path
from player.view.choices import Wish
from player.view.dates import date_at
from player.view.state import Scene
from player.window.exports import Exports
from player.window.opened_clip import Shown


def granted(
    scene: Scene, shown: Shown, exports: Exports, area: tuple[int, int], pixels: bytes
) -> Scene:
    """Do what a scene wishes for; the scene without the wish, and with what came of it.

    area, pixels: (width, height) of the picture on screen, and its RGB, bottom row first.
    """
    wish, scene = scene.wish, replace(scene, wish=None)
    if wish is Wish.SAVE_PATH:
        return scene.told(_saved_path(scene, shown))
    plain = scene.output.size is None and not scene.output.transparent
    still = wish is Wish.PICTURE
    name = f"{shown.name} {date_at(shown.clip.scans, scene.timeline.day)}" if still else shown.name
    if still and (plain or shown.file is None):
        return scene.told(save_screenshot(pixels, area, name))
    if shown.file is None:
        return scene.told("Only clips that were opened from a file can be exported.")
    return scene.told(exports.toggle(scene, shown.file, name, area, still))


def _saved_path(scene: Scene, shown: Shown) -> str:
    if not scene.path:
        return "Add camera keys first: K, on two days or more."
    file = Path(f"{shown.name}.camera.json")
    try:
        save_path(scene.path, shown.clip, file)
    except PlayerError as error:
        return str(error)
    return f"Saved {file}"
