"""Passes over the picture: one triangle, a fragment shader, and nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from player.gl.shader import give, program

if TYPE_CHECKING:
    import moderngl


class Passes:
    """Fragment shaders over the framebuffer in use, each compiled when it is first needed.

    definitions: for all of them.
    """

    def __init__(self, context: moderngl.Context, **definitions: int | float) -> None:
        self._context = context
        self._definitions = definitions
        self._arrays: dict[tuple[Any, ...], moderngl.VertexArray] = {}

    def fill(self, name: str, uniforms: dict[str, Any], **chosen: int | float) -> None:
        """chosen: definitions for this shader."""
        key = (name, *sorted(chosen.items()))
        if key not in self._arrays:
            defined = self._definitions | chosen
            self._arrays[key] = self._context.vertex_array(
                program(self._context, "screen", name, **defined), []
            )
        give(self._arrays[key].program, **uniforms)
        self._arrays[key].render(vertices=3)

    def release(self) -> None:
        for array in self._arrays.values():
            array.program.release()
            array.release()
