"""What a graphics driver reports when it fails, and what becomes of that: one sentence.

OpenGL goes on after an error and draws nothing, so somebody has to ask.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import moderngl

from player.errors import PlayerError
from player.gl.gpu_memory import total

SAMPLE = 78  # bytes of the GPU that one sample of a picture takes


class OutOfGpuMemory(PlayerError):
    """There may be room for less: fewer movers at a time, a coarser picture."""


class ContextLost(PlayerError):
    """The driver was reset: all that was on the GPU is gone, and a new context is needed."""


def check_context(context: moderngl.Context) -> None:
    """Raise a PlayerError for what went wrong on the GPU since the last look.

    What OpenGL calls invalid is a fault of our own: a RuntimeError.
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
    """Around the making of textures and framebuffers of a size: the driver may refuse them.

    Raises OutOfGpuMemory then.
    """
    try:
        yield
    except moderngl.Error:
        raise OutOfGpuMemory(
            f"this graphics driver has no room for a picture of {size[0]}x{size[1]}; "
            "ask for a smaller --size."
        ) from None


def samples_within(context: moderngl.Context, size: tuple[int, int], wished: int) -> int:
    """How many samples along each side of a pixel a picture may have here: `wished`, or fewer.

    Raises PlayerError for a picture that is too large even with one.
    """
    info = context.info
    longest = min(
        *(info[f"GL_MAX_{what}_SIZE"] for what in ("TEXTURE", "RENDERBUFFER")),
        *info["GL_MAX_VIEWPORT_DIMS"],
    )
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
    fitting = (n for n in range(wished, 0, -1) if n * max(size) <= longest)
    return next((n for n in fitting if n * n * needed <= there), 1)
