"""The plants in a window: drawn into a picture of their own, shown as it is until they change."""

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
from player.view.split_view import Pane, paired_homes, transferred
from player.view.state import Scene
from player.view.style import ColorMode, Style
from player.window.dynamic_resolution import Detail

Size = tuple[int, int]  # width and height in pixels
ABOVE, BELOW = 68.0, 112.0  # what title and timeline take from the picture, in units


def home_camera(clip: Clip, size: tuple[float, float], plot: float = 0.0) -> Camera:
    """The whole plant in the part of a window that title, plot and timeline leave free.

    size, plot: (width, height) of the window, and height of the plot, in units.
    """
    (width, height), below = size, BELOW + plot
    free = max(height - ABOVE - below, 0.3 * height)
    camera = Camera.home(clip, width / free).zoom(free / height)
    return camera.pan(0.0, (below - ABOVE) / 2 / height)


def fitted(scene: Scene, size: tuple[float, float], plot: float = 0.0) -> Scene:
    """The scene with the home cameras of a window, and its camera as it stood beside the last one.

    size, plot: as `home_camera` takes them, of what a plant has of the window.
    """
    home, *rest = (home_camera(clip, size, plot) for clip in scene.clips)
    other, flat = None, scene.camera.orthographic
    if rest:
        home, other = paired_homes(scene.clips, (home, *rest))
    camera = transferred(scene.camera, scene.home, home)
    if scene.camera == scene.home.with_orthographic(flat):
        camera = home.with_orthographic(flat)
    return replace(scene, camera=camera, home=home, other_home=other)


class Viewports:
    """One renderer for each clip, in one context; others, made when first wanted, for values that
    it wears as colours and for the last scan shown of those left out.

    whole:   whether the last picture showed every mover.
    loading: whether movers came to the GPU for it.
    gpu_seconds: what the picture before it took on the GPU.
    """

    def __init__(self, context: moderngl.Context, clips: Sequence[Clip]) -> None:
        self._context, self._clips = context, clips
        self._colors = [Colors(clip) for clip in clips]
        self._renderers: dict[tuple[int, str, int | None], Renderer] = {}
        self._passes = Passes(context)
        self._pictures: dict[int, moderngl.Framebuffer] = {}
        self._painted: tuple[Size, tuple[Pane, ...], Style, Detail] | None = None
        self.whole = self.loading = True
        self.gpu_seconds = 0.0

    def paint(
        self, size: Size, panes: Sequence[Pane], style: Style, detail: Detail, budget: float | None
    ) -> None:
        """Bring a picture of (width, height) pixels up to date.

        panes: what it shows, from left to right; detail: how much of it to draw.
        budget: seconds that uploading may take; None waits for all of it.
        """
        wanted = (size, tuple(panes), style, detail)
        if wanted == self._painted and self.whole:
            return
        before, self.whole, self.gpu_seconds = self._loaded, True, 0.0
        for number, pane in enumerate(panes):
            whole, _ = _places(pane, size)
            pixels = round(whole[2] * detail.pixels) or 1, round(whole[3] * detail.pixels) or 1
            renderer, into = self._renderer(pane, style), self._framebuffer(number, pixels)
            self.whole &= renderer.draw(
                *(into, pane.day, pane.camera, style, pixels),
                stride=detail.every,
                upload_budget=budget,
            )
            self.gpu_seconds += renderer.gpu_seconds
        self.loading = budget is not None and before != self._loaded
        self._painted = wanted

    def organ_under(
        self, scene: Scene, at: tuple[float, float], scale: float
    ) -> tuple[int | None, Place | None] | None:
        """The track of the first clip's organ that is seen at a place of the picture, in units of
        `scale` pixels from its top left corner, and where it was clicked; None over another clip.
        """
        assert self._painted
        size, panes, style, _ = self._painted
        x, y = at[0] * scale, at[1] * scale
        for pane in panes:
            (left, _, width, height), seen = _places(pane, size)
            if pane.clip == 0 and seen[0] <= x < seen[0] + seen[2]:
                renderer, place, whole = self._renderer(pane, style), (x - left, y), (width, height)
                track = renderer.organ_at(pane.day, pane.camera, style, place, whole)
                if track is None:
                    return None, None
                view = pane.camera, width / height, (2 * (x - left) / width - 1, 1 - 2 * y / height)
                return track, organ_place(scene.clip, track, pane.day, view)
        return None

    @property
    def timers(self) -> list[PassTimers]:
        """Of the passes of all pictures so far."""
        return [renderer.timers for renderer in self._renderers.values()]

    def show(self, screen: moderngl.Framebuffer) -> None:
        """Put the picture on the screen, at its left."""
        assert self._painted
        size, panes, *_ = self._painted
        screen.use()
        self._context.enable_only(moderngl.NOTHING)
        for number, pane in enumerate(panes):
            screen.viewport, screen.scissor = _places(pane, size)
            self._passes.fill("blit", **textures_of(self._pictures[number]))
        screen.scissor = None  # type: ignore[assignment]

    def release(self) -> None:
        for renderer in self._renderers.values():
            renderer.release()

    @property
    def _loaded(self) -> int:
        return sum(renderer.loaded for renderer in self._renderers.values())

    def _renderer(self, pane: Pane, style: Style) -> Renderer:
        """What wears values as colours, and scans that were left out, are clips of their own."""
        mode, colors = ColorMode(style.color_by), self._colors[pane.clip]
        painted = mode.painted and not mode.lacking(self._clips[pane.clip])
        paint = f"{mode} {style.color_map} {style.field}" if painted else ""
        key = (pane.clip, paint, pane.left_out)
        if key not in self._renderers:
            for number, worn, left_out in list(self._renderers):
                replaced = pane.left_out is not None and left_out is not None
                if replaced or (worn and worn != paint):
                    self._renderers.pop((number, worn, left_out)).release()
            clip = colors.clip_with_colors(style) if painted else self._clips[pane.clip]
            if pane.left_out is not None:
                clip = colors.left_out(pane.left_out, style)
            self._renderers[key] = Renderer(self._context, clip)
        return self._renderers[key]

    def _framebuffer(self, number: int, size: Size) -> moderngl.Framebuffer:
        """What a pane is drawn into; the last one is given up where its size differs."""
        if number not in self._pictures or self._pictures[number].size != size:
            self._pictures.pop(number, None)
            self._pictures[number] = framebuffer(
                self._context, size, picture=(4, "f1"), linear=True
            )
        return self._pictures[number]


def _places(pane: Pane, size: Size) -> tuple[tuple[int, int, int, int], ...]:
    """Left, bottom, width and height of a pane's picture in the window, and of the part seen."""
    left, right = round(pane.left * size[0]), round(pane.right * size[0])
    seen = (left, 0, right - left, size[1])
    return (seen if pane.own else (0, 0, *size)), seen
