"""What keys, buttons and the panel do to a scene: functions from scenes to scenes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from gclip.corrections import Place
from player.view.choices import SIZES, Compare, Wish
from player.view.style import NO_HOLDOUT, ColorMap, ColorMode

if TYPE_CHECKING:
    from player.view.camera import Camera
    from player.view.state import Scene

Move = Callable[["Scene"], "Scene"]
Choice = TypeVar("Choice")

STEP, SMALLEST, LARGEST = 1.15, 0.05, 20.0  # of point sizes; the command line allows the same
PIXELS, FEWEST, MOST = 3.0, 1.0, 40.0  # diameter of points sized in pixels
SHADINGS = (0.0, 1.0, 2.0)
FREE = 0.7  # share of a window's height that a plant has for itself
WIPE_ENDS = (0.02, 0.98)  # shares of the width that the wipe's line stays between
NO_KEYS = "Add camera keys first: K, on two days or more."
NO_ORGAN = "Click an organ first."
QUIT_NEXT = "Press Esc again to quit."


def switch(name: str) -> Move:
    """Turn one of the scene's own switches."""
    return lambda scene: replace(scene, **{name: not getattr(scene, name)})  # type: ignore[arg-type]


def switch_style(name: str) -> Move:
    """Turn one of the style's switches."""
    return lambda scene: scene.with_style("", **{name: not getattr(scene.style, name)})


def move_time(move: str, *given: float, notice: str = "") -> Move:
    """A move of the timeline, by its name."""

    def do(scene: Scene) -> Scene:
        scene = scene.with_timeline(lambda timeline: getattr(timeline, move)(*given))
        return scene.with_notice(notice) if notice else scene

    return do


def next_end(scene: Scene) -> Scene:
    scene = scene.with_timeline(lambda timeline: timeline.with_next_end())
    return scene.with_notice(f"At the end: {scene.timeline.at_end.value}")


def go_home(scene: Scene) -> Scene:
    home = scene.home.with_orthographic(scene.camera.orthographic)
    return replace(scene, camera=home, turning=False, following=False)


def look_from(yaw: float, pitch: float = 0.0) -> Move:
    """From a side, in degrees: yaw from where the plant looks widest, pitch from level."""

    def look(scene: Scene) -> Scene:
        home = scene.home.with_orthographic(scene.camera.orthographic)
        turned = scene.home.yaw + math.radians(yaw)
        scene = scene.with_camera(lambda c: c.looking(turned, math.radians(pitch)))
        near, far = home.distance, _roomy(home)
        if any(math.isclose(scene.camera.distance, whole) for whole in (near, far)):
            distance = far if pitch else near
            scene = scene.with_camera(lambda c: replace(c, distance=distance))
        return replace(scene, turning=False)

    return look


def _roomy(home: Camera) -> float:
    """From how far away a plant seen whole from its side is whole from above too: the home view is
    fitted to one side, and a crown may reach farther.
    """
    return max(home.distance, home.radius / (FREE * math.tan(home.field_of_view / 2)))


def switch_projection(scene: Scene) -> Scene:
    scene = scene.with_camera(lambda c: c.with_orthographic(not c.orthographic))
    return scene.with_notice("Parallel projection" if scene.camera.orthographic else "Perspective")


def add_key(scene: Scene) -> Scene:
    path = scene.path.with_key(scene.timeline.day, scene.camera)
    return replace(scene, path=path).with_notice(f"Camera key {len(path.keys)} added")


def remove_key(scene: Scene) -> Scene:
    if not scene.path:
        return scene.with_notice("There is no camera key.")
    path = scene.path.without_key(scene.timeline.day)
    following = scene.following and bool(path)
    return replace(scene, path=path, following=following).with_notice("Camera key removed")


def follow_path(scene: Scene) -> Scene:
    if not scene.path:
        return scene.with_notice(NO_KEYS)
    return replace(scene, following=not scene.following, turning=False)


def next_color(scene: Scene) -> Scene:
    return color_by(_after(scene.color_mode, scene.color_modes))(scene)


def color_by(mode: ColorMode) -> Move:
    """Colour by a mode."""

    def color(scene: Scene) -> Scene:
        if mode is ColorMode.ERROR and not scene.has_errors:
            return scene.with_notice(f"{NO_HOLDOUT[0].upper()}{NO_HOLDOUT[1:]}")
        return scene.with_style(f"Coloured by {mode.label}", color_by=mode)

    return color


def color_field(name: str) -> Move:
    """Colour by one of the clip's fields."""
    return lambda scene: scene.with_style(f"Coloured by {name}", field=name)


def color_map(map: ColorMap) -> Move:
    """Show values in the colours of a map."""
    return lambda scene: scene.with_style(f"Colour map: {map}", color_map=map)


def next_color_map(scene: Scene) -> Scene:
    return color_map(_after(ColorMap(scene.style.color_map), list(ColorMap)))(scene)


def next_curve(scene: Scene) -> Scene:
    curve = _after(scene.curve, (*scene.curves, ""))
    told = f"Plots the {curve} of the picked organ" if curve else "Plots nothing"
    return replace(scene, curve=curve, notice=told)


def resize_points(factor: float) -> Move:
    def resize(scene: Scene) -> Scene:
        style = scene.style
        if style.pixels is not None:
            pixels = min(max(style.pixels * factor, FEWEST), MOST)
            return scene.with_style(f"Points of {pixels:.1f} pixels", pixels=pixels)
        size = min(max(style.point_size * factor, SMALLEST), LARGEST)
        size = 1.0 if abs(size - 1.0) < 0.01 else size
        return scene.with_style(f"Point size {size:.0%}", point_size=size)

    return resize


def switch_pixels(scene: Scene) -> Scene:
    if scene.style.pixels is None:
        return scene.with_style("Points sized in pixels", pixels=PIXELS)
    return scene.with_style("Points sized in the world", pixels=None)


def next_shading(scene: Scene) -> Scene:
    stronger = [shading for shading in SHADINGS if shading > scene.style.eye_dome]
    return scene.with_style(eye_dome=stronger[0] if stronger else SHADINGS[0])


def pick(track: int | None, place: Place | None = None, more: bool = False) -> Move:
    """A click on an organ, or beside the plant; a second one lets it go.

    place: where it was clicked; more: it is chosen besides the picked one.
    """

    def pick_it(scene: Scene) -> Scene:
        places = () if place is None else (place,)
        if more and scene.chosen and places:
            chosen = (scene.chosen[0], *places)
            return replace(scene.with_style(second=track), chosen=chosen)
        picked = None if track == scene.style.picked else track
        scene = scene.with_style(picked=picked, second=None)
        return replace(scene, chosen=() if picked is None else places)

    return pick_it


def pick_next(step: int) -> Move:
    """Pick the organ that comes after, or before, the picked one."""

    def pick_it(scene: Scene) -> Scene:
        if not scene.organs:
            return scene
        now = scene.style.picked
        start = (-1 if step > 0 else scene.organs) if now is None else now
        return pick((start + step) % scene.organs)(scene)

    return pick_it


def hide_picked(scene: Scene) -> Scene:
    picked = scene.style.picked
    if picked is None:
        return scene.with_notice(NO_ORGAN)
    return scene.with_style(hidden=scene.style.hidden | {picked}, picked=None, alone=None)


def switch_organ(track: int) -> Move:
    """Turn an organ's visibility."""
    return lambda scene: scene.with_style(hidden=scene.style.hidden ^ {track}, alone=None)


def isolate_picked(scene: Scene) -> Scene:
    picked = scene.style.picked
    if picked is None and scene.style.alone is None:
        return scene.with_notice(NO_ORGAN)
    return scene.with_style(alone=picked if scene.style.alone is None else None)


def next_compare(scene: Scene) -> Scene:
    return compare_by(_after(scene.compare, list(Compare)))(scene)


def compare_by(how: Compare) -> Move:
    return lambda scene: replace(scene, compare=how).with_notice(f"Compare: {how.value}")


def wipe_to(share: float) -> Move:
    """The wipe's line, to a share of the width."""
    low, high = WIPE_ENDS
    return lambda scene: replace(scene, wipe=min(max(share, low), high))


def wish(what: Wish) -> Move:
    """Something that the window does when it draws the next picture."""
    return lambda scene: replace(scene, wish=what)


def output(notice: str = "", **changes: object) -> Move:
    """Change what the next picture or export is to be."""

    def change(scene: Scene) -> Scene:
        changed = replace(scene.output, **changes)  # type: ignore[arg-type]
        return replace(scene, output=changed, notice=notice or scene.notice)

    return change


def next_format(scene: Scene) -> Scene:
    chosen = _after(scene.output.example, scene.formats)
    return output(f"Export: {chosen}", example=chosen)(scene)


def next_size(scene: Scene) -> Scene:
    size = _after(scene.output.size, SIZES)
    text = f"{size[0]} × {size[1]} pixels" if size else "as large as the window"
    return output(f"Pictures: {text}", size=size)(scene)


def switch_transparent(scene: Scene) -> Scene:
    text = "opaque" if scene.output.transparent else "transparent"
    return output(f"Pictures: {text}", transparent=not scene.output.transparent)(scene)


def _after(now: Choice, choices: Sequence[Choice]) -> Choice:
    """The next choice, after the last one the first."""
    return choices[(choices.index(now) + 1) % len(choices)]


def escape(scene: Scene) -> Scene:
    """Esc leaves the help first, then what is picked, then the full screen, then the window: but
    there it asks, for who pressed it once too often would lose a view and a camera path.
    """
    if scene.help:
        return replace(scene, help=False)
    if scene.style.picked is not None or scene.style.alone is not None:
        return replace(scene.with_style(picked=None, alone=None), chosen=())
    if scene.fullscreen and not scene.kiosk:
        return replace(scene, fullscreen=False)
    if scene.kiosk or scene.notice == QUIT_NEXT:
        return replace(scene, closed=True)
    return scene.with_notice(QUIT_NEXT)
