"""Points' positions as the GPU computes them, read back from shaders with the player's includes."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import Any

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from gclip import Clip
from gclip.evaluate import layers_at
from player.rendering.point_buffers import full_ranges
from player.rendering.point_cloud import POINTS_PER_INVOCATION, WORKGROUP, PointCloud
from shaders import with_header, with_includes


def gpu_positions(
    context: moderngl.Context,
    clip: Clip,
    day: float,
    *,
    computed: bool = False,
    stride: int = 1,
    memory: int | None = None,
) -> NDArray[np.float32]:
    """(N, 3) positions about the clip's origin, layer by layer in the order of `layers_at`.

    computed: from the compute shaders' interpolation; else by transform feedback from the vertex
              shaders'.
    """
    if computed and context.version_code < 430:
        pytest.skip("compute shaders need OpenGL 4.3")
    screen = context.simple_framebuffer((16, 16))
    screen.use()  # nothing is drawn, yet OpenGL wants a framebuffer
    points, parts = PointCloud(context, clip, memory), [np.zeros((0, 3), np.float32)]
    given = {"COMPUTED": 1} if computed else {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("player.rendering.point_cloud.compile_program", _program)
        ranges = full_ranges(layers_at(clip, day), stride)
        for shader, _, buffers, count in points._chunks("positions", ranges, {}, **given):
            some = -(-count // stride)
            result = context.buffer(reserve=12 * max(some, 1))
            if computed:
                buffers.bind()
                result.bind_to_storage_buffer(7)
                shader.run(-(-count // (POINTS_PER_INVOCATION * WORKGROUP)))
                context.memory_barrier()
            else:
                array = buffers.array(shader, points._strided_indices(stride))
                array.transform(result, vertices=some)
            parts.append(np.frombuffer(result.read(12 * some), np.float32).reshape(-1, 3))
    return np.concatenate(parts)


def _program(context: moderngl.Context, file: str, *_: str, **definitions: int) -> Any:
    text = files(__package__).joinpath(f"shaders/{file}").read_text("utf-8")
    source = with_header(with_includes(text), Path(file).suffix, **definitions)
    if file.endswith(".comp"):
        return context.compute_shader(source)
    return context.program(vertex_shader=source, varyings=("out_position",))
