"""The window: shows clips, and lets keys and mouse change what is seen.

The scene is a frozen value (player/view/state.py). Events turn it into a new one, time passes over
it, and a picture is drawn only where it would differ from the last one.
"""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import glfw

from gclip.errors import UserError
from player.gl.context import from_window
from player.gl.gl_errors import check_context
from player.ui import actions, keys
from player.ui.annotations import strip_height
from player.ui.gui import Gui
from player.ui.interface import Interface
from player.ui.panel import panel_width
from player.view.camera import Camera
from player.view.choices import Compare
from player.view.dates import date_at
from player.view.playback import Timeline
from player.view.split_view import panes_of
from player.view.state import Scene, reopened
from player.window.dynamic_resolution import Detail, DynamicResolution
from player.window.export_job import Exports
from player.window.glfw_window import Measures, listen, switch_fullscreen
from player.window.opened_clip import FileWatch, KeptEdits, OpenClip
from player.window.viewports import Viewports, fitted, home_camera

NOTICE_SECONDS, READING = 1.5, 0.06  # that a notice stays, and for each of its characters
TURN_SPEED = 0.35  # radians a second of the camera going round by itself
SHORTEST = 1 / 150  # seconds from picture to picture: displays show no more
LONGEST_STEP = 1.0  # seconds: after a halt (a laptop's closed lid) the plant must not leap
LOADING = 0.01  # seconds of every picture for bringing movers to the GPU
IDLE = 0.25  # seconds between looks at the terminal's Ctrl-C, files and exports at rest
SETTLING = 0.6  # seconds that pictures go on after an event: tips come, cards find their sizes


class Window:
    """Clips in one open window, whose OpenGL context is current; `watch` gets every scene shown."""

    def __init__(self, handle: Any, clips: Sequence[OpenClip], changes: Mapping[str, Any]) -> None:
        """changes: fields of the first scene that are not as usual, the style among them."""
        self._handle, self.watch = handle, lambda scene: None
        self._context = from_window()
        self._gui = Gui()
        self._exports = Exports()
        self._measures = Measures.of(handle)
        self._dropped: list[str] = []
        self._drawn: tuple[Scene, Measures] | None
        self._view: tuple[float, Camera, Measures] | None
        self._changed_at, self._notice, self._notice_ends = 0.0, "", 0.0
        self._shown, clip = ExitStack(), clips[0].clip
        camera, timeline = home_camera(clip, (16.0, 9.0)), Timeline.of(clip.times).played()
        self.scene = Scene(timeline, camera, camera, changes["style"], (clip,))
        self._show(clips, fresh=True)
        self.scene = replace(self.scene, **{"notice": "", **changes})
        listen(handle, self._press, self._draw_again, self._dropped.extend)

    def run(self) -> tuple[Scene, tuple[int, int]]:
        """Draw and listen until the window is closed; gives the last scene, and (width, height) in
        units of 1/96 inch.
        """
        then = glfw.get_time()
        while not self.scene.closed and not glfw.window_should_close(self._handle):
            now = glfw.get_time()
            self._pass_time(min(now - then, LONGEST_STEP), now)
            then = now
            self._serve()
            self.scene = self._kept.written(self.scene)
            self._follow_window()
            self._draw()
            if self._lively:
                # Vertical sync paces this loop; where there is none, the wait does.
                glfw.wait_events_timeout(max(then + SHORTEST - glfw.get_time(), 0.0005))
            else:
                glfw.wait_events_timeout(IDLE)
                then = glfw.get_time()
        width, height = self._measures.units
        return self.scene, (round(width), round(height))

    def release(self) -> None:
        self._exports.release()
        self._shown.close()
        self._gui.release()

    def _show(self, clips: Sequence[OpenClip], fresh: bool) -> None:
        """Show clips: other ones (fresh), or the same ones as they were baked anew."""
        self._shown.close()
        self.clips, bare = tuple(clips), tuple(one.clip for one in clips)
        self.viewports = Viewports(self._context, bare)
        self._interface = Interface(self._gui, bare[0], " · ".join(one.name for one in clips))
        for made in (self.viewports, self._interface.organs):
            self._shown.callback(made.release)
        most = max(len(interval) for clip in bare for interval in clip.intervals)
        self._resolution = DynamicResolution(most)
        self._kept = KeptEdits(clips[0])
        self._files = FileWatch(*[one.file for one in clips if one.file is not None])
        self._fitted: tuple[float, float, float] | None = None
        self._drawn = self._view = None
        told = f"Opened {clips[0].name}" if fresh else "Baked anew: loaded again"
        self.scene = reopened(self.scene, bare, fresh).with_notice(told)

    @property
    def _lively(self) -> bool:
        """Whether time alone changes what is seen; if not, the GPU rests until an event comes."""
        return (
            (self.scene.timeline.playing and not self._interface.timeline.held)
            or self.scene.turning
            or self.scene.notice != ""
            or glfw.get_time() < self._changed_at + SETTLING
            or not self.viewports.whole
        )

    def _pass_time(self, seconds: float, now: float) -> None:
        scene = self.scene
        if not self._interface.timeline.held:
            scene = scene.with_timeline(lambda t: t.tick(seconds))
        if scene.turning and not self._interface.mouse.drags:
            scene = scene.with_camera(lambda c: c.orbit(TURN_SPEED * seconds, 0.0))
        if scene.following and scene.path:
            scene = replace(scene, camera=scene.path.at(scene.timeline.day))
        scene = self._exports.followed(scene)
        if scene.notice != self._notice:
            self._notice = scene.notice
            self._notice_ends = now + NOTICE_SECONDS + READING * len(scene.notice)
        elif scene.notice and now > self._notice_ends:
            scene = scene.with_notice("")
        self.scene = scene

    def _serve(self) -> None:
        """Do what was asked for once; show what was dropped on the window, or was baked anew."""
        dropped, self._dropped[:] = list(self._dropped), []
        try:
            if self.scene.wish is not None:
                self.scene = self._exports.granted(self.scene, self.clips[0], self._area)
            if dropped:
                self._show([OpenClip.of(Path(name)) for name in dropped[:2]], fresh=True)
            elif self._files.changed():
                again = [OpenClip.of(one.file) if one.file else one for one in self.clips]
                self._show(again, fresh=False)
        except UserError as error:
            told = str(error)
            for name in dropped:  # folders would leave no room for what is wrong
                told = told.replace(name, Path(name).name)
            self.scene = replace(self.scene, wish=None, notice=told)

    def _press(self, key: str, shift: bool, repeated: bool) -> None:
        if self._gui.takes(key):
            self._gui.type(key)
        else:
            self.scene = keys.pressed(self.scene, key.lower(), shift, repeated)

    def _follow_window(self) -> None:
        """Take over the window's present size, and give it the state that the scene asks for."""
        switch_fullscreen(self._handle, self.scene.fullscreen)
        self._measures = Measures.of(self._handle)
        # Fit the cameras to the part that a plant has.
        width, height = (length / self._measures.scale for length in self._area)
        width *= 0.5 if self.scene.compare is Compare.BESIDE else 1.0
        plot = strip_height(self.scene)
        if self._measures.visible and self._fitted != (width, height, plot):
            self._fitted = (width, height, plot)
            self.scene = fitted(self.scene, (width, height), plot)

    @property
    def _area(self) -> tuple[int, int]:
        """(width, height) in pixels of the part that shows plants."""
        return self._measures.beside(panel_width(self.scene))

    def _draw(self) -> None:
        """Draw the next picture, if it may differ from the last one."""
        scene, measures, now = self.scene, self._measures, glfw.get_time()
        measuring = self._interface.organs.measuring  # what is measured changes a card
        if (scene, measures) != self._drawn or self._gui.pending or measuring:
            self._changed_at = now
        elif not self._lively:
            return
        if not measures.visible:
            return
        view = scene.timeline.day, scene.camera, measures
        moves = view != self._view
        panes = panes_of(scene, [one.name for one in self.clips])
        detail = self._resolution.detail(self._area) if moves else Detail()
        budget = LOADING if moves or self.viewports.loading else None
        self.viewports.paint(self._area, panes, scene.style, detail, budget)
        screen, date = self._context.screen, date_at(scene.clip.scans, scene.timeline.day)
        self.viewports.show(screen)
        self.scene = self._interface.draw(screen, self.scene, measures.units, measures.scale, panes)
        check_context(self._context)
        if moves:  # swapping waits for the display
            self._resolution.frame_took(max(glfw.get_time() - now, self.viewports.gpu_seconds))
        glfw.swap_buffers(self._handle)
        glfw.set_window_title(self._handle, f"{date} · {self.clips[0].name}")
        self._drawn, self._view = (scene, measures), view
        mouse = self._interface.mouse
        if mouse.clicked is not None:
            found = self.viewports.organ_under(self.scene, mouse.clicked, measures.scale)
            self.scene = actions.pick(self.scene, *found, mouse.more) if found else self.scene
        self.watch(self.scene)

    def _draw_again(self) -> None:
        """The system lost the picture, or is changing the window's size right now."""
        self._drawn = None
        self._follow_window()
        self._draw()
