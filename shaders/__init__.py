"""The GLSL sources of the renderer, and in `web` those of the HTML export.

A source includes another one with ``#include "name.glsl"``, relative to its own folder as in C.
"""

from __future__ import annotations

import posixpath
import re
from importlib.resources import files

_INCLUDE = re.compile(r'^#include "([a-z_./]+\.glsl)"$', re.MULTILINE)
_VERSION = re.compile(r"^#version .*$", re.MULTILINE)


def source(name: str, **definitions: int | float) -> str:
    """Read a shader and resolve its includes.

    Parameters
    ----------
    name : str
        Path below this package, such as ``"shade.frag"`` or ``"web/splat.vert"``.
    **definitions : int or float
        Written as ``#define NAME VALUE`` below the ``#version`` line.

    Returns
    -------
    str
        The text that a driver compiles.
    """
    folder = posixpath.dirname(name)
    text = _INCLUDE.sub(
        lambda found: source(posixpath.normpath(posixpath.join(folder, found[1]))),
        files(__name__).joinpath(name).read_text("utf-8"),
    )
    lines = "".join(f"\n#define {key} {value}" for key, value in sorted(definitions.items()))
    return _VERSION.sub(lambda found: found[0] + lines, text, count=1)


def web_sources() -> dict[str, str]:
    """The shaders of the HTML export by file name, in alphabetical order."""
    names = sorted(entry.name for entry in files(__name__).joinpath("web").iterdir())
    return {name: source(f"web/{name}") for name in names if not name.endswith(".glsl")}
