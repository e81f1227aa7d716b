"""Errors of the graphics driver, each reported in one sentence.

OpenGL continues after an error without drawing, so errors have to be queried.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager

import moderngl

from player.errors import PlayerError
from player.gl.gpu_memory import total

SAMPLE = 78  # bytes of GPU memory for one sample of a picture


class OutOfGpuMemory(PlayerError):
    """The GPU's memory is full; fewer points at a time or a smaller picture may still fit."""


class ContextLost(PlayerError):
    """The driver was reset: everything on the GPU is lost, and a new context is needed."""


def check_context(context: moderngl.Context) -> None:
    """Raise PlayerError for an error on the GPU since the last call.

    Invalid calls are bugs of the player and raise RuntimeError.
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


@contextmanager
def pictures_of(size: tuple[int, int]) -> Iterator[None]:
    """Raise OutOfGpuMemory where the driver refuses textures or framebuffers of a size."""
    try:
        yield
    except moderngl.Error:
        raise OutOfGpuMemory(
            f"this graphics driver has no room for a picture of {size[0]}x{size[1]}; "
            "ask for a smaller --size."
        ) from None


def samples_within(context: moderngl.Context, size: tuple[int, int], wished: int) -> int:
    """The number of samples per pixel and direction that this GPU can hold, at most `wished`.

    Raises PlayerError for a picture that is too large even with one sample a pixel.
    """
    names = ("GL_MAX_TEXTURE_SIZE", "GL_MAX_RENDERBUFFER_SIZE")
    longest = min(*(context.info[name] for name in names), *context.info["GL_MAX_VIEWPORT_DIMS"])
    if max(size) > longest:
        raise PlayerError(
            f"a picture of {size[0]}x{size[1]} is asked for; this graphics driver draws at most "
            f"{longest} pixels a side."
        )
    there, needed = total(context), SAMPLE * size[0] * size[1]
    if needed > there:
        raise PlayerError(
            f"a picture of {size[0]}x{size[1]} takes {needed / 1e9:.1f} GB of the GPU's memory; "
            f"there are {there / 1e9:.1f} GB."
        )
    most = min(longest // max(size), math.isqrt(int(there / needed)))
    return max(min(wished, most), 1)
