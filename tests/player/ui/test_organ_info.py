"""What is told about a picked organ is what the plot above the timeline shows."""

import threading
import time
from typing import Any

import pytest

from gclip import Clip
from player.ui.organ_info import OrganInfo
from tests.player.conftest import ClipMaker


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_values_lie_on_the_plotted_curves(make_clip: ClipMaker, share: float) -> None:
    clip = make_clip()
    info = OrganInfo(clip)
    ends = time.monotonic() + 60.0
    while not info.curves(0) and time.monotonic() < ends:
        time.sleep(0.02)
    area = next(curve for curve in info.curves(0) if curve.trait == "area")
    first, second = area.times[:2]
    told = dict(info.lines(clip, 0, first + share * (second - first)))
    number, unit = told["area now"].removeprefix("about ").split()
    expected = (1 - share) * area.values[0] + share * area.values[1]
    assert float(number.replace(",", "")) == pytest.approx(expected, rel=1e-3)
    assert unit == "mm²"
    assert told["born"] == "before the first scan"
    while not info.curves(1) and time.monotonic() < ends:
        time.sleep(0.02)
    lost = dict(info.lines(clip, 1, clip.times[-1]))
    assert lost["area now"] == "not there"
    assert (lost["grows from"], lost["lost"]) == ("stem", "day 5")
    info.release()


def test_organs_that_were_picked_in_passing_are_not_measured(
    make_clip: ClipMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, may_end, measured = threading.Event(), threading.Event(), []

    def measure(clip: Clip, tracks: list[int]) -> list[Any]:
        begun.set()
        may_end.wait(60.0)
        measured.extend(tracks)
        return [f"curve of {tracks[0]}"]

    monkeypatch.setattr("player.ui.organ_info.trait_curves", measure)
    info = OrganInfo(make_clip())
    info.curves(0)
    assert begun.wait(60.0)
    for track in (1, 2, 3, 1):
        assert info.curves(track) == ()
    may_end.set()
    ends = time.monotonic() + 60.0
    while not info.curves(1) and time.monotonic() < ends:
        time.sleep(0.02)
    assert info.curves(1) == ("curve of 1",)
    assert info.curves(0) == ("curve of 0",)
    assert measured == [0, 1]
    info.release()
