"""The event loop of the window.

The state is an immutable scene (player/view/state.py). Events and the passing of time replace it,
and a frame is drawn only if it would differ from the last one.
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
from player.gl.timers import PassTimers
from player.ui import actions, keys
from player.ui.annotations import plot_height
from player.ui.gui import Gui
from player.ui.interface import Interface
from player.ui.panel import panel_width
from player.view.camera import Camera
from player.view.camera_animation import load_path
from player.view.choices import Compare
from player.view.playback import Timeline
from player.view.split_view import panes_of
from player.view.state import Scene, with_clips
from player.window.dynamic_resolution import Detail, DynamicResolution
from player.window.export_job import ExportJob
from player.window.glfw_window import WindowSize, set_callbacks, switch_fullscreen
from player.window.opened_clip import CorrectionsFile, FileWatch, OpenClip
from player.window.viewports import Viewports, home_camera, with_fitted_cameras
from traits.dates import date_at

NOTICE_SECONDS, SECONDS_PER_CHARACTER = 1.5, 0.06  # for which a notice is shown
TURN_SPEED = 0.35  # radians per second of the turning camera
MIN_FRAME_SECONDS = 1 / 150  # limits the frame rate where vertical sync is missing
MAX_TIME_STEP = 1.0  # seconds; playback must not jump after a suspended laptop resumes
UPLOAD_SECONDS = 0.01  # of each frame for uploading movers to the GPU
IDLE_SECONDS = 0.25  # between checks for Ctrl-C, changed files and exports when nothing moves
SETTLING_SECONDS = 0.6  # of drawing after an event, while tooltips appear and cards are laid out


class Window:
    """Shows clips in an open GLFW window, whose OpenGL context is current.

    changes: fields of the first scene by name, including its style.
    watch:   is called with the scene after each frame.
    """

    def __init__(self, handle: Any, clips: Sequence[OpenClip], changes: Mapping[str, Any]) -> None:
        self._handle, self.watch = handle, lambda scene: None
        self._context = from_window()
        self.timers = PassTimers(self._context)
        self._gui = Gui()
        self._exports = ExportJob()
        self._size = WindowSize.of_window(handle)
        self._dropped: list[str] = []
        self._changed_at, self._notice, self._notice_ends = 0.0, "", 0.0
        self._resources, clip = ExitStack(), clips[0].clip
        camera, timeline = home_camera(clip, (16.0, 9.0)), Timeline.of(clip.times).played()
        self.scene = Scene(timeline, camera, camera, changes["style"], (clip,))
        self._show(clips, reset=True)
        self.scene = replace(self.scene, **{"notice": "", **changes})
        set_callbacks(handle, self._press, self._draw_again, self._dropped.extend)

    def run(self) -> tuple[Scene, tuple[int, int]]:
        """Run the event loop until the window is closed.

        Returns the last scene, and (width, height) of the window in units of 1/96 inch.
        """
        then = glfw.get_time()
        while not self.scene.closed and not glfw.window_should_close(self._handle):
            now = glfw.get_time()
            self._pass_time(min(now - then, MAX_TIME_STEP), now)
            then = now
            self._handle_requests()
            self.scene = self._corrections.synchronized(self.scene)
            self._follow_window()
            self._draw()
            if self._is_animated:
                # Vertical sync limits the frame rate; this wait does so where there is none.
                glfw.wait_events_timeout(max(then + MIN_FRAME_SECONDS - glfw.get_time(), 0.0005))
            else:
                glfw.wait_events_timeout(IDLE_SECONDS)
                then = glfw.get_time()
        width, height = self._size.units
        return self.scene, (round(width), round(height))

    def release(self) -> None:
        self._exports.release()
        self._resources.close()
        self._gui.release()

    def _show(self, clips: Sequence[OpenClip], reset: bool) -> None:
        """Show other clips (reset), or the same clips after they were baked again."""
        self._resources.close()
        self.clips, opened = tuple(clips), tuple(entry.clip for entry in clips)
        self.viewports = Viewports(self._context, opened, self.timers)
        self._interface = Interface(self._gui, self.viewports.colors[0], *[c.name for c in clips])
        for resource in (self.viewports, self._interface.organs):
            self._resources.callback(resource.release)
        max_movers = max(len(interval) for clip in opened for interval in clip.intervals)
        self._resolution = DynamicResolution(max_movers)
        self._corrections = CorrectionsFile(clips[0])
        self._files = FileWatch(*[entry.file for entry in clips if entry.file is not None])
        self._fitted: tuple[float, float, float] | None = None
        self._drawn: tuple[Scene, WindowSize] | None = None
        self._view: tuple[float, Camera, WindowSize] | None = None
        baked = "The clip was baked again and has been reloaded"
        notice = f"Opened {clips[0].name}" if reset else baked
        self.scene = with_clips(self.scene, opened, reset).with_notice(notice)

    @property
    def _is_animated(self) -> bool:
        """Whether the picture changes without events; if not, no frames are drawn."""
        return (
            (self.scene.timeline.playing and not self._interface.timeline.dragging)
            or self.scene.turning
            or self.scene.notice != ""
            or glfw.get_time() < self._changed_at + SETTLING_SECONDS
            or not self.viewports.complete
        )

    def _pass_time(self, seconds: float, now: float) -> None:
        """Advance playback, camera, exports and notices."""
        scene = self.scene
        if not self._interface.timeline.dragging:
            scene = scene.with_timeline(lambda t: t.tick(seconds))
        if scene.turning and not self._interface.mouse.dragging:
            scene = scene.with_camera(lambda c: c.orbit(TURN_SPEED * seconds, 0.0))
        if scene.following and scene.path:
            scene = replace(scene, camera=scene.path.at(scene.timeline.day))
        scene = self._exports.with_progress(scene)
        if scene.notice != self._notice:
            self._notice = scene.notice
            self._notice_ends = now + NOTICE_SECONDS + SECONDS_PER_CHARACTER * len(scene.notice)
        elif scene.notice and now > self._notice_ends:
            scene = scene.with_notice("")
        self.scene = scene

    def _handle_requests(self) -> None:
        """Handle the scene's request, dropped clips and camera paths, and clips baked again."""
        dropped, self._dropped[:] = list(self._dropped), []
        try:
            if self.scene.request is not None:
                self.scene = self._exports.handle_request(self.scene, self.clips[0], self._area)
            paths = [Path(name) for name in dropped if name.lower().endswith(".json")]
            if clips := [Path(name) for name in dropped if Path(name) not in paths]:
                self._show([OpenClip.from_file(file) for file in clips[:2]], reset=True)
            elif self._files.changed():
                reopened = [OpenClip.from_file(old.file) if old.file else old for old in self.clips]
                self._show(reopened, reset=False)
            for file in paths:
                path = load_path(file, self.scene.clip)
                scene = actions.follow_path(replace(self.scene, path=path, following=False))
                self.scene = scene.with_notice(f"Opened {file.name}, {len(path.keys)} keys")
        except UserError as error:
            notice = str(error)
            for name in dropped:  # without the folder, the reason fits into the notice
                notice = notice.replace(name, Path(name).name)
            self.scene = replace(self.scene, request=None, notice=notice)

    def _press(self, key: str, shift: bool, repeated: bool) -> None:
        if self._gui.captures(key):
            self._gui.send_key(key)
        else:
            self.scene = keys.apply_key(self.scene, key.lower(), shift, repeated)

    def _follow_window(self) -> None:
        """Apply full screen to the window, and fit the home cameras to its current size."""
        switch_fullscreen(self._handle, self.scene.fullscreen)
        self._size = WindowSize.of_window(self._handle)
        width, height = (length / self._size.scale for length in self._area)
        width *= 0.5 if self.scene.compare is Compare.BESIDE else 1.0
        plot = plot_height(self.scene)
        if self._size.visible and self._fitted != (width, height, plot):
            self._fitted = (width, height, plot)
            self.scene = with_fitted_cameras(self.scene, (width, height), plot)

    @property
    def _area(self) -> tuple[int, int]:
        """(width, height) in pixels of the part of the window beside the panel."""
        return self._size.pixels_beside(panel_width(self.scene))

    def _draw(self) -> None:
        """Draw a frame, if it may differ from the last one."""
        scene, size, now = self.scene, self._size, glfw.get_time()
        measuring = self._interface.organs.measuring  # results will appear in the organ's card
        if (scene, size) != self._drawn or self._gui.has_events or measuring:
            self._changed_at = now
        elif not self._is_animated:
            return
        if not size.visible:
            return
        view = scene.timeline.day, scene.camera, size
        moves = view != self._view
        panes = panes_of(scene, [entry.name for entry in self.clips])
        detail = self._resolution.detail(self._area) if moves else Detail()
        budget = UPLOAD_SECONDS if moves or self.viewports.loading else None
        self.viewports.draw(self._area, panes, scene.style, detail, budget)
        screen, date = self._context.screen, date_at(scene.clip.scans, scene.timeline.day)
        self.viewports.blit(screen)
        self.scene = self._interface.draw(screen, self.scene, size.units, size.scale, panes)
        check_context(self._context)
        if moves:  # measured before swapping, which waits for the display
            self._resolution.record_frame(max(glfw.get_time() - now, self.viewports.gpu_seconds))
        glfw.swap_buffers(self._handle)
        glfw.set_window_title(self._handle, f"{date} · {self.clips[0].name}")
        self._drawn, self._view = (scene, size), view
        mouse = self._interface.mouse
        if mouse.clicked is not None:
            picked = self.viewports.organ_under(self.scene, mouse.clicked, size.scale)
            if picked:
                self.scene = actions.pick(self.scene, *picked, mouse.with_shift)
        self.watch(self.scene)

    def _draw_again(self) -> None:
        """Draw because the system lost the contents of the window, or is resizing it."""
        self._drawn = None
        self._follow_window()
        self._draw()
