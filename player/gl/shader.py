"""Compile shaders, set their uniforms, and run passes over the whole picture."""

import itertools
from contextlib import nullcontext
from typing import Any, cast

import moderngl
import numpy as np

from player.errors import PlayerError
from player.gl.timers import PassTimers
from shaders import source


def program(context: moderngl.Context, *files: str, **definitions: int | float) -> Any:
    """Compile a vertex and a fragment shader, or a compute shader, which needs OpenGL 4.3.

    Raises PlayerError where the driver can't.
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


def give(program: moderngl.Program | moderngl.ComputeShader, **values: Any) -> None:
    """Set uniforms, except those that the compiler removed as unused.

    Textures are given together: each is bound to a texture unit of its own.
    Matrices are numpy arrays that multiply columns (M @ column); OpenGL stores them by column.
    """
    units = itertools.count()
    for name, value in values.items():
        if name not in program:
            continue
        uniform = cast(moderngl.Uniform, program[name])
        if isinstance(value, np.ndarray):
            uniform.write(np.ascontiguousarray(value.T, np.float32).tobytes())
        elif isinstance(value, moderngl.Texture):
            unit = next(units)
            value.use(unit)
            uniform.value = unit
        else:
            uniform.value = value


class Passes:
    """Runs fragment shaders over the current framebuffer, each compiled on first use.

    timers:      measure the passes, if given.
    definitions: preprocessor definitions for all of the shaders.
    """

    def __init__(
        self, context: moderngl.Context, timers: PassTimers | None = None, **definitions: int
    ) -> None:
        self._context = context
        self._timers = timers
        self._definitions = definitions
        self._arrays: dict[tuple[str, int], moderngl.VertexArray] = {}

    def fill(
        self,
        name: str,
        *,
        reach: int = 0,
        tiles: moderngl.Texture | None = None,
        **uniforms: Any,
    ) -> None:
        """Run `<name>.frag` for every pixel.

        reach: how many pixels around its own the shader reads; a compile-time constant.
        tiles: a texel for each tile of the picture; those with a 0 are left out (tile.vert).
        """
        if (name, reach) not in self._arrays:
            vertex = "tile" if tiles else "fullscreen"
            files, definitions = (f"{vertex}.vert", f"{name}.frag"), self._definitions
            compiled = program(self._context, *files, REACH=reach, **definitions)
            self._arrays[name, reach] = self._context.vertex_array(compiled, [])
        array = self._arrays[name, reach]
        give(array.program, **uniforms, occupied=tiles)
        vertices = 6 * tiles.width * tiles.height if tiles else 3
        with nullcontext() if self._timers is None else self._timers.timed(name):
            array.render(moderngl.TRIANGLES, vertices=vertices)
