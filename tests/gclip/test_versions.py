"""Clips that earlier versions wrote open for ever: tests/gclip/clips is added to, never renewed."""

import json
from pathlib import Path

import numpy as np
import pytest

import gclip
from gclip import check

CLIPS = Path(__file__).with_name("clips")
POSITIONS = json.loads((CLIPS / "positions.json").read_text())  # at some days, by the clip's name


def test_every_clip_is_known() -> None:
    assert {path.name for path in CLIPS.glob("*.gclip")} == {*POSITIONS}


@pytest.mark.parametrize("name", POSITIONS)
def test_a_clip_of_an_earlier_version_opens_and_moves_as_it_did(name: str) -> None:
    assert check(CLIPS / name)
    clip = gclip.open(CLIPS / name)
    for day, positions in POSITIONS[name].items():
        np.testing.assert_allclose(clip.at(float(day)).positions, positions, atol=2e-3)
