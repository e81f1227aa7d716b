"""Keeps motion smooth on slow machines: fewer movers and pixels while things move, all of them at
rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import moderngl

BUDGET = 1 / 15  # seconds that a picture may take while things move
ROOMY = 0.4  # share of the budget below which more detail is tried
LEVELS = (1.0, 0.8, 0.62, 0.48)  # shares of the window's width and height
PLENTY = 400_000  # pixels that are always drawn: below them it is the points that take the time
FEWEST = 1_000_000  # movers that are always drawn: fewer would not be much faster
PATIENCE = 3  # slow or fast pictures in a row before the level changes

_VERTEX = """#version 330
out vec2 v_texture;
void main() {
    v_texture = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
    gl_Position = vec4(2.0 * v_texture - 1.0, 0.0, 1.0);
}
"""

_FRAGMENT = """#version 330
uniform sampler2D picture;
in vec2 v_texture;
out vec4 out_color;
void main() {
    out_color = vec4(texture(picture, v_texture).rgb, 1.0);
}
"""


@dataclass(frozen=True)
class Detail:
    """How much of a picture to draw.

    pixels: share of the window's width and height.
    every:  of so many movers one.
    """

    pixels: float = 1.0
    every: int = 1


class Pace:
    """Chooses how much detail the machine can draw in time.

    movers: how many there are at most to draw at once. Where there are very many, half of them are
            left out, and half again, before pixels are.
    """

    def __init__(self, movers: int = 0) -> None:
        fewer = [Detail(1.0, 2**n) for n in range(1, 32) if movers / 2**n >= FEWEST]
        least = fewer[-1].every if fewer else 1
        self._ladder = [Detail(), *fewer, *(Detail(share, least) for share in LEVELS[1:])]
        self._level = 0
        self._slow = self._fast = 0

    def detail(self, size: tuple[int, int]) -> Detail:
        """For a framebuffer of `size` pixels."""
        least = math.sqrt(PLENTY / max(size[0] * size[1], 1))
        chosen = self._ladder[self._level]
        return replace(chosen, pixels=min(max(chosen.pixels, least), 1.0))

    def took(self, seconds: float) -> None:
        """A picture at the present detail took so long."""
        self._slow = self._slow + 1 if seconds > BUDGET else 0
        self._fast = self._fast + 1 if seconds < ROOMY * BUDGET else 0
        if self._slow >= PATIENCE and self._level < len(self._ladder) - 1:
            self._level, self._slow = self._level + 1, 0
        elif self._fast >= PATIENCE and self._level > 0:
            self._level, self._fast = self._level - 1, 0


class Enlarger:
    """Draws a small picture and spreads it over a large framebuffer."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context: Any = context
        self._program = context.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
        self._array = context.vertex_array(self._program, [])
        self._small: Any = None

    def draw(
        self,
        framebuffer: Any,
        size: tuple[int, int],
        detail: float,
        paint: Callable[[Any, tuple[int, int]], None],
    ) -> None:
        """Let `paint(framebuffer, size)` draw at a share of the width and height of `size`."""
        if detail == 1.0:
            paint(framebuffer, size)
            return
        small = self._sized((max(round(size[0] * detail), 1), max(round(size[1] * detail), 1)))
        paint(small, small.size)
        self.copy(small.color_attachments[0], framebuffer, framebuffer.viewport)

    def copy(self, picture: Any, framebuffer: Any, viewport: tuple[int, int, int, int]) -> None:
        """Spread a texture over a part of a framebuffer."""
        framebuffer.viewport = viewport
        framebuffer.use()
        self._context.enable_only(self._context.NOTHING)
        picture.use()
        self._array.render(self._context.TRIANGLES, vertices=3)

    def release(self) -> None:
        self._forget()
        self._array.release()
        self._program.release()

    def _sized(self, size: tuple[int, int]) -> Any:
        if self._small is None or self._small.size != size:
            self._forget()
            texture = self._context.texture(size, 4)
            texture.repeat_x = texture.repeat_y = False
            self._small = self._context.framebuffer([texture])
        return self._small

    def _forget(self) -> None:
        if self._small is not None:
            self._small.color_attachments[0].release()
            self._small.release()
            self._small = None
