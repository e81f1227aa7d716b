"""Includes and definitions are put in, and no source refers to a file that is missing."""

from __future__ import annotations

import re
from importlib.resources import files

import pytest

import shaders
from player.export.web.page import SHADERS

STAGES = (".vert", ".frag", ".comp")
TOP = sorted(e.name for e in files(shaders).iterdir() if e.name.endswith(STAGES))


@pytest.mark.parametrize("name", TOP)
def test_every_include_is_resolved(name: str) -> None:
    text = shaders.source(name)
    assert "#include" not in text
    assert text.count("#version") == 1


def test_definitions_follow_the_version() -> None:
    _, _, after = shaders.source("points.vert", SECOND=2, FIRST=1).partition("#version")
    assert after.splitlines()[1:3] == ["#define FIRST 1", "#define SECOND 2"]


def test_constants_of_the_code_are_macros_of_shaders() -> None:
    for text in (shaders.source("fill_holes.frag"), shaders.resolved("splat.vert")):
        assert f"#define CORE {shaders.CORE}\n" in text
        assert text.count("CORE = ") == 0, "it would be a second home"


def test_the_page_interpolates_with_the_windows_shader() -> None:
    curve = shaders.with_includes('#include "interpolate.glsl"\n')
    for name in SHADERS:
        text = shaders.resolved(name)
        assert not re.search(r"^#(include|version)", text, re.MULTILINE)
        assert (curve in text) == (name.endswith(".vert") and name != "fullscreen.vert")
    assert curve in shaders.source("points.vert")
    assert curve in shaders.source("points.comp")
