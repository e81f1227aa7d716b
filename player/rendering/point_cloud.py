"""The movers of a clip on the GPU: sends portions of them through any of the movers' shaders."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gclip import Interval, Motion
from gclip.evaluate import Layer, bernstein
from player.gl.gpu_memory import room
from player.gl.shader import compute, feedback, give, program
from player.rendering.point_buffers import LENGTH, ChunkBuffers, ChunkStore, Portion
from player.view.colors import STEPS, Colors

if TYPE_CHECKING:
    import moderngl

    from gclip import Clip
    from player.view.style import Style

LOOK = {
    "CORE": 0.7,  # share of its radius in which a disc hides what lies behind
    "RIM_OUTSIDE": 0.16,  # summed weights where the plant's silhouette begins and is closed
    "RIM_INSIDE": 0.30,
}
PALETTE_WIDTH = 1024  # texels in a row of the palette
RAMP, MARKS = 6, 7  # texture units of a value's colours, and of what is hidden
CAPTURED = {"positions": ("out_position",), "discs": ("out_disc", "out_light")}
WORKGROUP = 128  # invocations of a compute shader
EACH = 4  # movers of an invocation


class Movers:
    """One clip's chunks, the tracks' palette, and a program for each shader and kind of interval.

    memory: bytes of the GPU that the movers may take up; None asks the driver.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, memory: int | None = None) -> None:
        self.context = context
        self.clip = clip
        self.store = ChunkStore(context, clip, room(context) if memory is None else memory)
        self.palette = _texture(
            context, (PALETTE_WIDTH, -(-len(clip.track_table) // PALETTE_WIDTH))
        )
        self.ramp = _texture(context, (STEPS, 1))
        self._places: dict[int, moderngl.Buffer] = {}
        self._painted: object = None
        self._look: dict[str, int] = {"VALUED": 0, "MARKED": 0}
        self._values: dict[str, object] = {}
        self._programs: dict[tuple[Any, ...], Any] = {}

    def paint(self, colors: Colors, day: float, style: Style) -> None:
        """Have all that is drawn from now on wear a style's colours of a day."""
        wanted = (day if style.color_by == "age" else None, style)
        if wanted == self._painted:
            return
        texels = np.zeros((self.palette.height * PALETTE_WIDTH, 4), np.float32)
        texels[: len(self.clip.track_table)] = colors.palette(day, style)
        self.palette.write(texels)
        self.ramp.write(colors.ramp(style))
        self._look = {"VALUED": int(colors.scalar_field(style)), "MARKED": int(style.marked)}
        self._values = colors.uniforms() if self._look["VALUED"] else {}
        self._painted = wanted

    def draw(
        self, name: str, portions: list[Portion], uniforms: dict[str, Any], fewer: int = 1
    ) -> None:
        """Draw movers as points with the shaders `name`, into the framebuffer in use.

        fewer: of so many one, beyond what the portions leave out already.
        """
        import moderngl

        for portion, buffers, count in self._batches(portions):
            shader = self._ready(name, "points", portion.layer, buffers, uniforms)
            every = portion.every * fewer
            array = buffers.array(shader, self._one_in(every))
            array.render(moderngl.POINTS, vertices=-(-count // every))

    def compute(
        self, name: str, portions: list[Portion], uniforms: dict[str, Any], **chosen: int
    ) -> None:
        """Run movers through the compute shader `name`; needs OpenGL 4.3.

        chosen: definitions in the shader.
        """
        for portion, buffers, count in self._batches(portions):
            shader = self._ready(name, "compute", portion.layer, buffers, uniforms, **chosen)
            give(shader, count=count, every=portion.every)
            buffers.bind()
            shader.run(-(-count // (EACH * WORKGROUP * portion.every)))
            self.context.memory_barrier()

    def captured(
        self, name: str, width: int, portions: list[Portion], uniforms: dict[str, Any]
    ) -> NDArray[np.float32]:
        """(N, width) what the vertex shader `name` makes of the movers, read back.

        Nothing is drawn, yet OpenGL wants a complete framebuffer in use.
        """
        parts = [np.zeros((0, width), np.float32)]
        for portion, buffers, count in self._batches(portions):
            shader = self._ready(name, "feedback", portion.layer, buffers, uniforms)
            some = -(-count // portion.every)
            result = self.context.buffer(reserve=4 * width * max(some, 1))
            array = buffers.array(shader, self._one_in(portion.every))
            array.transform(result, vertices=some)
            read = result.read(4 * width * some)
            parts.append(np.frombuffer(read, np.float32).reshape(-1, width))
            result.release()
        return np.concatenate(parts)

    def positions(self, layers: list[Layer], computed: bool = False) -> NDArray[np.float32]:
        """(N, 3) positions of the layers' movers, read back from the GPU, for tests.

        computed: from the compute shaders' interpolation; else by transform feedback from the
        vertex shaders'.
        """
        portions = [Portion(layer, layer.group.count) for layer in layers]
        if not computed:
            return self.captured("positions", 3, portions, {})
        parts = [np.zeros((0, 3), np.float32)]
        for portion, buffers, count in self._batches(portions):
            result = self.context.buffer(reserve=12 * max(count, 1))
            shader = self._ready("positions", "compute", portion.layer, buffers, {})
            give(shader, count=count)
            buffers.bind()
            result.bind_to_storage_buffer(7)
            shader.run(-(-count // (EACH * WORKGROUP)))
            self.context.memory_barrier()
            parts.append(np.frombuffer(result.read(12 * count), np.float32).reshape(-1, 3))
            result.release()
        return np.concatenate(parts)

    def _batches(self, portions: list[Portion]) -> Iterator[tuple[Portion, ChunkBuffers, int]]:
        for portion in portions:
            for chunk, count in portion.chunks():
                yield portion, self.store[chunk], count

    def _one_in(self, every: int) -> moderngl.Buffer | None:
        """The places, in any chunk, of one mover in so many.

        Vertex arrays that pass over the others would do, but their strides end at 2,048 bytes.
        """
        if every == 1:
            return None
        if every not in self._places:
            places = np.arange(0, LENGTH, every, dtype=np.uint32)
            self._places[every] = self.context.buffer(places)
        return self._places[every]

    def _ready(
        self,
        name: str,
        kind: str,
        layer: Layer,
        buffers: ChunkBuffers,
        uniforms: dict[str, Any],
        **chosen: int,
    ) -> Any:
        """A program with the uniforms of a layer."""
        interval = self.clip.intervals[layer.interval]
        shader = self._program(name, kind, layer.interval, **chosen)
        low, step = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
        if interval.box is not None:
            low, step = interval.box.low, tuple(interval.box.step)
        weights = tuple(bernstein(interval.degree, layer.parameter))
        if self._look["VALUED"]:
            self.ramp.use(RAMP)
            give(shader, **self._values, ramp=RAMP, slopes=tuple(velocity_weights(interval, layer)))
        if self._look["MARKED"]:
            self.palette.use(MARKS)
            give(shader, marks=MARKS)
        give(
            shader,
            **uniforms,
            blend=layer.blend,
            opacity=layer.alpha,
            box_low=low,
            box_step=step,
            weights=weights if len(weights) > 1 else weights[0],  # as moderngl wants it
        )
        return shader

    def _program(self, name: str, kind: str, index: int, **chosen: int) -> Any:
        interval = self.clip.intervals[index]
        defined: dict[str, int | float] = {
            "DEGREE": interval.degree,
            "SCAN_COLORS": int(interval.start_colors is not None),
            **self._look,
            **chosen,
        }
        if kind == "compute":
            defined["QUANTISED"] = int(interval.box is not None)
            defined["WIDE_TRACKS"] = int(interval.tracks.itemsize == 4)
        key = (name, kind, *sorted(defined.items()))
        if key not in self._programs:
            self._programs[key] = (
                compute(self.context, name, WORKGROUP=WORKGROUP, **defined)
                if kind == "compute"
                else feedback(self.context, name, *CAPTURED[name], **defined)
                if kind == "feedback"
                else program(self.context, name, name, **LOOK, **defined)
            )
        return self._programs[key]

    def release(self) -> None:
        self.store.release()
        for places in self._places.values():
            places.release()
        self.palette.release()
        self.ramp.release()
        for shader in self._programs.values():
            shader.release()


def velocity_weights(interval: Interval, layer: Layer) -> NDArray[np.float64]:
    """(degree + 1,) weights of the Bézier points that give a mover's way a unit of time."""
    n = interval.degree
    lower = bernstein(n - 1, layer.parameter)
    rate = 2.0 * layer.blend if layer.group.motion is Motion.FALL else 1.0  # falling: u = share²
    passed = np.inf if layer.litter else interval.end - interval.start
    return n * rate / passed * (np.append(0.0, lower) - np.append(lower, 0.0))


def _texture(context: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
    import moderngl

    texture = context.texture(size, 4, dtype="f4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture
