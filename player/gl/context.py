"""The one place that makes OpenGL contexts."""

from itertools import product
from typing import Any

import moderngl

from gclip.terminal.interrupts import uninterrupted
from player.errors import PlayerError

# Many drivers give exactly the version that is asked for: the newest comes first. From 4.3 on there
# are compute shaders; 3.3 is what every machine since 2010, and Mesa without a GPU, can do.
VERSIONS = (460, 450, 430, 330)
MAX_DEVICES = 16  # of EGL that are tried: GPUs, and the software renderer after them


def headless() -> moderngl.Context:
    """A context without a screen, through EGL, on the first device that offers OpenGL 3.3.

    EGL lists GPUs first, and Mesa's software renderer last: where no GPU can be used, it draws.
    The context has no default framebuffer: draw into one of your own.

    Returns
    -------
    moderngl.Context
        Of the newest of VERSIONS that the device offers.

    Raises
    ------
    PlayerError
        Naming the system packages to install where EGL is missing.
    """
    reason = ""
    for device, version in product(range(MAX_DEVICES), VERSIONS):
        settings: dict[str, Any] = {"backend": "egl", "device_index": device, "require": version}
        try:
            return uninterrupted(moderngl.create_context, standalone=True, **settings)
        except Exception as error:
            reason = reason or _reason(error)
    raise PlayerError(
        "OpenGL can't be started without a screen "
        f"({reason}); on Debian or Ubuntu: apt-get install libegl1 libgl1."
    )


def from_window() -> moderngl.Context:
    """The context of the window that is current on this thread (made with `glfw`).

    Raises PlayerError where the window offers less than OpenGL 3.3.
    """
    try:
        return uninterrupted(moderngl.create_context, require=VERSIONS[-1])
    except Exception as error:
        raise PlayerError(
            f"the window offers no OpenGL 3.3 ({_reason(error)}); "
            "`play CLIP --export film.mp4` needs no window."
        ) from None


def _reason(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[0].rstrip(".") if lines else type(error).__name__
