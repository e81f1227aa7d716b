"""Creation of OpenGL contexts, with and without a window."""

from itertools import product
from typing import Any

import moderngl

from player.errors import PlayerError

# Many drivers return exactly the version that is requested, so the newest is requested first.
# OpenGL 4.3 adds compute shaders; 3.3 runs on every GPU since 2010 and on Mesa without a GPU.
VERSIONS = (460, 450, 430, 330)
MAX_DEVICES = 16  # number of EGL devices that are tried


def headless() -> moderngl.Context:
    """Create a context without a screen on the first EGL device that offers OpenGL 3.3.

    EGL lists GPUs first and Mesa's software renderer last. The context has the newest of VERSIONS
    that the device offers, and no default framebuffer. Raises PlayerError, which names the system
    packages to install, if there is no such device.
    """
    reason = ""
    for device, version in product(range(MAX_DEVICES), VERSIONS):
        try:
            return _created(standalone=True, backend="egl", device_index=device, require=version)
        except Exception as error:
            reason = reason or _reason(error)
    raise PlayerError(
        "OpenGL can't be started without a screen "
        f"({reason}); on Debian or Ubuntu: apt-get install libegl1 libgl1."
    )


def from_window() -> moderngl.Context:
    """Wrap GLFW's current context; raises PlayerError if it offers less than OpenGL 3.3."""
    try:
        return _created(require=VERSIONS[-1])
    except Exception as error:
        raise PlayerError(
            f"the window offers no OpenGL 3.3 ({_reason(error)}); "
            "`play CLIP --export film.mp4` needs no window."
        ) from None


def _created(**settings: Any) -> moderngl.Context:
    """Create a context whose method `gc` frees objects without references in Python."""
    context = moderngl.create_context(**settings)
    context.gc_mode = "context_gc"
    return context


def _reason(error: Exception) -> str:
    return str(error).strip().partition("\n")[0].rstrip(".") or type(error).__name__
