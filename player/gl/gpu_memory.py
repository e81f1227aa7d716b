"""How much memory the GPU has for points."""

import ctypes
import os

import moderngl

SHARE = 0.6  # of the GPU's memory; the rest is left to pictures and to other programs
LEAST = 256 << 20
# What drivers report in KiB: GL_GPU_MEMORY_INFO_TOTAL_AVAILABLE_MEMORY_NVX, GL_VBO_FREE_MEMORY_ATI.
REPORTED = {"GL_NVX_gpu_memory_info": 0x9048, "GL_ATI_meminfo": 0x87FC}


def room(context: moderngl.Context) -> int:
    """Bytes available for points."""
    return max(int(SHARE * total(context)), LEAST)


def total(context: moderngl.Context) -> int:
    """The GPU's memory in bytes; half of the main memory where the driver does not report it."""
    for extension, name in REPORTED.items():
        if extension in context.extensions and (kib := _integer(context, name)) > 0:
            return kib * 1024
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
    except (AttributeError, ValueError, OSError):
        return 4 << 30


def _integer(context: moderngl.Context, name: int) -> int:
    """Call glGetIntegerv, which moderngl does not expose; 0 where it is not available."""
    try:
        address = context.mglo._context.load_opengl_function("glGetIntegerv")
    except AttributeError:
        return 0
    values = (ctypes.c_int * 4)()
    ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.POINTER(ctypes.c_int))(address)(name, values)
    return values[0]
