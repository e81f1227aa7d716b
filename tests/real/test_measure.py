"""Traits over time must at least be of one piece."""

from collections.abc import Callable
from pathlib import Path

import pytest

from baker import Options, bake
from tests.real.series import labelled
from traits import measure


@pytest.mark.parametrize("name", labelled("tomato1_control2_plant1"))
def test_nothing_jumps_at_a_scan(series: Callable[[str], Path], name: str) -> None:
    files = sorted(series(name).glob("*.txt"))[2:5]
    clip = bake(files, Options(paths="straight", workers=1))
    day = clip.times[1]
    before, at, after = (
        {one.track: one for one in measure(clip, day + step)} for step in (-1e-5, 0.0, 1e-5)
    )
    seen = 0
    for track, one in at.items():
        for near in (before.get(track), after[track]):
            if near is None or one.points < 100:  # a bud, until this scan
                continue
            seen += 1
            assert near.height == pytest.approx(one.height, rel=0.01)
            assert near.area == pytest.approx(one.area, rel=0.02)
            assert near.hull == pytest.approx(one.hull, rel=0.04)
            if track is not None:
                assert near.length == pytest.approx(one.length, rel=0.02)
    assert seen > 8
