"""A field and a file in shaders/effects are all that a new effect needs."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
FIELD = '    fog: float = effect(0.0, text="red fog", help="Strength of the red fog.")\n\n'
GLSL = """vec3 with_fog(vec3 light, float strength) {
    return mix(light, vec3(1.0, 0.0, 0.0), strength);
}
"""
PANEL = """
from dataclasses import replace
from player.gl.context import headless
from tests.player.desk import Desk
from tests.player.shown import small_clip

desk = Desk(headless(), small_clip(), size=(1280.0, 1200.0), scale=0.25)
desk.scene = replace(desk.scene, panel=True)
desk.draw(3)
left, top, right, bottom = desk.places["fog"]
desk.drag((left + 5.0, (top + bottom) / 2), (right + 300.0, (top + bottom) / 2))
print(desk.scene.style.fog)
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder in which the package `shaders` has one effect more."""
    effects = shutil.copytree(ROOT / "shaders", tmp_path / "shaders") / "effects"
    table, mark = effects / "__init__.py", "    @property\n    def uniforms"
    text = table.read_text()
    assert text.count(mark) == 1
    table.write_text(text.replace(mark, FIELD + mark))
    (effects / "fog.glsl").write_text(GLSL)
    return tmp_path


def test_an_added_effect_is_everywhere(folder: Path, make_clip) -> None:
    def run(*words: str) -> subprocess.CompletedProcess[str]:
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        command = [sys.executable, *words]
        return subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, check=False
        )

    def play(*words: str) -> str:
        done = run("-m", "player", *words)
        return done.stdout + done.stderr

    make_clip().save(folder / "plant.gclip")
    export = "plant.gclip", "--size", "64x48", "--export"
    assert "--fog" in play("--help")
    assert "--fog is '2'; Input should be less than or equal to 1" in play("a.gclip", "--fog", "2")
    assert "--fog has no effect on t.csv" in play("plant.gclip", "--export", "t.csv", "--fog", "1")
    assert "wrote red.png" in play(*export, "red.png", "--fog", "1")
    with Image.open(folder / "red.png") as picture:
        pixels = np.asarray(picture.convert("RGB")).astype(int)
    assert (pixels[..., 0] > 250).any()
    assert "wrote plant.html" in play(*export, "plant.html", "--fog", "0.5")
    page = (folder / "plant.html").read_text()
    for part in ('name="fog_strength" type="range"', '"fog_strength":0.5', "vec3 with_fog("):
        assert part in page
    panel = run("-c", PANEL)
    assert panel.stdout == "1.0\n", panel.stderr
