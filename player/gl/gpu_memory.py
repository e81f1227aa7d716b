"""The size of the GPU's memory."""

import ctypes
import os
from contextlib import suppress

import moderngl

# Extensions, and the parameters by which they report memory in KiB:
# GL_GPU_MEMORY_INFO_TOTAL_AVAILABLE_MEMORY_NVX and GL_VBO_FREE_MEMORY_ATI.
MEMORY_QUERIES = {"GL_NVX_gpu_memory_info": 0x9048, "GL_ATI_meminfo": 0x87FC}


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
