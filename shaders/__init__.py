"""GLSL sources of the renderer, for the window, exports and the web page.

The sources are valid for OpenGL 3.3 (compute shaders: 4.3) and for WebGL 2, and contain no version.
A source includes another one by ``#include "name.glsl"``; each is included at most once. What
``#include "effects.glsl"`` stands for is generated, and depends on the source.
"""

import re
from importlib.resources import files
from pathlib import PurePosixPath

from shaders.effects import effects_of

# Constants that the code around the shaders shares with them; shaders have them as macros.
NOTHING = 1e4  # relative depth of samples without a surface
MAX_TRACKS = 1024  # that a point's code tells apart (nearest_point.glsl)
CORE = 0.7  # up to this distance from its centre, in its radii, a splat occludes what lies behind
GREY = 0.07441, 0.25032, 0.02527  # of linear light: 35 % of its luminance (IEC 61966-2-1)

_CONSTANTS = f"""#define NOTHING {NOTHING}
#define MAX_TRACKS {MAX_TRACKS}u
#define CORE {CORE}
#define GREY vec3{GREY}
"""
_INCLUDE = re.compile(r'^#include "([a-z_/]+\.glsl)"\n', re.MULTILINE)
_HEADERS = {
    ".vert": "#version 330 core\n",
    ".frag": "#version 330 core\n",
    ".comp": "#version 430\n",
}


def source(name: str, **definitions: int | float | str) -> str:
    """Read a shader for OpenGL, with its includes.

    Parameters
    ----------
    name : str
        Name of a file in this package, such as ``"points.vert"``.
    **definitions : int, float or str
        Macros, written as ``#define NAME VALUE`` below the ``#version`` line.

    Returns
    -------
    str
        Source for the driver's compiler.
    """
    return with_header(resolved(name), PurePosixPath(name).suffix, **definitions)


def with_header(text: str, suffix: str, **definitions: int | float | str) -> str:
    """Add version and macros for OpenGL to a shader; suffix: ".vert", ".frag" or ".comp"."""
    lines = "".join(f"#define {key} {value}\n" for key, value in sorted(definitions.items()))
    return _HEADERS[suffix] + lines + text


def resolved(name: str) -> str:
    """Read a shader with constants and includes, without a version; web pages add WebGL's."""
    text = files(__name__).joinpath(name).read_text("utf-8")
    return _CONSTANTS + with_includes(text.replace('#include "effects.glsl"\n', effects_of(name)))


def with_includes(text: str) -> str:
    """Replace ``#include`` lines of a text by files of this package."""
    included = set()

    def include(found: re.Match[str]) -> str:
        if found[1] in included:
            return ""
        included.add(found[1])
        return _INCLUDE.sub(include, files(__name__).joinpath(found[1]).read_text("utf-8"))

    return _INCLUDE.sub(include, text)
