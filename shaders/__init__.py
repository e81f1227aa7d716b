"""The GLSL sources of the renderer, in window, films and the web page.

One family, for OpenGL 3.3 (in compute shaders 4.3) and for WebGL 2: no source says its version.
A source includes another one with ``#include "name.glsl"``, relative to its own folder as in C, and
each only once.
"""

import posixpath
import re
from importlib.resources import files

_INCLUDE = re.compile(r'^#include "([a-z_./]+\.glsl)"\n', re.MULTILINE)
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
        Path below this package, such as ``"points.vert"``.
    **definitions : int or float
        Written as ``#define NAME VALUE`` below the ``#version`` line.

    Returns
    -------
    str
        The text that a driver compiles.
    """
    return with_header(resolved(name), posixpath.splitext(name)[1], **definitions)


def with_header(text: str, suffix: str, **definitions: int | float) -> str:
    """A resolved shader for OpenGL; suffix: ".vert", ".frag" or ".comp"."""
    lines = "".join(f"#define {key} {value}\n" for key, value in sorted(definitions.items()))
    return _HEADERS[suffix] + lines + text


def resolved(name: str) -> str:
    """A shader with its includes: WebGL's page puts version, precision and definitions before."""
    return with_includes(files(__name__).joinpath(name).read_text("utf-8"), posixpath.dirname(name))


def with_includes(text: str, folder: str = "", included: set[str] | None = None) -> str:
    """A text with its includes; folder: below this package, that their names are relative to."""
    done = set() if included is None else included

    def include(found: re.Match[str]) -> str:
        path = posixpath.normpath(posixpath.join(folder, found[1]))
        if path in done:
            return ""
        done.add(path)
        source = files(__name__).joinpath(path).read_text("utf-8")
        return with_includes(source, posixpath.dirname(path), done)

    return _INCLUDE.sub(include, text)
