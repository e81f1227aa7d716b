"""What keys, buttons and the panel do to a scene: functions from scenes to scenes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from player.view.choices import SIZES, Compare, Wish
from player.view.style import NO_HOLDOUT, ColorMode

if TYPE_CHECKING:
    from player.view.camera import Camera
    from player.view.state import Scene

Move = Callable[["Scene"], "Scene"]

NUDGE = 0.01  # share of the series that an arrow key goes on
STEP, SMALLEST, LARGEST = 1.15, 0.05, 20.0  # of point sizes; the command line allows the same
PIXELS, FEWEST, MOST = 3.0, 1.0, 40.0  # diameter of points sized in pixels
SHADINGS = (0.0, 1.0, 2.0)
FREE = 0.7  # share of a window's height that a plant has for itself
NO_ORGAN = "Click an organ first."
QUIT_NEXT = "Press Esc again to quit."


def switched(name: str) -> Move:
    """Turn one of the scene's own switches."""
    return lambda scene: scene.switched(name)


def styled(name: str) -> Move:
    """Turn one of the style's switches."""
    return lambda scene: scene.styled("", **{name: not getattr(scene.style, name)})


def nudged(step: int) -> Move:
    return lambda scene: scene.clock(lambda t: t.nudged(step * NUDGE))


def to_first(scene: Scene) -> Scene:
    return scene.clock(lambda t: t.at(t.first))


def to_last(scene: Scene) -> Scene:
    return scene.clock(lambda t: t.at(t.last))


def looped(scene: Scene) -> Scene:
    scene = scene.clock(lambda t: t.with_next_end())
    return scene.told(f"At the end: {scene.timeline.at_end.value}")


def begun(scene: Scene) -> Scene:
    return scene.clock(lambda t: t.begun_here()).told("Plays from here")


def ended(scene: Scene) -> Scene:
    return scene.clock(lambda t: t.ended_here()).told("Plays up to here")


def unbounded(scene: Scene) -> Scene:
    return scene.clock(lambda t: t.unbounded()).told("Plays the whole series")


def fitted(scene: Scene) -> Scene:
    home = scene.home.with_orthographic(scene.camera.orthographic)
    return replace(scene, camera=home, turning=False, following=False)


def looked(yaw: float, pitch: float = 0.0) -> Move:
    """Look from a side, in degrees: yaw from where the plant looks widest, pitch from level."""

    def look(scene: Scene) -> Scene:
        home = scene.home.with_orthographic(scene.camera.orthographic)
        turned = scene.home.yaw + math.radians(yaw)
        scene = scene.seen(lambda c: c.looking(turned, math.radians(pitch)))
        near, far = home.distance, _roomy(home)
        if any(math.isclose(scene.camera.distance, whole) for whole in (near, far)):
            distance = far if pitch else near
            scene = scene.seen(lambda c: replace(c, distance=distance))
        return replace(scene, turning=False)

    return look


def _roomy(home: Camera) -> float:
    """From how far away a plant seen whole from its side is whole from above too: the home view is
    fitted to one side, and a crown may reach farther.
    """
    return max(home.distance, home.radius / (FREE * math.tan(home.field_of_view / 2)))


def flattened(scene: Scene) -> Scene:
    scene = scene.seen(lambda c: c.with_orthographic(not c.orthographic))
    return scene.told("Parallel projection" if scene.camera.orthographic else "Perspective")


def turned(scene: Scene) -> Scene:
    return replace(scene, turning=not scene.turning, following=False)


def keyed(scene: Scene) -> Scene:
    path = scene.path.with_key(scene.timeline.day, scene.camera)
    return replace(scene, path=path).told(f"Camera key {len(path.keys)} added")


def unkeyed(scene: Scene) -> Scene:
    if not scene.path:
        return scene.told("There is no camera key.")
    path = scene.path.without_key(scene.timeline.day)
    following = scene.following and bool(path)
    return replace(scene, path=path, following=following).told("Camera key removed")


def followed(scene: Scene) -> Scene:
    if not scene.path:
        return scene.told("Add camera keys first: K, on two days or more.")
    return replace(scene, following=not scene.following, turning=False)


def recolored(scene: Scene) -> Scene:
    modes = scene.color_modes
    return colored(modes[(modes.index(scene.color_mode) + 1) % len(modes)])(scene)


def colored(mode: ColorMode) -> Move:
    """Colour by a mode."""

    def color(scene: Scene) -> Scene:
        if mode is ColorMode.ERROR and not scene.has_errors:
            return scene.told(f"{NO_HOLDOUT[0].upper()}{NO_HOLDOUT[1:]}")
        return scene.styled(f"Coloured by {mode.label}", color_by=mode)

    return color


def larger(scene: Scene) -> Scene:
    return _resized(scene, STEP)


def smaller(scene: Scene) -> Scene:
    return _resized(scene, 1 / STEP)


def _resized(scene: Scene, factor: float) -> Scene:
    style = scene.style
    if style.pixels is not None:
        pixels = min(max(style.pixels * factor, FEWEST), MOST)
        return scene.styled(f"Points of {pixels:.1f} pixels", pixels=pixels)
    size = min(max(style.point_size * factor, SMALLEST), LARGEST)
    size = 1.0 if abs(size - 1.0) < 0.01 else size
    return scene.styled(f"Point size {size:.0%}", point_size=size)


def pixeled(scene: Scene) -> Scene:
    if scene.style.pixels is None:
        return scene.styled("Points sized in pixels", pixels=PIXELS)
    return scene.styled("Points sized in the world", pixels=None)


def grounded(scene: Scene) -> Scene:
    return scene.styled(ground="dark" if scene.style.ground == "light" else "light")


def shaded(scene: Scene) -> Scene:
    stronger = [shading for shading in SHADINGS if shading > scene.style.eye_dome]
    return scene.styled(eye_dome=stronger[0] if stronger else SHADINGS[0])


def picked_next(step: int) -> Move:
    """Pick the organ that comes after, or before, the picked one."""

    def pick(scene: Scene) -> Scene:
        if not scene.organs:
            return scene
        now = scene.style.picked
        start = (-1 if step > 0 else scene.organs) if now is None else now
        return scene.styled(picked=(start + step) % scene.organs)

    return pick


def hidden(scene: Scene) -> Scene:
    picked = scene.style.picked
    if picked is None:
        return scene.told(NO_ORGAN)
    return scene.styled(hidden=scene.style.hidden | {picked}, picked=None, alone=None)


def hidden_or_shown(track: int) -> Move:
    """Turn an organ's visibility."""
    return lambda scene: scene.styled(hidden=scene.style.hidden ^ {track})


def isolated(scene: Scene) -> Scene:
    picked = scene.style.picked
    if picked is None and scene.style.alone is None:
        return scene.told(NO_ORGAN)
    return scene.styled(alone=picked if scene.style.alone is None else None)


def all_shown(scene: Scene) -> Scene:
    return scene.styled(hidden=frozenset(), alone=None)


def compared(scene: Scene) -> Scene:
    choices = list(Compare)
    return compared_by(choices[(choices.index(scene.compare) + 1) % len(choices)])(scene)


def compared_by(how: Compare) -> Move:
    return lambda scene: replace(scene, compare=how).told(f"Compare: {how.value}")


def wiped(step: float) -> Move:
    """Move the wipe's line by a share of the width."""
    return lambda scene: replace(scene, wipe=min(max(scene.wipe + step, 0.02), 0.98))


def pictured(scene: Scene) -> Scene:
    return replace(scene, wish=Wish.PICTURE)


def exported(scene: Scene) -> Scene:
    return replace(scene, wish=Wish.EXPORT)


def reformatted(scene: Scene) -> Scene:
    chosen = scene.formats[(scene.formats.index(scene.output.example) + 1) % len(scene.formats)]
    output = replace(scene.output, example=chosen)
    return replace(scene, output=output).told(f"Export: {chosen}")


def picture_resized(scene: Scene) -> Scene:
    known = SIZES.index(scene.output.size) if scene.output.size in SIZES else 0
    size = SIZES[(known + 1) % len(SIZES)]
    text = f"{size[0]} × {size[1]} pixels" if size else "as large as the window"
    return replace(scene, output=replace(scene.output, size=size)).told(f"Pictures: {text}")


def cut_out(scene: Scene) -> Scene:
    output = replace(scene.output, transparent=not scene.output.transparent)
    text = "transparent" if output.transparent else "opaque"
    return replace(scene, output=output).told(f"Pictures: {text}")


def left(scene: Scene) -> Scene:
    """Esc leaves the help first, then what is picked, then the full screen, then the window: but
    there it asks, for who pressed it once too often would lose a view and a camera path.
    """
    if scene.help:
        return replace(scene, help=False)
    if scene.style.picked is not None or scene.style.alone is not None:
        return scene.styled(picked=None, alone=None)
    if scene.fullscreen and not scene.kiosk:
        return replace(scene, fullscreen=False)
    if scene.kiosk or scene.notice == QUIT_NEXT:
        return replace(scene, closed=True)
    return scene.told(QUIT_NEXT)
