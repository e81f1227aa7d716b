"""How much memory the GPU has for points."""

import ctypes
import os

import moderngl

SHARE = 0.6  # of the GPU's memory; the rest is left to pictures and to other programs
LEAST = 256 << 20
TOTAL_NVIDIA = 0x9048  # GL_GPU_MEMORY_INFO_TOTAL_AVAILABLE_MEMORY_NVX, in KiB
FREE_AMD = 0x87FC  # GL_VBO_FREE_MEMORY_ATI, in KiB


def room(context: moderngl.Context) -> int:
    """Bytes available for points."""
    return max(int(SHARE * total(context)), LEAST)


def total(context: moderngl.Context) -> int:
    """The GPU's memory in bytes; half of the main memory where the driver does not report it."""
    told = 0
    if "GL_NVX_gpu_memory_info" in context.extensions:
        told = _integer(context, TOTAL_NVIDIA)
    elif "GL_ATI_meminfo" in context.extensions:
        told = _integer(context, FREE_AMD)
    return told * 1024 if told > 0 else _own_memory() // 2


def _integer(context: moderngl.Context, name: int) -> int:
    """Call glGetIntegerv, which moderngl does not expose; 0 where it is not available."""
    try:
        address = context.mglo._context.load_opengl_function("glGetIntegerv")
    except AttributeError:
        return 0
    values = (ctypes.c_int * 4)()
    ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.POINTER(ctypes.c_int))(address)(name, values)
    return values[0]


def _own_memory() -> int:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 8 << 30
