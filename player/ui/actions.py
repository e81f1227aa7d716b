"""What keys, buttons and the panel do to a scene: functions from scenes to scenes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from corrections import Correction, Place
from player.view.choices import sentence

if TYPE_CHECKING:
    from player.view.state import Scene

SMALLEST, LARGEST = 0.05, 20.0  # point sizes; the command line allows the same
FREE = 0.7  # share of a window's height that a plant has for itself
NO_ORGAN = "Click an organ first."
NO_PAIR = "Click an organ, then another one with Shift held, on this day or another."
NO_EDITS = "Organs are corrected in a clip's own file: open it with `play`."
QUIT_NEXT = "Press Esc again to quit."


def go_home(scene: Scene) -> Scene:
    home = scene.home.with_orthographic(scene.camera.orthographic)
    return replace(scene, camera=home, turning=False, following=False)


def look_from(scene: Scene, yaw: float, pitch: float = 0.0) -> Scene:
    """From a side, in degrees: yaw from where the plant looks widest, pitch from level."""
    home = scene.home.with_orthographic(scene.camera.orthographic)
    camera = scene.camera.looking(home.yaw + math.radians(yaw), math.radians(pitch))
    # The home view is fitted to one side: a crown seen from above may reach farther.
    above = home.radius / (FREE * math.tan(home.field_of_view / 2))
    near, far = home.distance, max(home.distance, above)
    if any(math.isclose(camera.distance, whole) for whole in (near, far)):
        camera = replace(camera, distance=far if pitch else near)
    return replace(scene, camera=camera, turning=False, following=False)


def follow_path(scene: Scene) -> Scene:
    if not scene.path:
        return scene.with_notice("Add camera keys first: K, on two days or more.")
    return replace(scene, following=not scene.following, turning=False)


def resize_points(scene: Scene, factor: float) -> Scene:
    size = min(max(scene.style.point_size * factor, SMALLEST), LARGEST)
    size = 1.0 if abs(size - 1.0) < 0.01 else size
    return scene.with_style(f"Point size {size:.0%}", point_size=size)


def pick(scene: Scene, track: int | None, place: Place | None = None, more: bool = False) -> Scene:
    """A click on an organ, or beside the plant; a second one lets it go.

    place: where it was clicked; more: it is chosen besides the picked one.
    """
    if more and scene.chosen and place is not None:
        return replace(scene.with_style(second=track), chosen=(scene.chosen[0], place))
    picked = None if track == scene.style.picked else track
    chosen = () if picked is None or place is None else (place,)
    return replace(scene.with_style(picked=picked, second=None), chosen=chosen)


def pick_next(scene: Scene, step: int) -> Scene:
    """Pick the organ that comes after, or before, the picked one."""
    organs, now = len(scene.clip.track_table), scene.style.picked
    start = (-1 if step > 0 else organs) if now is None else now
    return pick(scene, (start + step) % organs) if organs else scene


def hide_picked(scene: Scene) -> Scene:
    picked = scene.style.picked
    if picked is None:
        return scene.with_notice(NO_ORGAN)
    return scene.with_style(hidden=scene.style.hidden | {picked}, picked=None, alone=None)


def isolate_picked(scene: Scene) -> Scene:
    picked = scene.style.picked
    if picked is None and scene.style.alone is None:
        return scene.with_notice(NO_ORGAN)
    return scene.with_style(alone=picked if scene.style.alone is None else None)


def wipe_to(scene: Scene, share: float) -> Scene:
    """The wipe's line, to a share of the width, but not out of sight."""
    return replace(scene, wipe=min(max(share, 0.02), 0.98))


def correct(scene: Scene, kind: str, name: str = "") -> Scene:
    """Say of the chosen organs that they are the same, or not; of one, its name, or cut it."""
    needed = 2 if kind in ("same", "different") else 1
    if len(scene.chosen) < needed:
        return scene.with_notice(NO_PAIR if needed == 2 else NO_ORGAN)
    if scene.edits is None:
        return scene.with_notice(NO_EDITS)
    correction = Correction(kind, scene.chosen[:needed], name)  # type: ignore[arg-type]
    told = f"{sentence(correction)}: bake again to see it"
    return replace(scene, edits=scene.edits.changed((*scene.edits.now, correction)), notice=told)


def escape(scene: Scene) -> Scene:
    """Leave the help, else what is picked, else the full screen; the window if pressed twice."""
    if scene.help:
        return replace(scene, help=False)
    if scene.style.picked is not None or scene.style.alone is not None:
        return replace(scene.with_style(picked=None, alone=None), chosen=())
    if scene.fullscreen:
        return replace(scene, fullscreen=False)
    if scene.notice == QUIT_NEXT:
        return replace(scene, closed=True)
    return scene.with_notice(QUIT_NEXT)
