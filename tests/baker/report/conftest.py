"""Bakes to report of."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from baker.pipeline import Survey
from gclip import Clip
from tests.baker.conftest import write_series


@pytest.fixture(scope="session")
def baked(tmp_path_factory) -> tuple[Clip, Survey]:
    """Five scans of a plant, two of them left out."""
    from baker import Options
    from baker.pipeline import bake_with_survey

    scans = write_series(tmp_path_factory.mktemp("report") / "scans", days=range(5))
    return bake_with_survey([scans], Options(align="none", up="z", holdout=2))


@pytest.fixture(scope="session")
def player_draws(tmp_path_factory) -> None:
    """Skip where the player has no OpenGL to draw with."""
    import numpy as np

    from baker.interpolation.packing import Movers, pack_interval
    from gclip import Motion, ScanMark, Track

    points = np.random.default_rng(0).random((50, 3))
    movers = Movers(Motion.MOVE, (points, points), np.zeros(50, int))
    clip = Clip(
        scans=(ScanMark("", 0.0, "", 50), ScanMark("", 1.0, "", 50)),
        intervals=(pack_interval(0.0, 1.0, [movers], spacing=0.1),),
        track_table=(Track(0, "", (0, 0, 0)),),
    )
    path: Path = tmp_path_factory.mktemp("player") / "clip.gclip"
    clip.save(path)
    target = path.with_suffix(".png")
    command = [sys.executable, "-m", "player", path, "--export", target, "--size", "16x16"]
    drawn = subprocess.run(command, capture_output=True, text=True)
    if drawn.returncode:
        pytest.skip(drawn.stderr.strip())


@pytest.fixture
def player_fails(tmp_path, monkeypatch) -> None:
    """As on a machine without EGL: the player says so and gives up."""
    from baker.report import pictures

    program = tmp_path / "broken-player"
    program.write_text('#!/bin/sh\necho "play: no EGL here." >&2\nexit 2\n')
    program.chmod(0o755)
    monkeypatch.setattr(pictures.sys, "executable", str(program))
