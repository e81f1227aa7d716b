"""Draw calls over the points of a clip: programs, uniforms and colours."""

from collections.abc import Iterator
from contextlib import nullcontext
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Interval, Motion
from gclip.evaluate import Layer, bernstein, srgb_to_linear
from player.gl.framebuffer import texture
from player.gl.shader import compile_program, set_uniforms
from player.gl.timers import PassTimers
from player.rendering.point_buffers import ChunkBuffers, DrawRange, PointBuffers
from player.view.colors import RAMP_SIZE, Colors
from player.view.style import ColorMode, Style
from shaders import MAX_TRACKS

PALETTE_WIDTH = 1024  # texels in a row of the palette
WORKGROUP = 256  # invocations in a workgroup of a compute shader
POINTS_PER_INVOCATION = 8


class PointCloud:
    """Draws points of a clip with programs compiled for each shader and kind of interval.

    memory:           bytes of GPU memory for points, by default a share of the GPU's memory.
    timers:           measures the passes, optional.
    color_from_track: whether the track in a point's code gives its colour (nearest_point.glsl).
    """

    def __init__(
        self,
        context: moderngl.Context,
        clip: Clip,
        memory: int | None = None,
        timers: PassTimers | None = None,
    ) -> None:
        self.context = context
        self.clip = clip
        self._timers = timers
        self.buffers = PointBuffers(context, clip, memory)
        rows = -(-len(clip.track_table) // PALETTE_WIDTH)
        self.palette = texture(context, (PALETTE_WIDTH, rows), 4, "f4")
        self._ramp = texture(context, (RAMP_SIZE, 1), 3, "f4")
        self._colors = Colors(clip)
        self._color_state: tuple[float, Style] | None = None
        self._definitions: dict[str, int | str] = {"HAS_FLAGS": 0}
        self._color_uniforms: dict[str, Any] = {}
        self._indices: dict[int, moderngl.Buffer] = {}
        self._programs: dict[tuple[Any, ...], Any] = {}

    def set_colors(self, day: float, style: Style) -> None:
        """Set the colours of a day and a style for the draw calls that follow."""
        if self._color_state == (day, style):
            return
        tracks, chosen = len(self.clip.track_table), ColorMode(style.color_by)
        by_track = chosen is ColorMode.TRACK or chosen.quantity.per_organ
        scale = self._colors.value_range(style) if chosen.quantity.glsl else None
        texels = np.zeros((self.palette.height * PALETTE_WIDTH, 4), np.float32)
        texels[:tracks] = self._colors.palette(day, style)
        self.palette.write(texels)
        has_flags = style.hidden or style.picked is not None or style.isolated is not None
        self._definitions = {"HAS_FLAGS": int(bool(has_flags))}
        self._color_uniforms = {"palette": self.palette, "by_track": by_track}
        if scale:
            self._ramp.write(srgb_to_linear(scale.colors() / 255.0).astype(np.float32))
            self._definitions["SCALAR_FIELD"] = chosen.quantity.glsl
            self._color_uniforms |= {"ramp": self._ramp, **scale.uniforms}
        uncolored = by_track or not self.clip.has_colors
        self.color_from_track = not scale and uncolored and tracks <= MAX_TRACKS
        self._color_state = day, style

    def draw(self, name: str, ranges: list[DrawRange], uniforms: dict[str, Any]) -> None:
        """Draw points into the current framebuffer with the fragment shader `name`.

        The vertex shader is named by the first word: "splat" for "splat_sum".
        """
        for program, stride, buffers, count in self._chunks(name, ranges, uniforms):
            array = buffers.array(program, self._strided_indices(stride))
            array.render(moderngl.POINTS, vertices=-(-count // stride))

    def compute(
        self, name: str, ranges: list[DrawRange], uniforms: dict[str, Any], **definitions: int
    ) -> None:
        """Run the compute shader `name` on points; requires OpenGL 4.3."""
        for program, stride, buffers, count in self._chunks(name, ranges, uniforms, **definitions):
            buffers.bind()
            program.run(-(-count // (POINTS_PER_INVOCATION * WORKGROUP * stride)))
        self.context.memory_barrier()

    def _chunks(
        self, name: str, ranges: list[DrawRange], uniforms: dict[str, Any], **definitions: int
    ) -> Iterator[tuple[Any, int, ChunkBuffers, int]]:
        """Yield the program, whose uniforms are set, stride, buffers and point count of chunks."""
        for drawn in ranges:
            program = self._program(name, drawn, **definitions)
            set_uniforms(program, **uniforms, **self._color_uniforms, **self._uniforms(drawn))
            with nullcontext() if self._timers is None else self._timers.timed(name):
                for chunk, count in self.buffers.chunks(drawn):
                    set_uniforms(program, first_point=chunk.first, count=count)
                    yield program, drawn.stride, self.buffers.fetch(chunk, count), count

    def _strided_indices(self, stride: int) -> moderngl.Buffer | None:
        """Index buffer of every `stride`-th point of a chunk; None for all points.

        Strided vertex attributes would need no indices, but OpenGL limits strides to 2,048 bytes.
        """
        if stride > 1 and stride not in self._indices:
            longest = max(map(self.buffers.chunk_length, self.clip.intervals))
            indices = np.arange(0, longest, stride, dtype=np.uint32)
            self._indices[stride] = self.context.buffer(indices)
        return self._indices.get(stride)

    def _program(self, name: str, drawn: DrawRange, **definitions: int) -> Any:
        """The program that draws a range; a compute shader if `definitions` are given."""
        interval = self.clip.intervals[drawn.layer.interval]
        macros = {
            "DEGREE": interval.degree,
            "SCAN_COLORS": int(interval.start_colors is not None),
            "NORMALS": int(interval.normals is not None),
            "QUANTISED": int(interval.box is not None),
            "WIDE_TRACKS": int(interval.tracks.itemsize == 4),
            "FADING": int(drawn.layer.alpha < 1.0),
            "WORKGROUP": WORKGROUP,
            **self._definitions,
            **definitions,
        }
        key = (name, *macros.items())
        if key not in self._programs:
            vertex, _, _ = name.partition("_")
            files = (f"{name}.comp",) if definitions else (f"{vertex}.vert", f"{name}.frag")
            self._programs[key] = compile_program(self.context, *files, **macros)
        return self._programs[key]

    def _uniforms(self, drawn: DrawRange) -> dict[str, Any]:
        """Uniforms that differ between ranges."""
        layer, interval = drawn.layer, self.clip.intervals[drawn.layer.interval]
        box = interval.box
        return {
            "weights": bernstein(interval.degree, layer.parameter),
            "velocity_weights": velocity_weights(interval, layer),
            "blend": layer.blend,
            "normal_share": layer.parameter,
            "opacity": layer.alpha,
            "stride": drawn.stride,
            "box_low": (0.0, 0.0, 0.0) if box is None else box.low,
            "box_step": (1.0, 1.0, 1.0) if box is None else tuple(box.step),
        }


def velocity_weights(interval: Interval, layer: Layer) -> NDArray[np.float64]:
    """(degree + 1,) weights of a mover's control points in its velocity, per unit of time."""
    n = interval.degree
    lower = bernstein(n - 1, layer.parameter)
    rate = 2.0 * layer.blend if layer.group.motion is Motion.FALL else 1.0  # falling: u = share²
    duration = np.inf if layer.litter else interval.end - interval.start
    return n * rate / duration * (np.append(0.0, lower) - np.append(lower, 0.0))
