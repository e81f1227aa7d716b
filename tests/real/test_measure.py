"""Traits of real plants, whose truth nobody knows: they must at least be of one piece."""

from pathlib import Path

import pytest

from baker import Options, bake
from traits import measure

SCANS = ("day04.txt", "day06.txt", "day08.txt")


def test_nothing_jumps_at_a_scan_of_a_real_tomato(shared_data: Path) -> None:
    folder = shared_data / "tomato1_control2_plant1"
    clip = bake([folder / name for name in SCANS], Options(paths="straight", workers=1))
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
