"""All commands print the distribution's version."""

from __future__ import annotations

import tomllib
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import pytest

from gclip import __version__

ROOT = Path(__file__).parents[1]
COMMANDS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_prints_the_version(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    module, _, function = COMMANDS[command].partition(":")
    assert getattr(import_module(module), function)(["--version"]) == 0
    assert capsys.readouterr().out == f"{command} {__version__}\n"


def test_it_is_the_installed_version() -> None:
    assert version("plant-growth-clips") == __version__
