"""What the report draws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from baker.report.figures import (
    Curve,
    growth_curves,
    length_ticks,
    picture_requests,
    scale_bar,
    scans_pictured,
)
from baker.report.pictures import Picture
from baker.verdict import Doubt


def test_growth_curves_are_the_organs_lengths_at_the_scans(baked):
    """The stem is 10 long and grows by 2 a day; leaf 1 by the square root of 5."""
    clip, _ = baked
    curves = {clip.track_table[c.track].name: c for c in growth_curves(clip)}
    assert curves["label 0"].times == [0.0, 2.0, 4.0]
    assert curves["label 0"].lengths == pytest.approx([10, 14, 18], rel=0.03)
    assert curves["label 1"].lengths == pytest.approx(5**0.5 * np.array([1, 3, 5]), rel=0.06)
    assert curves["label 2"].times == [2.0, 4.0], "it is not there yet at the first scan"


@pytest.mark.parametrize("longest", [0.004, 0.99, 1.0, 37.0, 2600.0])
def test_ticks_are_round_and_few_and_reach_the_longest(longest):
    ticks = length_ticks([Curve(0, [0.0], [longest / 2]), Curve(1, [0.0], [longest])])
    assert ticks[0] == 0.0
    assert ticks[-2] < longest <= ticks[-1]
    assert 2 <= len(ticks) <= 7
    assert f"{ticks[1]:e}"[0] in "125"


def test_pictures_show_the_scans_themselves_and_the_organs_in_doubt_in_colour(baked):
    clip, record = baked
    doubt = Doubt(0.0, 2.0, 1, "it tears", 1.0)
    requests = picture_requests(clip, replace(record, held_out=()), [[doubt]], [], None)
    assert set(requests) == {"scan-0", "scan-1", "scan-2", "doubt-0-0", "doubt-0-1", "doubt-0-2"}
    for k in range(3):
        shown = np.unique(requests[f"scan-{k}"].points, axis=0)
        assert len(shown) == len(record.keyframes[k].positions)
        about = np.unique(requests[f"doubt-0-{k}"].colors, axis=0)
        assert len(about) == 2
        assert clip.track_table[1].color in {tuple(color) for color in about.tolist()}


def test_of_many_scans_a_dozen_is_shown_with_both_ends(baked):
    clip, _ = baked
    many = replace(clip, scans=clip.scans * 20)
    shown = scans_pictured(many)
    assert len(shown) == len(set(shown)) == 12
    assert (shown[0], shown[-1]) == (0, 59)


def test_the_scale_bar_is_a_round_length(baked):
    """Seen straight from the front, a unit of length is 40 pixels wide and 40 high."""
    picture = Picture(b"", (400, 400), np.diag([0.2, 0.2, 0.0, 1.0]))
    bar = scale_bar(baked[0], picture)
    assert (bar.length, bar.pixels) == (2.0, pytest.approx(80.0))
