"""Views of clips in a window, drawn into textures that are reused until the view changes."""

from collections.abc import Sequence
from dataclasses import replace

import moderngl

from corrections import Place
from gclip import Clip
from player.gl.framebuffer import framebuffer, textures_of
from player.gl.shader import Passes
from player.gl.timers import PassTimers
from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.colors import Colors
from player.view.organ_place import organ_place
from player.view.split_view import Pane, paired_home_cameras, transferred_camera
from player.view.state import Scene
from player.view.style import ColorMode, Style
from player.window.dynamic_resolution import Detail

Size = tuple[int, int]  # width and height in pixels
TITLE_HEIGHT, TIMELINE_HEIGHT = 68.0, 112.0  # units of 1/96 inch


def home_camera(clip: Clip, size: tuple[float, float], plot: float = 0.0) -> Camera:
    """A camera that shows the whole plant between title and timeline.

    size, plot: (width, height) of the view, and height of the plot above the timeline, in units.
    """
    (width, height), below = size, TIMELINE_HEIGHT + plot
    free = max(height - TITLE_HEIGHT - below, 0.3 * height)
    camera = Camera.home(clip, width / free).zoom(free / height)
    return camera.pan(0.0, (below - TITLE_HEIGHT) / 2 / height)


def with_fitted_cameras(scene: Scene, size: tuple[float, float], plot: float = 0.0) -> Scene:
    """Fit the home cameras to the view's size, and move the scene's camera with them.

    size, plot: as for `home_camera`.
    """
    home, *rest = (home_camera(clip, size, plot) for clip in scene.clips)
    second_home, orthographic = None, scene.camera.orthographic
    if rest:
        home, second_home = paired_home_cameras(scene.clips, (home, *rest))
    camera = transferred_camera(scene.camera, scene.home, home)
    if scene.camera == scene.home.with_orthographic(orthographic):
        camera = home.with_orthographic(orthographic)
    return replace(scene, camera=camera, home=home, second_home=second_home)


class Viewports:
    """Renderers of the panes of a window, which share an OpenGL context.

    There is one renderer for each clip, one for its copy with the current values as colours, and
    one for the held-out scan that was shown last; each is created on first use.

    timers:      measure the passes of all renderers, optional.
    colors:      of the clips; they keep the values that they have computed.
    complete:    whether the last picture contained all movers.
    loading:     whether movers were uploaded for the last picture.
    gpu_seconds: GPU time of the last picture but two.
    """

    def __init__(
        self, context: moderngl.Context, clips: Sequence[Clip], timers: PassTimers | None = None
    ) -> None:
        self._context, self._timers = context, timers or PassTimers(context)
        self.colors = [Colors(clip) for clip in clips]
        self._renderers: dict[tuple[int, str, int | None], Renderer] = {}
        self._passes = Passes(context)
        self._pictures: dict[int, moderngl.Framebuffer] = {}
        self._drawn: tuple[Size, tuple[Pane, ...], Style, Detail] | None = None
        self.complete = self.loading = True
        self.gpu_seconds = 0.0

    def draw(
        self, size: Size, panes: Sequence[Pane], style: Style, detail: Detail, budget: float | None
    ) -> None:
        """Draw the panes into their textures, unless they are up to date.

        size:   (width, height) of all panes in pixels.
        panes:  from left to right.
        budget: seconds for uploading movers; None uploads all of them.
        """
        state = (size, tuple(panes), style, detail)
        if state == self._drawn and self.complete:
            return
        self.complete, self.loading = True, False
        self.gpu_seconds = self._timers.finish_frame()
        for index, pane in enumerate(panes):
            whole, _ = _rectangles(pane, size)
            width, height = (round(side * detail.resolution) or 1 for side in whole[2:])
            target = self._framebuffer(index, (width, height))
            renderer = self._renderer(pane, style)
            loaded = renderer.loaded
            self.complete &= renderer.draw(
                *(target, pane.day, pane.camera, style, (width, height)),
                stride=detail.stride,
                upload_budget=budget,
            )
            self.loading |= budget is not None and renderer.loaded != loaded
        self._drawn = state

    def organ_under(
        self, scene: Scene, position: tuple[float, float], scale: float
    ) -> tuple[int | None, Place | None] | None:
        """The organ of the first clip at a position of the last picture.

        position: right and down from the top left corner, in units of `scale` pixels.
        Returns the track and the point on the organ, both None beside the plant; returns None if
        the position is in a pane of the second clip.
        """
        assert self._drawn
        size, panes, style, _ = self._drawn
        x, y = position[0] * scale, position[1] * scale
        for pane in panes:
            (left, _, width, height), visible = _rectangles(pane, size)
            if pane.clip == 0 and visible[0] <= x < visible[0] + visible[2]:
                renderer, in_pane = self._renderer(pane, style), (x - left, y)
                track = renderer.organ_at(pane.day, pane.camera, style, in_pane, (width, height))
                if track is None:
                    return None, None
                clip_position = 2 * (x - left) / width - 1, 1 - 2 * y / height
                click = pane.camera, width / height, clip_position
                return track, organ_place(scene.clip, track, pane.day, click)
        return None

    def blit(self, screen: moderngl.Framebuffer) -> None:
        """Copy the last picture to the left part of the screen."""
        assert self._drawn
        size, panes, *_ = self._drawn
        screen.use()
        self._context.enable_only(moderngl.NOTHING)
        for index, pane in enumerate(panes):
            screen.viewport, screen.scissor = _rectangles(pane, size)
            self._passes.run("blit", **textures_of(self._pictures[index]))
        screen.scissor = None  # type: ignore[assignment]

    def release(self) -> None:
        for renderer in self._renderers.values():
            renderer.release()

    def _renderer(self, pane: Pane, style: Style) -> Renderer:
        """The renderer of a pane; values as colours and held-out scans are clips of their own."""
        mode, colors = ColorMode(style.color_by), self.colors[pane.clip]
        quantity, clip = mode.quantity, colors.clip
        has_values = quantity.per_mover and not quantity.why_unavailable(clip)
        coloring = f"{mode} {style.color_map} {style.field}" if has_values else ""
        key = (pane.clip, coloring, pane.held_out_index)
        if key not in self._renderers:
            for other in list(self._renderers):
                _, other_coloring, held_out_index = other
                replaced = pane.held_out_index is not None and held_out_index is not None
                if replaced or (other_coloring and other_coloring != coloring):
                    self._renderers.pop(other).release()
            clip = colors.clip_with_colors(style) if has_values else clip
            if pane.held_out_index is not None:
                clip = colors.held_out_clip(pane.held_out_index, style)
            self._renderers[key] = Renderer(self._context, clip, timers=self._timers)
        return self._renderers[key]

    def _framebuffer(self, index: int, size: Size) -> moderngl.Framebuffer:
        """The framebuffer of a pane; it is replaced if the size has changed."""
        if index not in self._pictures or self._pictures[index].size != size:
            self._pictures.pop(index, None)
            self._pictures[index] = framebuffer(self._context, size, picture=(4, "f1"), linear=True)
        return self._pictures[index]


def _rectangles(pane: Pane, size: Size) -> tuple[tuple[int, int, int, int], ...]:
    """(left, bottom, width, height) of a pane's picture in pixels, and of its visible part."""
    left, right = round(pane.left * size[0]), round(pane.right * size[0])
    visible = (left, 0, right - left, size[1])
    return (visible if pane.is_whole else (0, 0, *size)), visible
