"""Errors of the graphics driver as exceptions whose messages users can act on.

OpenGL continues after an error without drawing, so errors have to be queried.
"""

import math

import moderngl

from player.errors import PlayerError
from player.gl.context import total_gpu_memory

BYTES_PER_SAMPLE = 78  # GPU memory that one sample of a picture takes in all framebuffers


class OutOfGpuMemory(PlayerError):
    """Raised if the GPU's memory is full; fewer points or a smaller picture may fit."""


class ContextLost(PlayerError):
    """Raised if the driver was reset: all objects on the GPU are lost with their context."""


def check_context(context: moderngl.Context) -> None:
    """Raise OutOfGpuMemory or ContextLost for an OpenGL error since the last call.

    Invalid calls are bugs of the player, and raise RuntimeError.
    """
    error = context.error
    if error == "GL_NO_ERROR":
        return
    if error == "GL_OUT_OF_MEMORY":
        raise OutOfGpuMemory(
            "the GPU has not enough memory left; close other programs, or ask for a smaller --size."
        )
    if error == "GL_CONTEXT_LOST":
        raise ContextLost("the graphics driver was reset and lost the picture; try again.")
    raise RuntimeError(f"OpenGL reports {error}")


def max_supersample(context: moderngl.Context, size: tuple[int, int], requested: int) -> int:
    """The samples along each side of a pixel that the GPU can hold, from 1 to `requested`.

    size: (width, height) of the picture in pixels.
    Raises PlayerError if the picture is too large even with one sample per pixel.
    """
    names = ("GL_MAX_TEXTURE_SIZE", "GL_MAX_RENDERBUFFER_SIZE")
    longest = min(*(context.info[name] for name in names), *context.info["GL_MAX_VIEWPORT_DIMS"])
    if max(size) > longest:
        raise PlayerError(
            f"a picture of {size[0]}x{size[1]} is asked for; this graphics driver draws at most "
            f"{longest} pixels a side."
        )
    available, needed = total_gpu_memory(context), BYTES_PER_SAMPLE * size[0] * size[1]
    if needed > available:
        raise PlayerError(
            f"a picture of {size[0]}x{size[1]} takes {needed / 1e9:.1f} GB of the GPU's memory; "
            f"there are {available / 1e9:.1f} GB."
        )
    limit = min(longest // max(size), math.isqrt(int(available / needed)))
    return max(min(requested, limit), 1)
