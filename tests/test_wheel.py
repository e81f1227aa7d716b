"""What is installed from a wheel works as the checkout does."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
NOT_SOURCE = {"__pycache__"}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: Any) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    return next(folder.glob("*.whl"))


def packages() -> list[str]:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    return settings["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]


def test_the_wheel_holds_every_file_of_its_packages(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        inside = {name for name in archive.namelist() if ".dist-info/" not in name}
    sources = [path for package in packages() for path in (ROOT / package).rglob("*")]
    outside = {
        path.relative_to(ROOT).as_posix()
        for path in sources
        if path.is_file() and not NOT_SOURCE & set(path.parts)
    }
    assert inside == outside
    assert {Path(name).suffix for name in inside} >= {".py", ".frag", ".glsl", ".js", ".html"}


def test_the_wheel_draws(wheel: Path, tmp_path: Path) -> None:
    site, clip = tmp_path / "site", ROOT / "tests/player/pictures/tree.gclip"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    play = (
        "import sys, player.cli, shaders\n"
        f"assert all(m.__file__.startswith({str(site)!r}) for m in (player, shaders))\n"
        "clip, *outputs = sys.argv[1:]\n"
        "size = ['--size', '64x48', '-q']\n"
        "assert not any(player.cli.main([clip, '--export', o, *size]) for o in outputs)\n"
    )
    outputs = ("still.png", "page.html")
    command = [sys.executable, "-c", play, clip, *outputs]
    environment = {**os.environ, "PYTHONPATH": str(site)}
    subprocess.run(command, cwd=tmp_path, env=environment, check=True)
    assert all((tmp_path / output).stat().st_size > 1000 for output in outputs)
