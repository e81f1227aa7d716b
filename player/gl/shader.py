"""Compilation of shaders, setting of uniforms, and full-screen passes."""

import itertools
from contextlib import nullcontext
from typing import Any, NamedTuple, cast

import moderngl
import numpy as np

from player.errors import PlayerError
from player.gl.timers import PassTimers
from shaders import source


def compile_program(
    context: moderngl.Context, *files: str, **definitions: int | float | str
) -> Any:
    """Compile a vertex and a fragment shader, or a compute shader, which needs OpenGL 4.3.

    files:       one or two files of the package `shaders`.
    definitions: preprocessor macros.
    Raises PlayerError if the driver cannot compile the shaders.
    """
    sources = [source(file, **definitions) for file in files]
    try:
        if len(sources) == 1:
            return context.compute_shader(*sources)
        vertex, fragment = sources
        return context.program(vertex_shader=vertex, fragment_shader=fragment)
    except moderngl.Error as error:
        lines = [line.strip() for line in str(error).splitlines() if line.strip(" =-")]
        reason = " ".join(lines[:4])[:200]
        raise PlayerError(
            f"this graphics driver can't compile the shader {files[-1]} ({reason}); "
            "install a newer one, or set LIBGL_ALWAYS_SOFTWARE=1 to do without it."
        ) from None


def set_uniforms(program: moderngl.Program | moderngl.ComputeShader, **values: Any) -> None:
    """Set uniforms, except those that the compiler removed as unused.

    Textures are bound to units counted from 0, so that one call must set all textures of a program.
    Arrays are matrices for column vectors; they are transposed to OpenGL's column-major order.
    """
    units = itertools.count()
    for name, value in values.items():
        if (uniform := cast(moderngl.Uniform | None, program.get(name, None))) is None:
            continue
        if isinstance(value, moderngl.Texture):
            value.use(unit := next(units))
            value = unit
        if isinstance(value, np.ndarray):
            uniform.write(np.ascontiguousarray(value.T, np.float32).tobytes())
        elif value != uniform.extra:  # what it was set to before
            uniform.value = uniform.extra = value


Rectangle = tuple[int, int, int, int]  # left and bottom edge, width and height


class Tiles(NamedTuple):
    """The tiles of a picture in which a shader runs."""

    occupied: moderngl.Texture  #: one texel for each tile; tiles with a 0 are skipped (tile.vert)
    region: Rectangle  #: part of the picture, in tiles, outside which they are skipped, too
    tile_px: int  #: side of a tile in pixels of the framebuffer


class Passes:
    """Runs fragment shaders over the current framebuffer, and compiles each on first use.

    timers:      measures the passes, optional.
    definitions: preprocessor macros of all shaders.
    """

    def __init__(
        self, context: moderngl.Context, timers: PassTimers | None = None, **definitions: int
    ) -> None:
        self._context = context
        self._timers = timers
        self._definitions = definitions
        self._arrays: dict[tuple[Any, ...], moderngl.VertexArray] = {}

    def run(self, name: str, tiles: Tiles | None = None, **values: Any) -> None:
        """Run ``<name>.frag`` for every pixel of the current viewport, or of some tiles.

        values: uniforms, and macros in upper case.
        """
        macros = self._definitions | {key: values.pop(key) for key in [*values] if key.isupper()}
        key = (name, *macros.items())
        if key not in self._arrays:
            files = ("tile.vert" if tiles else "fullscreen.vert", f"{name}.frag")
            program = compile_program(self._context, *files, **macros)
            self._arrays[key] = self._context.vertex_array(program, [])
        array = self._arrays[key]
        set_uniforms(array.program, **values, **(tiles._asdict() if tiles else {}))
        mode, vertices = moderngl.TRIANGLES, 3
        if tiles:
            left, bottom, width, height = (tiles.tile_px * side for side in tiles.region)
            mode, vertices = moderngl.POINTS, tiles.region[2] * tiles.region[3]
            self._context.viewport = left, bottom, width, height
        with nullcontext() if self._timers is None else self._timers.timed(name):
            array.render(mode, vertices=vertices)
