"""User actions: functions that take a scene and return a new one."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from corrections import Correction, Place
from corrections.history import describe

if TYPE_CHECKING:
    from player.view.state import Scene

MIN_POINT_SIZE, MAX_POINT_SIZE = 0.05, 20.0  # the limits of the option --point-size, too
FREE_HEIGHT = 0.7  # share of the window's height that title and timeline leave to the plant
NO_ORGAN = "Click an organ first."
NO_PAIR = "Click an organ, then another one with Shift held, on this day or another."
NO_EDITS = "Organs are corrected in a clip's own file: open it with `play`."
QUIT_NEXT = "Press Esc again to quit."


def go_home(scene: Scene) -> Scene:
    """Show the whole plant, and keep the kind of projection."""
    home = scene.home.with_orthographic(scene.camera.orthographic)
    return replace(scene, camera=home, turning=False, following=False)


def look_from(scene: Scene, yaw: float, pitch: float = 0.0) -> Scene:
    """Look from a direction, in degrees: yaw relative to the home view, pitch above level."""
    home = scene.home.with_orthographic(scene.camera.orthographic)
    camera = scene.camera.looking_from(home.yaw + math.radians(yaw), math.radians(pitch))
    # The home view is fitted to one side only; from above the plant may be larger. The distance is
    # adapted unless the user has zoomed.
    from_above = home.radius / (FREE_HEIGHT * math.tan(home.field_of_view / 2))
    near, far = home.distance, max(home.distance, from_above)
    if any(math.isclose(camera.distance, fitted) for fitted in (near, far)):
        camera = replace(camera, distance=far if pitch else near)
    return replace(scene, camera=camera, turning=False, following=False)


def follow_path(scene: Scene) -> Scene:
    if not scene.path:
        return scene.with_notice("Add camera keys first: K, on two days or more.")
    return replace(scene, following=not scene.following, turning=False)


def resize_points(scene: Scene, factor: float) -> Scene:
    size = min(max(scene.style.point_size * factor, MIN_POINT_SIZE), MAX_POINT_SIZE)
    size = 1.0 if abs(size - 1.0) < 0.01 else size
    return scene.with_style(f"Point size {size:.0%}", point_size=size)


def pick(scene: Scene, track: int | None, place: Place | None = None, add: bool = False) -> Scene:
    """Pick an organ, or none; picking the same organ again releases it.

    place: the point that was clicked; add: pick it as the second organ of a pair, or none as such.
    """
    if add and scene.clicked_places and (track is None) == (place is None):
        places = scene.clicked_places[:1] + (() if place is None else (place,))
        return replace(scene.with_style(second=track), clicked_places=places)
    picked = None if track == scene.style.picked else track
    places = () if picked is None or place is None else (place,)
    return replace(scene.with_style(picked=picked, second=None), clicked_places=places)


def pick_next(scene: Scene, step: int) -> Scene:
    """Pick the next (1) or the previous (-1) organ of the track table."""
    organs, picked = len(scene.clip.track_table), scene.style.picked
    start = (-1 if step > 0 else organs) if picked is None else picked
    return pick(scene, (start + step) % organs) if organs else scene


def hide_picked(scene: Scene) -> Scene:
    picked = scene.style.picked
    if picked is None:
        return scene.with_notice(NO_ORGAN)
    return scene.with_style(hidden=scene.style.hidden | {picked}, picked=None, isolated=None)


def isolate_picked(scene: Scene) -> Scene:
    picked = scene.style.picked
    if picked is None and scene.style.isolated is None:
        return scene.with_notice(NO_ORGAN)
    return scene.with_style(isolated=picked if scene.style.isolated is None else None)


def wipe_to(scene: Scene, share: float) -> Scene:
    """Move the dividing line of the wipe to a share of the width, at most near the border."""
    return replace(scene, wipe=min(max(share, 0.02), 0.98))


def correct(scene: Scene, kind: str, name: str = "") -> Scene:
    """Correct the picked organs: kind is "same" or "different" for two, "name" or "cut" for one."""
    needed = 2 if kind in ("same", "different") else 1
    if len(scene.clicked_places) < needed:
        return scene.with_notice(NO_PAIR if needed == 2 else NO_ORGAN)
    if scene.edits is None:
        return scene.with_notice(NO_EDITS)
    correction = Correction(kind, scene.clicked_places[:needed], name)  # type: ignore[arg-type]
    notice = f"{describe(correction)}: bake again to see it"
    edits = scene.edits.changed((*scene.edits.current, correction))
    return replace(scene, edits=edits, notice=notice)


def escape(scene: Scene) -> Scene:
    """Close the help, or release the picked organ, or leave full screen, or quit if repeated."""
    if scene.help:
        return replace(scene, help=False)
    if scene.style.picked is not None or scene.style.isolated is not None:
        return replace(scene.with_style(picked=None, isolated=None), clicked_places=())
    if scene.fullscreen:
        return replace(scene, fullscreen=False)
    if scene.notice == QUIT_NEXT:
        return replace(scene, closed=True)
    return scene.with_notice(QUIT_NEXT)
