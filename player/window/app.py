"""The window: shows clips, and lets keys and mouse change what is seen.

The scene is a frozen value (scene.py). Events turn it into a new one (controls.py), time passes
over it, and a picture is drawn only where it would differ from the last one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gclip.errors import ClipError
from player.errors import PlayerError
from player.gl.gl_errors import ContextLost, check_context
from player.ui import keys
from player.ui.layout import panel_width
from player.view.camera_animation import load_path
from player.view.choices import Compare
from player.view.dates import date_at
from player.view.playback import Timeline
from player.view.split_view import Pair, Pane, panes_of
from player.view.state import Scene
from player.view.style import Style
from player.window.dynamic_resolution import Detail, Pace
from player.window.exports import Exports
from player.window.glfw_window import (
    events_to,
    hide_cursor,
    opened,
    shortest_frame,
    switch_fullscreen,
)
from player.window.input import Controls
from player.window.opened_clip import FileWatch, Shown
from player.window.suited import reopened, suited
from player.window.window_size import Measures, home_camera
from player.window.wishes import granted

if TYPE_CHECKING:
    from gclip import Clip

NOTICE_SECONDS = 2.5  # that a notice stays at least
READING = 0.06  # seconds for each of its characters
TURN_SPEED = 0.35  # radians a second of the camera going round by itself
LONGEST_STEP = 1.0  # seconds: after a halt (a laptop's closed lid) the plant must not leap
LOADING = 0.01  # seconds of every picture for bringing movers to the GPU
IDLE = 0.25  # seconds between looks at the terminal's Ctrl-C, files and exports at rest
RESETS = 3  # of the graphics driver that are put up with
FRESH = 0.7  # seconds that the panel is drawn anew after it was touched: its tips take a while


def show(
    clip: Clip | Sequence[Shown],
    style: Style | None = None,
    *,
    name: str = "plant",
    size: tuple[int, int] = (1280, 720),
    prepare: Callable[[Scene], Scene] = lambda scene: scene,
    watch: Callable[[Scene], None] = lambda scene: None,
) -> tuple[Scene, tuple[int, int]]:
    """Play a clip, or two in step, in a window until the user closes it.

    style:   how it looks at first.
    name:    what to call the clip in the titles.
    size:    (width, height) of the window in units of 1/96 inch.
    prepare: makes the first scene from the usual one.
    watch:   called with the scene after each picture.
    Gives the last scene and the window's size. Where the graphics driver is reset, a new window
    goes on where the lost one was. Raises PlayerError where there is no display, no OpenGL 3.3, or
    too little of the GPU's memory.
    """
    shown = tuple(clip) if isinstance(clip, Sequence) else (Shown(clip, name),)
    for left in reversed(range(RESETS + 1)):
        with opened(size, shown[0].name) as handle:
            window = Window(handle, shown, style or Style(), prepare)
            try:
                return window.run(watch), window.size
            except ContextLost:
                if left == 0:
                    raise
                shown, lost = window.shown, window.scene

                def prepare(fresh: Scene, lost: Scene = lost) -> Scene:
                    return lost

            finally:
                window.release()
    raise AssertionError("the last one returns or raises")


class Window:
    """Clips in one open window, whose OpenGL context is current."""

    def __init__(
        self,
        handle: Any,
        shown: tuple[Shown, ...],
        style: Style,
        prepare: Callable[[Scene], Scene],
    ) -> None:
        import glfw

        from player.gl.context import from_window

        self._glfw: Any = glfw
        self._handle = handle
        self._context: Any = from_window()
        self._measures = self._measured()
        self._dropped: list[str] = []
        self._exports = Exports()
        self._shape: object = None  # what the home camera is fitted to
        self._drawn: object = None  # what the last picture showed
        self._view: object = None  # its day, camera and size
        self._touched, self._fresh_until = 0, 0.0
        self._title = ""
        self._notice, self._notice_ends = "", 0.0
        self._watch: Callable[[Scene], None] = lambda scene: None
        self._stage: Any = None
        self._overlay: Any = None
        self._show(shown)
        camera = home_camera(shown[0].clip, (16.0, 9.0))
        timeline = Timeline.of(shown[0].clip.times).played()
        scene = Scene(timeline, camera, camera, style, False)
        self._controls = Controls(prepare(suited(scene, shown)))
        self._fit()
        self._fitted()
        events_to(handle, self._controls, self._to_units, self._draw_again, self._dropped.extend)
        hide_cursor(handle, self._controls.scene.kiosk)

    def run(self, watch: Callable[[Scene], None]) -> Scene:
        """Draw and listen until the window is closed; gives the last scene."""
        glfw, self._watch = self._glfw, watch
        frame = shortest_frame()
        then = glfw.get_time()
        while not self._controls.scene.closed and not glfw.window_should_close(self._handle):
            now = glfw.get_time()
            self._pass_time(min(now - then, LONGEST_STEP), now)
            then = now
            self._look_at_files()
            self._answer_click()
            self._follow_window()
            self._draw()
            if self._lively:
                # Vertical sync paces this loop; where there is none, the wait does.
                glfw.wait_events_timeout(max(then + frame - glfw.get_time(), 0.0005))
            else:
                glfw.wait_events_timeout(IDLE)
                then = glfw.get_time()
        return self._controls.scene

    @property
    def scene(self) -> Scene:
        """The present one."""
        return self._controls.scene

    @property
    def shown(self) -> tuple[Shown, ...]:
        """The present clips."""
        return self._shown

    @property
    def size(self) -> tuple[int, int]:
        """In units of 1/96 inch."""
        width, height = self._measures.units
        return round(width), round(height)

    def release(self) -> None:
        self._exports.release()
        self._overlay.release()
        self._stage.release()

    def _show(self, shown: tuple[Shown, ...]) -> None:
        """Take these clips on the stage."""
        from player.ui.overlay import Overlay
        from player.view.colors import Colors
        from player.window.organ_info import OrganFacts
        from player.window.viewports import Stage

        if self._stage is not None:
            self._overlay.release()
            self._stage.release()
        self._shown = shown
        clips = [one.clip for one in shown]
        self._stage = Stage(self._context, clips)
        self._overlay = Overlay(self._context, clips[0], " · ".join(one.name for one in shown))
        self._pace = Pace(max(len(interval) for clip in clips for interval in clip.intervals))
        self._colors, self._organ = Colors(clips[0]), OrganFacts(clips[0])
        self._files = FileWatch([one.file for one in shown if one.file is not None])
        self._pair: Pair | None = None
        self._drawn = self._view = self._shape = None

    @property
    def _lively(self) -> bool:
        """Whether time alone changes what is seen; if not, the GPU rests until an event comes."""
        controls, scene = self._controls, self._controls.scene
        plays = scene.timeline.playing and not controls.scrubbing
        fresh = self._glfw.get_time() < self._fresh_until
        return plays or scene.turning or bool(scene.notice) or fresh or not self._stage.whole

    def _pass_time(self, seconds: float, now: float) -> None:
        controls, scene = self._controls, self._controls.scene
        if not controls.scrubbing:
            scene = scene.clock(lambda t: t.tick(seconds))
        if scene.turning and not controls.dragging:
            scene = scene.seen(lambda c: c.orbit(TURN_SPEED * seconds, 0.0))
        if scene.following and scene.path:
            scene = replace(scene, camera=scene.path.at(scene.timeline.day))
        ended = self._exports.look()
        if ended:
            scene = scene.told(ended)
        if scene.notice != self._notice:
            seconds = max(NOTICE_SECONDS, READING * len(scene.notice))
            self._notice, self._notice_ends = scene.notice, now + seconds
        elif scene.notice and now > self._notice_ends:
            scene = scene.told("")
        controls.scene = scene

    def _look_at_files(self) -> None:
        """Show what was dropped on the window, and what was baked anew."""
        dropped, self._dropped[:] = list(self._dropped), []
        try:
            paths = [name for name in dropped if name.lower().endswith(".json")]
            if paths:
                path = load_path(Path(paths[0]), self._shown[0].clip)
                scene = replace(self._controls.scene, path=path, following=True, turning=False)
                self._controls.scene = scene.told(f"Camera path of {len(path.keys)} keys")
            elif dropped:
                self._take([Shown.opened(Path(name)) for name in dropped[:2]], fresh=True)
            elif self._files.changed():
                again = [Shown.opened(one.file) if one.file else one for one in self._shown]
                self._take(again, fresh=False)
        except (ClipError, PlayerError) as error:
            told = str(error)
            for name in dropped:  # folders would leave no room for what is wrong
                told = told.replace(name, Path(name).name)
            self._controls.scene = self._controls.scene.told(told)

    def _take(self, shown: Sequence[Shown], fresh: bool) -> None:
        """Show other clips, or the same ones as they were baked anew."""
        scene = self._controls.scene
        self._show(tuple(shown))
        self._controls.scene = reopened(scene, shown, fresh)
        self._fit()
        if fresh or scene.camera == scene.home:
            self._fitted()

    def _answer_click(self) -> None:
        """Pick the organ that was clicked."""
        controls, scene = self._controls, self._controls.scene
        clicked, controls.clicked = controls.clicked, None
        if clicked is None or scene.kiosk or controls.layout is None:
            return
        from player.window.picking import organ_under

        panes, clip = self._panes(scene), self._shown[0].clip
        over, track = organ_under(clip, panes, scene.style, clicked, controls.layout.size)
        if over:
            controls.scene = keys.picked(scene, track)

    def _follow_window(self) -> None:
        """Take over the window's present size, and give it the state that the scene asks for."""
        controls = self._controls
        switch_fullscreen(self._handle, controls.scene.fullscreen)
        self._measures = self._measured()
        self._fit()
        date = date_at(self._shown[0].clip.scans, controls.scene.timeline.day)
        title = f"{date} · {self._shown[0].name}"
        if title != self._title:
            self._glfw.set_window_title(self._handle, title)
            self._title = title

    def _fit(self) -> None:
        """Fit the home camera to the part of the window that a plant has."""
        scene, (width, height) = self._controls.scene, self._measures.units
        if not self._measures.visible:
            return
        width -= self._aside
        width *= 0.5 if scene.compare is Compare.BESIDE else 1.0
        if self._shape == (width, height):
            return
        self._shape = (width, height)
        clips = [one.clip for one in self._shown]
        homes = [home_camera(clip, (width, height)) for clip in clips]
        home = homes[0]
        if len(clips) > 1:
            self._pair = Pair.of(clips[0], clips[1], (homes[0], homes[1]))
            home = self._pair.homes[0]
        untouched = scene.camera == scene.home
        camera = home if untouched else scene.camera
        self._controls.scene = replace(scene, camera=camera, home=home)

    def _fitted(self) -> None:
        """See the whole plant."""
        self._controls.scene = replace(self._controls.scene, camera=self._controls.scene.home)

    @property
    def _aside(self) -> float:
        """What the panel takes from the window's width, in units."""
        scene = self._controls.scene
        return panel_width(self._measures.units[0], scene.panel and not scene.kiosk)

    def _draw(self) -> None:
        controls, measures, now = self._controls, self._measures, self._glfw.get_time()
        if controls.touched != self._touched:
            self._touched, self._fresh_until = controls.touched, now + FRESH
        fresh = now < self._fresh_until
        cursor = None if controls.dragging else controls.cursor
        held = controls.held if isinstance(controls.held, str) else None
        scene, area = controls.scene, measures.beside(self._aside)
        view = (scene.timeline.day, scene.camera, measures)
        moves = view != self._view and scene.wish is None
        detail = self._pace.detail(area) if moves else Detail()
        facts = self._facts(scene)
        wanted = (scene, measures, cursor, held, detail, facts)
        if not measures.visible or (wanted == self._drawn and self._stage.whole and not fresh):
            return
        began = self._glfw.get_time()
        at_rest = (not moves and not self._stage.loading) or scene.wish is not None
        panes = self._panes(scene)
        patience = None if at_rest else LOADING
        try:
            self._stage.paint(area, panes, scene.style, detail, patience)
        except ClipError as error:  # cut short while it is open: the last picture stays
            controls.scene = scene = scene.told(str(error))
        self._context.screen.use()
        self._stage.show(self._context.screen, area)
        if scene.wish is not None:
            pixels = self._stage.pixels(area)
            controls.scene = scene = granted(scene, self._shown[0], self._exports, area, pixels)
        wheel, controls.turned = controls.turned, 0.0
        controls.layout = self._overlay.draw(
            *(self._context.screen, scene, measures.units, measures.scale, cursor, held),
            replace(facts, panes=panes if len(panes) > 1 else ()),
            wheel,
        )
        check_context(self._context)
        self._glfw.swap_buffers(self._handle)
        if self._overlay.chosen is not scene and self._overlay.chosen is not None:
            controls.scene = self._overlay.chosen
        controls.popup = self._overlay.popup
        controls.drawn()
        if moves:
            self._pace.took(self._glfw.get_time() - began)
        self._drawn, self._view = wanted, view
        self._watch(scene)

    def _panes(self, scene: Scene) -> tuple[Pane, ...]:
        clips, names = [one.clip for one in self._shown], [one.name for one in self._shown]
        return panes_of(scene, clips, names, self._pair)

    def _facts(self, scene: Scene) -> Any:
        from player.ui.overlay import Facts

        picked = scene.style.picked
        known = () if picked is None else tuple(self._organ.lines(picked, scene.timeline.day))
        return Facts(self._colors.color_scale(scene.style), known, (), self._exports.progress)

    def _draw_again(self) -> None:
        """The system lost the picture, or is changing the window's size right now."""
        self._drawn = None
        self._follow_window()
        self._draw()

    def _measured(self) -> Measures:
        glfw, handle = self._glfw, self._handle
        scale = max(glfw.get_window_content_scale(handle)[0], 0.5)
        return Measures(
            tuple(glfw.get_window_size(handle)), tuple(glfw.get_framebuffer_size(handle)), scale
        )

    def _to_units(self, x: float, y: float) -> tuple[float, float]:
        return self._measures.to_units(x, y) if self._measures.visible else (x, y)
