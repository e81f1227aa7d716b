"""The GLSL sources of the renderer, in window, films and the web page.

One family, for OpenGL 3.3 (in compute shaders 4.3) and for WebGL 2: no source says its version.
A source includes another one with ``#include "name.glsl"``, and each only once.
"""

import re
from importlib.resources import files
from pathlib import PurePosixPath

_INCLUDE = re.compile(r'^#include "([a-z_]+\.glsl)"\n', re.MULTILINE)
_HEADERS = {
    ".vert": "#version 330 core\n",
    ".frag": "#version 330 core\n",
    ".comp": "#version 430\n",
}


def source(name: str, **definitions: int | float) -> str:
    """Read a shader for OpenGL.

    Parameters
    ----------
    name : str
        File in this package, such as ``"points.vert"``.
    **definitions : int or float
        Written as ``#define NAME VALUE`` below the ``#version`` line.

    Returns
    -------
    str
        The text that a driver compiles.
    """
    return with_header(resolved(name), PurePosixPath(name).suffix, **definitions)


def with_header(text: str, suffix: str, **definitions: int | float) -> str:
    """A resolved shader for OpenGL; suffix: ".vert", ".frag" or ".comp"."""
    lines = "".join(f"#define {key} {value}\n" for key, value in sorted(definitions.items()))
    return _HEADERS[suffix] + lines + text


def resolved(name: str) -> str:
    """A shader with its includes: WebGL's page puts version, precision and definitions before."""
    return with_includes(files(__name__).joinpath(name).read_text("utf-8"))


def with_includes(text: str) -> str:
    """A text with its includes, which are named as they are in this package."""
    included = set()

    def include(found: re.Match[str]) -> str:
        if found[1] in included:
            return ""
        included.add(found[1])
        return _INCLUDE.sub(include, files(__name__).joinpath(found[1]).read_text("utf-8"))

    return _INCLUDE.sub(include, text)
