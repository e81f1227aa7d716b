"""Loading shaders: package data, with includes and definitions put in."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from player.errors import PlayerError

if TYPE_CHECKING:
    import moderngl

INCLUDE = re.compile(r'^#include "([a-z_]+\.glsl)"$', re.MULTILINE)
VERSION = re.compile(r"^#version .*$", re.MULTILINE)


def source(name: str, **definitions: int | float) -> str:
    """The text of `player/shaders/<name>`, includes resolved, each definition as a `#define`."""
    text = _read(name)
    while INCLUDE.search(text):
        text = INCLUDE.sub(lambda found: _read(found[1]), text)
    lines = "".join(f"\n#define {key} {value}" for key, value in sorted(definitions.items()))
    return VERSION.sub(lambda found: found[0] + lines, text, count=1)


def program(
    context: moderngl.Context, vertex: str, fragment: str, **definitions: int | float
) -> moderngl.Program:
    """Compile `<vertex>.vert` and `<fragment>.frag`. Raises PlayerError as `compute` does."""
    with _compiling(f"{vertex}, {fragment}"):
        return context.program(
            vertex_shader=source(f"{vertex}.vert", **definitions),
            fragment_shader=source(f"{fragment}.frag", **definitions),
        )


def feedback(
    context: moderngl.Context, vertex: str, *varyings: str, **definitions: int | float
) -> moderngl.Program:
    """Compile `<vertex>.vert` alone, to write `varyings` into a buffer, one after the other."""
    return context.program(vertex_shader=source(f"{vertex}.vert", **definitions), varyings=varyings)


def compute(
    context: moderngl.Context, name: str, **definitions: int | float
) -> moderngl.ComputeShader:
    """Compile `<name>.comp`; needs OpenGL 4.3. Raises PlayerError where the driver can't."""
    with _compiling(name):
        return context.compute_shader(source(f"{name}.comp", **definitions))


@contextmanager
def _compiling(name: str) -> Iterator[None]:
    import moderngl

    try:
        yield
    except moderngl.Error as error:
        lines = [line.strip() for line in str(error).splitlines() if line.strip(" =-")]
        raise PlayerError(
            f"this graphics driver can't compile the shader {name} ({' '.join(lines[:4])[:200]}); "
            "install a newer one, or set LIBGL_ALWAYS_SOFTWARE=1 to do without it."
        ) from None


def give(program: moderngl.Program | moderngl.ComputeShader, **values: Any) -> None:
    """Set uniforms; those that the compiler found unused are left out.

    Matrices come as numpy arrays for columns (M @ column) and go out in OpenGL's column order.
    """
    import numpy as np

    for name, value in values.items():
        if name not in program:
            continue
        if isinstance(value, np.ndarray):
            program[name].write(np.ascontiguousarray(value.T, np.float32).tobytes())  # type: ignore[union-attr]
        else:
            program[name].value = value  # type: ignore[union-attr]


def _read(name: str) -> str:
    return (files("player") / "shaders" / name).read_text("utf-8")
