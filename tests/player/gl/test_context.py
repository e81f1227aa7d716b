"""Contexts are as new as the driver has them, and each draws with what it has."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import moderngl
import numpy as np
import pytest
from PIL import Image

from player.gl.context import VERSIONS, headless
from tests.player.conftest import ClipMaker
from tests.player.drawn import on_cpu
from tests.player.shown import Shown

MADE = {"3.3": 330, "4.3": 430, "4.5": 450, "4.6": 460}


def mesa(version: str) -> dict[str, str]:
    """The environment in which Mesa offers a version of OpenGL, and none above it."""
    return {**os.environ, "MESA_GL_VERSION_OVERRIDE": version}


@pytest.fixture
def needs_mesa(context: moderngl.Context) -> None:
    if not on_cpu(context):
        pytest.skip("only Mesa's software renderer can be told which versions to offer")


@pytest.mark.usefixtures("needs_mesa")
@pytest.mark.parametrize(("offered", "made"), MADE.items())
def test_the_newest_context_is_made(offered: str, made: int) -> None:
    code = "from player.gl.context import headless; print(headless().version_code)"
    done = subprocess.run([sys.executable, "-c", code], env=mesa(offered), capture_output=True)
    assert int(done.stdout) == made


def test_exactly_the_newest_is_asked_for_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drivers that give what is asked for, and no more, give it then."""
    asked = []

    def refuse(**settings: object) -> moderngl.Context:
        asked.append(settings["require"])
        raise RuntimeError("not that one")

    monkeypatch.setattr(moderngl, "create_context", refuse)
    with pytest.raises(Exception, match="not that one"):
        headless()
    assert tuple(asked[: len(VERSIONS)]) == VERSIONS == tuple(sorted(VERSIONS, reverse=True))


@pytest.mark.usefixtures("needs_mesa")
@pytest.mark.parametrize(("offered", "made"), [("3.3", "330"), ("4.6", "460")])
def test_a_window_has_the_newest_context(
    display: dict[str, str], clip_file: Path, tmp_path: Path, offered: str, made: str
) -> None:
    log = tmp_path / "version"
    before = (
        "import pathlib, moderngl, player.gl.context as c\n"
        "real = c.from_window\n"
        "def logged():\n"
        "    context = real()\n"
        f"    pathlib.Path({str(log)!r}).write_text(str(context.version_code))\n"
        "    return context\n"
        "c.from_window = logged\n"
    )
    shown = Shown(display | {"MESA_GL_VERSION_OVERRIDE": offered}, clip_file, (320, 240), before)
    shown.end()
    assert log.read_text() == made


@pytest.mark.parametrize(
    ("point_size", "computed", "differ"), [("0.3", True, 0.002), ("1", False, 0.0)]
)
def test_opengl_3_3_draws_the_pictures_of_4_5(
    make_clip: ClipMaker, tmp_path: Path, point_size: str, computed: bool, differ: float
) -> None:
    """Small points are scattered by a compute shader or, without these, drawn by OpenGL itself.

    computed: whether 4.5 runs compute shaders for it.
    differ:   the share of pixels that may: of two points equally near, either may be seen.
    """
    make_clip().save(tmp_path / "plant.gclip")
    log_compute_shaders = (
        "import sys, moderngl, player.gl.context; from player.cli import main\n"
        "player.gl.context.VERSIONS = (int(sys.argv.pop(1)),)\n"  # all that other drivers heed
        "real = moderngl.Context.compute_shader\n"
        "def logged(*given): print('computed'); return real(*given)\n"
        "moderngl.Context.compute_shader = logged\n"
        "sys.exit(main(sys.argv[1:]))"
    )
    options = ["--size", "96x72", "--seconds", "0.3", "--fps", "10", "--point-size", point_size]
    pictures = {}
    for version in ("3.3", "4.5"):
        (tmp_path / version).mkdir()
        paths = [tmp_path / "plant.gclip", "--export", tmp_path / version / "%04d.png"]
        done = subprocess.run(
            [sys.executable, "-c", log_compute_shaders, str(MADE[version]), *paths, *options],
            env=mesa(version),
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        assert ("computed" in done.stdout) == (computed and version != "3.3")
        files = sorted((tmp_path / version).iterdir())
        pictures[version] = np.array([Image.open(file).convert("RGB") for file in files], int)
    old, new = pictures.values()
    assert len(new) >= 3
    assert (new.max(axis=3) > 60).sum(axis=(1, 2)).min() > 300, "a plant is in every picture"
    assert (np.abs(old - new).max(axis=3) > 2).mean() <= differ
