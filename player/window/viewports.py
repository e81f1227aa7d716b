"""The plants in a window: drawn into a picture of their own, shown as it is until they change."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from player.gl.gl_errors import pictures_of
from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.colors import Colors
from player.view.split_view import Pane
from player.window.dynamic_resolution import Detail, Enlarger

if TYPE_CHECKING:
    from gclip import Clip
    from player.view.style import Style

ABOVE, BELOW = 68.0, 112.0  # what title and timeline take from the picture, in units


def home_camera(clip: Clip, size: tuple[float, float]) -> Camera:
    """The whole plant in the part of a window that title and timeline leave free.

    size: (width, height) of the window in units.
    """
    width, height = size
    free = max(height - ABOVE - BELOW, 0.3 * height)
    camera = Camera.home(clip, width / free).zoom(free / height)
    return camera.pan(0.0, (BELOW - ABOVE) / 2 / height)


class Stage:
    """One renderer for each clip, in one context; others, made when first wanted, for its errors
    and for the last scan shown of those left out.

    whole:   whether the last picture showed every mover.
    loading: whether movers came to the GPU for it, or their size is not known yet.
    """

    def __init__(self, context: Any, clips: Sequence[Clip]) -> None:
        self._context = context
        self._clips = clips
        self._colors = [Colors(clip) for clip in clips]
        self._renderers: dict[tuple[int, bool, int | None], Renderer] = {
            (number, False, None): Renderer(context, clip) for number, clip in enumerate(clips)
        }
        self._enlarger = Enlarger(context)
        self._pictures: dict[str, Any] = {}
        self._painted: object = None
        self.whole = True
        self.loading = True

    def paint(
        self,
        size: tuple[int, int],
        panes: Sequence[Pane],
        style: Style,
        detail: Detail,
        patience: float | None,
    ) -> None:
        """Bring the picture up to date: `size` pixels, the panes from left to right.

        patience: seconds that uploading may take; None waits for all of it.
        """
        wanted = (size, tuple(panes), style, detail)
        if wanted == self._painted and self.whole:
            return
        before = self._loaded
        self.whole = True
        picture = self._sized("all", size)
        for pane in panes:
            left, right = round(pane.left * size[0]), round(pane.right * size[0])
            if right <= left:
                continue
            part = (right - left, size[1]) if pane.own else size
            into = picture if part == size and len(panes) == 1 else self._sized("part", part)
            self._paint_pane(into, part, pane, style, detail, patience)
            if into is not picture:
                where = (left, 0, *part) if pane.own else (0, 0, *size)
                picture.scissor = (left, 0, right - left, size[1])
                self._enlarger.copy(into.color_attachments[0], picture, where)
                picture.scissor = None
        settled = all(self._renderer(pane, style).radius_known(pane.day) for pane in panes)
        self.loading = patience is not None and (before != self._loaded or not settled)
        self._painted = wanted

    def show(self, screen: Any, size: tuple[int, int]) -> None:
        """Put the picture on the screen, at its left; `size` as it was painted."""
        self._enlarger.copy(self._sized("all", size).color_attachments[0], screen, (0, 0, *size))

    def pixels(self, size: tuple[int, int]) -> bytes:
        """The picture as RGB, bottom row first."""
        return bytes(self._sized("all", size).read(components=3, alignment=1))

    def release(self) -> None:
        for picture in self._pictures.values():
            picture.color_attachments[0].release()
            picture.release()
        self._enlarger.release()
        for renderer in self._renderers.values():
            renderer.release()

    @property
    def _loaded(self) -> int:
        return sum(renderer.loaded for renderer in self._renderers.values())

    def _renderer(self, pane: Pane, style: Style) -> Renderer:
        """Errors, and scans that were left out, are clips of their own."""
        errors = style.color_by == "error" and bool(self._clips[pane.clip].held_out)
        key = (pane.clip, errors, pane.left_out)
        if key not in self._renderers:
            colors = self._colors[pane.clip]
            if pane.left_out is None:
                clip = colors.clip_with_colors(style)
            else:
                clip = colors.left_out(pane.left_out, style)
                for other in [k for k in self._renderers if k[2] is not None]:
                    self._renderers.pop(other).release()
            self._renderers[key] = Renderer(self._context, clip)
        return self._renderers[key]

    def _paint_pane(
        self,
        into: Any,
        size: tuple[int, int],
        pane: Pane,
        style: Style,
        detail: Detail,
        patience: float | None,
    ) -> None:
        def paint(framebuffer: Any, pixels: tuple[int, int]) -> None:
            whole = self._renderer(pane, style).draw(
                *(framebuffer, pane.day, pane.camera, style, pixels),
                stride=detail.every,
                upload_budget=patience,
            )
            self.whole = self.whole and whole

        into.viewport = (0, 0, *size)
        self._enlarger.draw(into, size, detail.pixels, paint)

    def _sized(self, name: str, size: tuple[int, int]) -> Any:
        """A framebuffer of a size; the last one of that name is given up where it differs."""
        kept = self._pictures.get(name)
        if kept is not None and kept.size == size:
            return kept
        if kept is not None:
            kept.color_attachments[0].release()
            kept.release()
        self._pictures.pop(name, None)
        with pictures_of(size):
            texture = self._context.texture(size, 4)
            texture.repeat_x = texture.repeat_y = False
            self._pictures[name] = self._context.framebuffer([texture])
        return self._pictures[name]
