"""OpenGL contexts, with and without a window, and the memory of their GPU."""

import ctypes
import os
from contextlib import suppress
from itertools import product
from typing import Any

import moderngl

from player.errors import PlayerError

# Many drivers return exactly the version that is requested, so the newest is requested first.
# OpenGL 4.3 adds compute shaders; 3.3 runs on every GPU since 2010 and on Mesa without a GPU.
VERSIONS = (460, 450, 430, 330)
MAX_DEVICES = 16  # number of EGL devices that are tried
# Extensions, and the parameters by which they report memory in KiB:
# GL_GPU_MEMORY_INFO_TOTAL_AVAILABLE_MEMORY_NVX and GL_VBO_FREE_MEMORY_ATI.
MEMORY_QUERIES = {"GL_NVX_gpu_memory_info": 0x9048, "GL_ATI_meminfo": 0x87FC}


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


def total_gpu_memory(context: moderngl.Context) -> int:
    """The GPU's memory in bytes; half of the main memory if the driver does not report it."""
    with suppress(AttributeError):  # moderngl's access to glGetIntegerv is not public
        address = context.mglo._context.load_opengl_function("glGetIntegerv")
        get_integers = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.POINTER(ctypes.c_int))(address)
        kib = (ctypes.c_int * 4)()
        for extension, parameter in MEMORY_QUERIES.items():
            if extension in context.extensions:
                get_integers(parameter, kib)
        if kib[0] > 0:
            return kib[0] * 1024
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
    except (AttributeError, ValueError, OSError):
        return 4 << 30


def _created(**settings: Any) -> moderngl.Context:
    """Create a context whose method `gc` frees objects without references in Python."""
    context = moderngl.create_context(**settings)
    context.gc_mode = "context_gc"
    return context


def _reason(error: Exception) -> str:
    return str(error).strip().partition("\n")[0].rstrip(".") or type(error).__name__
