"""The one place that makes OpenGL contexts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from player.errors import PlayerError

if TYPE_CHECKING:
    import moderngl

REQUIRED = 330  # OpenGL 3.3 core: what every machine since 2010, and Mesa without a GPU, can do


def headless() -> moderngl.Context:
    """A context without a screen, through EGL.

    It has no default framebuffer: draw into one of your own. Raises PlayerError naming the system
    packages to install where EGL is missing.
    """
    import moderngl

    settings: dict[str, Any] = {"backend": "egl"}
    try:
        return moderngl.create_context(standalone=True, require=REQUIRED, **settings)
    except Exception as error:
        raise PlayerError(
            "OpenGL can't be started without a screen "
            f"({_reason(error)}); on Debian or Ubuntu: apt-get install libegl1 libgl1."
        ) from None


def from_window() -> moderngl.Context:
    """The context of the window that is current on this thread (made with `glfw`).

    Raises PlayerError where the window offers less than OpenGL 3.3.
    """
    import moderngl

    try:
        return moderngl.create_context(require=REQUIRED)
    except Exception as error:
        raise PlayerError(
            f"the window offers no OpenGL 3.3 ({_reason(error)}); "
            "`play CLIP --export film.mp4` needs no window."
        ) from None


def _reason(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[0].rstrip(".") if lines else type(error).__name__
