"""Compilation of shaders, setting of uniforms, and full-screen passes."""

import itertools
from contextlib import nullcontext
from typing import Any, cast

import moderngl
import numpy as np

from player.errors import PlayerError
from player.gl.timers import PassTimers
from shaders import source


def compile_program(context: moderngl.Context, *files: str, **definitions: int | float) -> Any:
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
        if isinstance(value, np.ndarray):
            uniform.write(np.ascontiguousarray(value.T, np.float32).tobytes())
        elif isinstance(value, moderngl.Texture):
            unit = next(units)
            value.use(unit)
            uniform.value = unit
        else:
            uniform.value = value


Box = tuple[int, int, int, int]  # left and bottom edge, width and height
NO_TILES: Box = (0, 0, 0, 0)


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

    def run(
        self, name: str, tiles: Any = None, region: Box = NO_TILES, tile_px: int = 0, **values: Any
    ) -> None:
        """Run ``<name>.frag`` for every pixel of the current viewport.

        tiles:   texture of one texel for each tile of the picture; tiles with a 0 are skipped.
        region:  the part of the picture, in tiles, outside which they are skipped, too.
        tile_px: side of a tile in pixels of the framebuffer.
        values:  uniforms, and macros in upper case.
        """
        macros = self._definitions | {key: values.pop(key) for key in [*values] if key.isupper()}
        key = (name, *macros.items())
        if key not in self._arrays:
            files = ("tile.vert" if tiles else "fullscreen.vert", f"{name}.frag")
            program = compile_program(self._context, *files, **macros)
            self._arrays[key] = self._context.vertex_array(program, [])
        array = self._arrays[key]
        set_uniforms(array.program, **values, occupied=tiles, tile_px=tile_px, region=region)
        mode, vertices = moderngl.TRIANGLES, 3
        if tiles:
            mode, vertices = moderngl.POINTS, region[2] * region[3]
            left, bottom, width, height = (tile_px * side for side in region)
            self._context.viewport = left, bottom, width, height
        with nullcontext() if self._timers is None else self._timers.timed(name):
            array.render(mode, vertices=vertices)
