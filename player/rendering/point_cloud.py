"""The points of a clip on the GPU, and the shaders that draw ranges of them."""

from collections.abc import Iterator
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Interval, Motion
from gclip.evaluate import Layer, bernstein
from player.gl.framebuffer import texture
from player.gl.shader import give, program
from player.gl.timers import PassTimers
from player.rendering.point_buffers import ChunkBuffers, DrawRange, PointBuffers, chunk_length
from player.view.colors import STEPS, Colors
from player.view.style import Style

PALETTE_WIDTH = 1024  # texels in a row of the palette
MAX_TRACKS = 1024  # tracks that ten bits of a point's number distinguish (nearest_point.glsl)
WORKGROUP = 128  # invocations in a workgroup of a compute shader
POINTS_EACH = 4  # points that an invocation draws


class PointCloud:
    """A clip's buffers, its colours, and the programs for each shader and kind of interval.

    memory: bytes of GPU memory for points; by default the driver is asked.
    tracks_tell_colors: whether the ten track bits of a point's number determine its colour.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, memory: int | None = None) -> None:
        self.context = context
        self.clip = clip
        self.timers = PassTimers(context)
        self.buffers = PointBuffers(context, clip, memory)
        rows = -(-len(clip.track_table) // PALETTE_WIDTH)
        self.palette = texture(context, (PALETTE_WIDTH, rows), 4, "f4")
        self._ramp = texture(context, (STEPS, 1), 4, "f4")
        self._colors = Colors(clip)
        self._colored: tuple[float, Style] | None = None
        self._definitions = {"SCALAR_FIELD": 0, "HAS_FLAGS": 0}
        self._color_uniforms: dict[str, Any] = {}
        self._indices: dict[int, moderngl.Buffer] = {}
        self._programs: dict[tuple[Any, ...], Any] = {}

    def set_colors(self, day: float, style: Style) -> None:
        """Set the colours of a day, as a style has them, for all draw calls that follow."""
        if self._colored == (day, style):
            return
        tracks, field = len(self.clip.track_table), self._colors.scalar_field(style)
        by_track = style.color_by in ("track", "age")
        texels = np.zeros((self.palette.height * PALETTE_WIDTH, 4), np.float32)
        texels[:tracks] = self._colors.palette(day, style)
        self.palette.write(texels)
        self._ramp.write(self._colors.ramp(style))
        self._definitions = {"SCALAR_FIELD": field, "HAS_FLAGS": int(style.marked)}
        self._color_uniforms = {"palette": self.palette, "ramp": self._ramp, "by_track": by_track}
        if field:
            self._color_uniforms |= self._colors.uniforms(style)
        uncolored = by_track or not self.clip.has_colors
        self.tracks_tell_colors = not field and uncolored and tracks <= MAX_TRACKS
        self._colored = day, style

    def draw(self, name: str, ranges: list[DrawRange], uniforms: dict[str, Any]) -> None:
        """Draw points into the current framebuffer with the fragment shader `name`.

        The first word names the vertex shader: "splat_sum" has "splat".
        """
        for shader, stride, buffers, count in self._chunks(name, ranges, uniforms):
            array = buffers.array(shader, self._every(stride))
            array.render(moderngl.POINTS, vertices=-(-count // stride))

    def compute(
        self, name: str, ranges: list[DrawRange], uniforms: dict[str, Any], **definitions: int
    ) -> None:
        """Run the compute shader `name` on points; requires OpenGL 4.3."""
        for shader, stride, buffers, count in self._chunks(name, ranges, uniforms, **definitions):
            buffers.bind()
            shader.run(-(-count // (POINTS_EACH * WORKGROUP * stride)))
        self.context.memory_barrier()

    def _chunks(
        self, name: str, ranges: list[DrawRange], uniforms: dict[str, Any], **definitions: int
    ) -> Iterator[tuple[Any, int, ChunkBuffers, int]]:
        """The chunks of ranges: the program that draws each, with its uniforms set, the stride, the
        buffers, and how many points to draw of them.
        """
        for drawn in ranges:
            shader = self._program(name, drawn, **definitions)
            give(shader, **uniforms, **self._color_uniforms, **self._uniforms(drawn))
            with self.timers.timed(name):
                for chunk, count in self.buffers.chunks(drawn):
                    give(shader, first_point=chunk.first, count=count)
                    yield shader, drawn.stride, self.buffers.fetch(chunk, count), count

    def _every(self, stride: int) -> moderngl.Buffer | None:
        """Index buffer of every `stride`-th point of a chunk.

        Strided vertex attributes would do without, but OpenGL limits strides to 2,048 bytes.
        """
        if stride > 1 and stride not in self._indices:
            longest = max(min(chunk_length(each), len(each)) for each in self.clip.intervals)
            indices = np.arange(0, longest, stride, dtype=np.uint32)
            self._indices[stride] = self.context.buffer(indices)
        return self._indices.get(stride)

    def _program(self, name: str, drawn: DrawRange, **definitions: int) -> Any:
        """The program that draws a range; a compute shader if there are definitions."""
        interval = self.clip.intervals[drawn.layer.interval]
        defined = {
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
        key = (name, *defined.items())
        if key not in self._programs:
            vertex, _, _ = name.partition("_")
            files = (f"{name}.comp",) if definitions else (f"{vertex}.vert", f"{name}.frag")
            self._programs[key] = program(self.context, *files, **defined)
        return self._programs[key]

    def _uniforms(self, drawn: DrawRange) -> dict[str, Any]:
        """What the shaders need to know of a range."""
        layer, interval = drawn.layer, self.clip.intervals[drawn.layer.interval]
        box = interval.box
        return {
            "weights": bernstein(interval.degree, layer.parameter),
            "slopes": velocity_weights(interval, layer),
            "blend": layer.blend,
            "turned": layer.parameter,
            "opacity": layer.alpha,
            "stride": drawn.stride,
            "box_low": (0.0, 0.0, 0.0) if box is None else box.low,
            "box_step": (1.0, 1.0, 1.0) if box is None else tuple(box.step),
        }


def velocity_weights(interval: Interval, layer: Layer) -> NDArray[np.float64]:
    """(degree + 1,) weights of the Bézier points in a mover's velocity."""
    n = interval.degree
    lower = bernstein(n - 1, layer.parameter)
    rate = 2.0 * layer.blend if layer.group.motion is Motion.FALL else 1.0  # falling: u = share²
    passed = np.inf if layer.litter else interval.end - interval.start
    return n * rate / passed * (np.append(0.0, lower) - np.append(lower, 0.0))
