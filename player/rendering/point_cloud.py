"""The points of a clip on the GPU, and the shaders that draw ranges of them."""

from collections.abc import Iterator
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Interval, Motion
from gclip.evaluate import Layer, bernstein
from player.gl.framebuffer import texture
from player.gl.gpu_memory import room
from player.gl.shader import compute, give, program
from player.gl.timers import PassTimers
from player.rendering.point_buffers import ChunkBuffers, DrawRange, chunk_length
from player.rendering.point_store import ChunkStore
from player.view.colors import STEPS, Colors, ScalarField
from player.view.style import Style

PALETTE_WIDTH = 1024  # texels in a row of the palette
WORKGROUP = 128  # invocations in a workgroup of a compute shader
POINTS_EACH = 4  # points that an invocation draws


class PointCloud:
    """A clip's chunks, its palette, and the programs for each shader and kind of interval.

    memory: bytes of GPU memory for points; by default the driver is asked.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, memory: int | None = None) -> None:
        self.context = context
        self.timers = PassTimers(context)
        self.clip = clip
        self.store = ChunkStore(context, clip, room(context) if memory is None else memory)
        rows = -(-len(clip.track_table) // PALETTE_WIDTH)
        self.palette = texture(context, (PALETTE_WIDTH, rows), 4, "f4")
        self.ramp = texture(context, (STEPS, 1), 4, "f4")
        self._longest_chunk = max(
            (min(chunk_length(i), g.count) for i in clip.intervals for g in i.groups), default=0
        )
        # A newborn organ takes on its own colour from that of the organ it grows from.
        self._has_births = any(track.born > clip.times[0] for track in clip.track_table)
        self._indices: dict[int, moderngl.Buffer] = {}
        self._colored: object = None
        self._definitions: dict[str, int] = {"SCALAR_FIELD": 0, "HAS_FLAGS": 0}
        self._scalar: dict[str, object] = {}
        self._programs: dict[tuple[Any, ...], Any] = {}

    def set_colors(self, colors: Colors, day: float, style: Style) -> None:
        """Set the colours of a day, as a style has them, for all draw calls that follow."""
        changing = self._has_births or style.color_by == "age"
        wanted = (day if changing else None, style)
        if wanted == self._colored:
            return
        texels = np.zeros((self.palette.height * PALETTE_WIDTH, 4), np.float32)
        texels[: len(self.clip.track_table)] = colors.palette(day, style)
        self.palette.write(texels)
        self.ramp.write(colors.ramp(style))
        field = colors.scalar_field(style)
        self._definitions = {"SCALAR_FIELD": int(field), "HAS_FLAGS": int(style.marked)}
        self._scalar = {} if field is ScalarField.NONE else colors.uniforms()
        self._colored = wanted

    def draw(self, name: str, ranges: list[DrawRange], uniforms: dict[str, Any]) -> None:
        """Draw points into the current framebuffer with the fragment shader `name`.

        The first word names the vertex shader: "splat_sum" has "splat".
        """
        for drawn in ranges:
            shader = self._program(name, drawn.layer, uniforms)
            indices = self._every(drawn.stride)
            with self.timers.timed(name):
                for buffers, count in self._chunks(shader, drawn):
                    array = buffers.array(shader, indices)
                    array.render(moderngl.POINTS, vertices=-(-count // drawn.stride))

    def compute(
        self, name: str, ranges: list[DrawRange], uniforms: dict[str, Any], **definitions: int
    ) -> None:
        """Run the compute shader `name` on points; requires OpenGL 4.3."""
        for drawn in ranges:
            shader = self._program(name, drawn.layer, uniforms, **definitions)
            give(shader, stride=drawn.stride)
            with self.timers.timed(name):
                for buffers, count in self._chunks(shader, drawn):
                    give(shader, count=count)
                    buffers.bind()
                    shader.run(-(-count // (POINTS_EACH * WORKGROUP * drawn.stride)))
        self.context.memory_barrier()

    def _chunks(self, shader: Any, drawn: DrawRange) -> Iterator[tuple[ChunkBuffers, int]]:
        """The chunks of a range and the number of points to draw of each; sets `first_point`."""
        for chunk, count in self.store.chunks(drawn):
            if drawn.layer.alpha < 1.0:
                give(shader, first_point=chunk.first)
            yield self.store.fetch(chunk, count), count

    def _every(self, stride: int) -> moderngl.Buffer | None:
        """Index buffer of every `stride`-th point of a chunk.

        Strided vertex attributes would do without, but OpenGL limits strides to 2,048 bytes.
        """
        if stride > 1 and stride not in self._indices:
            indices = np.arange(0, self._longest_chunk, stride, dtype=np.uint32)
            self._indices[stride] = self.context.buffer(indices)
        return self._indices.get(stride)

    def _program(
        self, name: str, layer: Layer, uniforms: dict[str, Any], **definitions: int
    ) -> Any:
        """The program for a layer, its uniforms set; a compute shader if there are definitions."""
        interval = self.clip.intervals[layer.interval]
        defined = {
            "DEGREE": interval.degree,
            "SCAN_COLORS": int(interval.start_colors is not None),
            "NORMALS": int(interval.normals is not None),
            "FADING": int(layer.alpha < 1.0),
            **self._definitions,
            **definitions,
        }
        if definitions:
            defined["QUANTISED"] = int(interval.box is not None)
            defined["WIDE_TRACKS"] = int(interval.tracks.itemsize == 4)
            defined["WORKGROUP"] = WORKGROUP
        key = (name, *defined.items())
        if key not in self._programs and definitions:
            self._programs[key] = compute(self.context, name, **defined)
        elif key not in self._programs:
            self._programs[key] = program(self.context, name.partition("_")[0], name, **defined)
        shader = self._programs[key]
        box = interval.box
        give(
            shader,
            **uniforms,
            **self._scalar,
            slopes=velocity_weights(interval, layer),
            weights=bernstein(interval.degree, layer.parameter),
            blend=layer.blend,
            turned=layer.parameter,
            opacity=layer.alpha,
            box_low=(0.0, 0.0, 0.0) if box is None else box.low,
            box_step=(1.0, 1.0, 1.0) if box is None else tuple(box.step),
            palette=self.palette,
            ramp=self.ramp,
        )
        return shader


def velocity_weights(interval: Interval, layer: Layer) -> NDArray[np.float64]:
    """(degree + 1,) weights of the Bézier points in a mover's velocity."""
    n = interval.degree
    lower = bernstein(n - 1, layer.parameter)
    rate = 2.0 * layer.blend if layer.group.motion is Motion.FALL else 1.0  # falling: u = share²
    passed = np.inf if layer.litter else interval.end - interval.start
    return n * rate / passed * (np.append(0.0, lower) - np.append(lower, 0.0))
