"""The movers of a clip on the GPU: draws layers of them with any of the movers' shaders."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gclip.evaluate import Layer, bernstein
from player.buffers import BufferCache
from player.glsl import feedback, give, program

if TYPE_CHECKING:
    import moderngl

    from gclip import Clip

LOOK = {
    "CORE": 0.7,  # share of its radius in which a disc hides what lies behind
    "RIM_OUTSIDE": 0.16,  # summed weights where the plant's silhouette begins and is closed
    "RIM_INSIDE": 0.30,
    "SMOOTHING": 1.3,  # reach of the blur of distances, in disc radii
}
PALETTE_WIDTH = 1024  # texels in a row of the palette


class Movers:
    """One clip's buffers, the tracks' palette, and a program for each shader and path degree."""

    def __init__(self, context: moderngl.Context, clip: Clip) -> None:
        self.context = context
        self.clip = clip
        self.buffers = BufferCache(context, clip)
        self.palette = _palette_texture(context, clip)
        self._programs: dict[tuple[str, int, bool], moderngl.Program] = {}

    def draw(self, name: str, layers: list[Layer], uniforms: dict[str, Any]) -> None:
        """Draw layers as points with the shader `name`, into the framebuffer in use."""
        import moderngl

        for layer in layers:
            buffers = self.buffers[layer.interval]
            shader = self._program(name, buffers.degree, buffers.colored)
            give(shader, **uniforms, blend=layer.blend, opacity=layer.alpha)
            self._give_layer(shader, layer)
            buffers.array(shader).render(
                moderngl.POINTS, vertices=layer.group.count, first=layer.group.first
            )

    def _give_layer(self, shader: moderngl.Program, layer: Layer) -> None:
        interval = self.clip.intervals[layer.interval]
        low, step = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
        if interval.box is not None:
            low, step = interval.box.low, tuple(interval.box.step)
        give(
            shader,
            box_low=low,
            box_step=step,
            weights=tuple(bernstein(interval.degree, layer.parameter)),
        )

    def _program(self, name: str, degree: int, colored: bool) -> moderngl.Program:
        key = (name, degree, colored)
        if key not in self._programs:
            chosen: dict[str, int | float] = {"DEGREE": degree, "SCAN_COLORS": int(colored)}
            self._programs[key] = (
                feedback(self.context, name, "out_position", **chosen)
                if name == "positions"
                else program(self.context, name, name, **LOOK, **chosen)
            )
        return self._programs[key]

    def positions(self, layers: list[Layer]) -> NDArray[np.float32]:
        """(N, 3) positions of the layers' movers, read back by transform feedback.

        Nothing is drawn, yet GL wants a complete framebuffer in use.
        """
        parts = []
        for layer in layers:
            buffers = self.buffers[layer.interval]
            shader = self._program("positions", buffers.degree, buffers.colored)
            self._give_layer(shader, layer)
            result = self.context.buffer(reserve=max(12 * layer.group.count, 4))
            buffers.array(shader).transform(
                result, vertices=layer.group.count, first=layer.group.first
            )
            parts.append(np.frombuffer(result.read(12 * layer.group.count), np.float32))
            result.release()
        return np.concatenate(parts).reshape(-1, 3)

    def release(self) -> None:
        self.buffers.release()
        self.palette.release()
        for shader in self._programs.values():
            shader.release()


def _palette_texture(context: moderngl.Context, clip: Clip) -> moderngl.Texture:
    rows = -(-len(clip.track_table) // PALETTE_WIDTH)
    texels = np.zeros((rows * PALETTE_WIDTH, 4), np.uint8)
    texels[: len(clip.track_table)] = clip.palette
    texture = context.texture((PALETTE_WIDTH, rows), 4, texels)
    return texture
