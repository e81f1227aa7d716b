"""The window: shows a clip, and lets keys and mouse change what is seen.

The scene is a frozen value (scene.py). Events turn it into a new one (controls.py), time passes
over it, and a picture is drawn only where it would differ from the last one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from player.camera import Camera
from player.controls import Controls
from player.dates import date_at
from player.detail import Detail, Enlarger, Pace
from player.layout import ABOVE_PLANT, BELOW_PLANT
from player.scene import Scene
from player.screen import events_to, opened, shortest_frame, switch_fullscreen
from player.screenshot import save_screenshot
from player.style import Style
from player.timeline import Timeline

if TYPE_CHECKING:
    from gclip import Clip

NOTICE_SECONDS = 2.5
TURN_SPEED = 0.35  # radians a second of the camera going round by itself
LONGEST_STEP = 1.0  # seconds: after a halt (a laptop's closed lid) the plant must not leap
LOADING = 0.01  # seconds of every picture for bringing movers to the GPU
IDLE = 0.25  # seconds between looks at the terminal's Ctrl-C while nothing moves


def show(
    clip: Clip,
    style: Style | None = None,
    *,
    name: str = "plant",
    size: tuple[int, int] = (1280, 720),
    turning: bool = False,
    watch: Callable[[Scene], None] | None = None,
) -> None:
    """Play a clip in a window until the user closes it.

    style: how it looks at first.
    name:  what to call the clip in the titles.
    size:  (width, height) of the window in units of 1/96 inch.
    turning: the camera goes round the plant from the start.
    watch: called with the scene after each picture.
    Raises PlayerError where there is no display, or no OpenGL 3.3.
    """
    with opened(size, name) as handle:
        window = Window(handle, clip, style or Style(), name, turning)
        try:
            window.run(watch or (lambda scene: None))
        finally:
            window.release()


@dataclass(frozen=True)
class Measures:
    """The sizes of a window, which differ on displays of high density.

    window:      (width, height) in the system's own coordinates, those of the cursor.
    framebuffer: (width, height) in pixels; zero while the window is minimised.
    scale:       pixels in a unit of 1/96 inch (the system's content scale).
    """

    window: tuple[int, int]
    framebuffer: tuple[int, int]
    scale: float

    @property
    def visible(self) -> bool:
        return min(*self.window, *self.framebuffer) > 0

    @property
    def units(self) -> tuple[float, float]:
        """(width, height) in units."""
        return self.framebuffer[0] / self.scale, self.framebuffer[1] / self.scale

    def to_units(self, x: float, y: float) -> tuple[float, float]:
        """From the cursor's coordinates to units."""
        width, height = self.units
        return x * width / self.window[0], y * height / self.window[1]


def home_camera(clip: Clip, size: tuple[float, float]) -> Camera:
    """The whole plant in the part of a window that titles and timeline leave free.

    size: (width, height) of the window in units.
    """
    width, height = size
    free = max(height - ABOVE_PLANT - BELOW_PLANT, 0.3 * height)
    camera = Camera.home(clip, width / free).zoom(free / height)
    return camera.pan(0.0, (BELOW_PLANT - ABOVE_PLANT) / 2 / height)


class Window:
    """One clip in one open window, whose OpenGL context is current."""

    def __init__(
        self, handle: Any, clip: Clip, style: Style, name: str, turning: bool = False
    ) -> None:
        import glfw

        from player.context import from_window
        from player.overlay import Overlay
        from player.renderer import Renderer

        self._glfw: Any = glfw
        self._handle = handle
        self._clip = clip
        self._name = name
        self._context: Any = from_window()
        self._renderer = Renderer(self._context, clip)
        self._enlarger = Enlarger(self._context)
        self._pace = Pace(max(len(interval) for interval in clip.intervals))
        self._overlay = Overlay(self._context, clip, name)
        self._measures = self._measured()
        home = home_camera(clip, self._measures.units if self._measures.visible else (16.0, 9.0))
        timeline = Timeline.of(clip.times).played()
        scene = Scene(timeline, home, home, style, clip.has_colors, turning=turning)
        self._controls = Controls(scene)
        self._drawn: object = None  # what the last picture showed
        self._view: object = None  # its day, camera and size
        self._whole = True  # whether the last picture showed every mover
        self._loading = True  # whether movers came to the GPU for it
        self._title = ""
        self._notice, self._notice_ends = "", 0.0
        self._watch: Callable[[Scene], None] = lambda scene: None
        events_to(handle, self._controls, self._to_units, self._draw_again)

    def run(self, watch: Callable[[Scene], None]) -> None:
        """Draw and listen until the window is closed."""
        glfw, self._watch = self._glfw, watch
        frame = shortest_frame()
        then = glfw.get_time()
        while not self._controls.scene.closed and not glfw.window_should_close(self._handle):
            now = glfw.get_time()
            self._pass_time(min(now - then, LONGEST_STEP), now)
            then = now
            self._follow_window()
            self._draw()
            if self._lively:
                # Vertical sync paces this loop; where there is none, the wait does.
                glfw.wait_events_timeout(max(then + frame - glfw.get_time(), 0.0005))
            else:
                glfw.wait_events_timeout(IDLE)
                then = glfw.get_time()

    def release(self) -> None:
        self._overlay.release()
        self._enlarger.release()
        self._renderer.release()

    @property
    def _lively(self) -> bool:
        """Whether time alone changes what is seen; if not, the GPU rests until an event comes."""
        controls, scene = self._controls, self._controls.scene
        plays = scene.timeline.playing and not controls.scrubbing
        return plays or scene.turning or bool(scene.notice) or not self._whole

    def _pass_time(self, seconds: float, now: float) -> None:
        controls, scene = self._controls, self._controls.scene
        if not controls.scrubbing:
            scene = scene.clock(lambda t: t.tick(seconds))
        if scene.turning and not controls.dragging:
            scene = scene.seen(lambda c: c.orbit(TURN_SPEED * seconds, 0.0))
        if scene.notice != self._notice:
            self._notice, self._notice_ends = scene.notice, now + NOTICE_SECONDS
        elif scene.notice and now > self._notice_ends:
            scene = replace(scene, notice="")
        controls.scene = scene

    def _follow_window(self) -> None:
        """Take over the window's present size, and give it the state that the scene asks for."""
        controls, before = self._controls, self._measures
        switch_fullscreen(self._handle, controls.scene.fullscreen)
        self._measures = self._measured()
        if self._measures != before and self._measures.visible:
            scene = controls.scene
            home = home_camera(self._clip, self._measures.units)
            untouched = scene.camera == scene.home
            camera = home if untouched else scene.camera
            controls.scene = replace(scene, camera=camera, home=home)
        title = f"{date_at(self._clip.scans, controls.scene.timeline.day)} · {self._name}"
        if title != self._title:
            self._glfw.set_window_title(self._handle, title)
            self._title = title

    def _draw(self) -> None:
        controls, measures = self._controls, self._measures
        cursor = None if controls.dragging else controls.cursor
        held = controls.held if isinstance(controls.held, str) else None
        scene, screen = controls.scene, self._context.screen
        view = (scene.timeline.day, scene.camera, measures)
        moves = view != self._view and not scene.wants_picture
        detail = self._pace.detail(measures.framebuffer) if moves else Detail()
        wanted = (scene, measures, cursor, held, detail)
        if not measures.visible or (wanted == self._drawn and self._whole):
            return
        at_rest = not moves and not self._loading
        began = self._glfw.get_time()
        screen.viewport = (0, 0, *measures.framebuffer)
        self._enlarger.draw(
            screen,
            measures.framebuffer,
            detail.pixels,
            lambda framebuffer, size: self._draw_plant(framebuffer, size, detail.every, at_rest),
        )
        if scene.wants_picture:
            controls.scene = scene = self._with_screenshot(scene)
        controls.layout = self._overlay.draw(
            screen, scene, measures.units, measures.scale, cursor, held
        )
        self._glfw.swap_buffers(self._handle)
        if moves:
            self._pace.took(self._glfw.get_time() - began)
        self._drawn, self._view = wanted, view
        self._watch(scene)

    def _draw_plant(
        self, framebuffer: Any, size: tuple[int, int], every: int, at_rest: bool
    ) -> None:
        """At rest every mover is drawn, whatever it takes; before that, what the GPU has so far."""
        scene = self._controls.scene
        patience = None if at_rest or scene.wants_picture else LOADING
        before = self._renderer.loaded
        self._whole = self._renderer.draw(
            *(framebuffer, scene.timeline.day, scene.camera, scene.style, size),
            every=every,
            patience=patience,
        )
        self._loading = self._renderer.loaded != before

    def _draw_again(self) -> None:
        """The system lost the picture, or is changing the window's size right now."""
        self._drawn = None
        self._follow_window()
        self._draw()

    def _with_screenshot(self, scene: Scene) -> Scene:
        size = self._measures.framebuffer
        pixels = self._context.screen.read(viewport=(0, 0, *size), components=3, alignment=1)
        date = date_at(self._clip.scans, scene.timeline.day)
        notice = save_screenshot(pixels, size, f"{self._name} {date}")
        return replace(scene, wants_picture=False, notice=notice)

    def _measured(self) -> Measures:
        glfw, handle = self._glfw, self._handle
        scale = max(glfw.get_window_content_scale(handle)[0], 0.5)
        return Measures(
            tuple(glfw.get_window_size(handle)), tuple(glfw.get_framebuffer_size(handle)), scale
        )

    def _to_units(self, x: float, y: float) -> tuple[float, float]:
        return self._measures.to_units(x, y) if self._measures.visible else (x, y)
