"""What a clip tells of itself."""

from __future__ import annotations

import numpy as np
import pytest

import gclip
from gclip import Box, Group, Motion


@pytest.mark.parametrize("precision", ["auto", "float32"])
def test_bounds_hold_every_mover_and_control_point(make_clip, precision: str) -> None:
    clip = make_clip(degree=3, precision=precision)
    low, high = clip.bounds
    points = []
    for interval in clip.intervals:
        step = np.ones(3) if interval.box is None else interval.box.step
        begin = np.zeros(3) if interval.box is None else np.asarray(interval.box.low)
        points += [begin + step * curve for curve in interval.curve]
    together = np.concatenate(points)
    assert np.allclose(low, together.min(axis=0), atol=1e-3)
    assert np.allclose(high, together.max(axis=0), atol=1e-3)


def test_a_box_has_65535_steps() -> None:
    box = Box((0.0, -1.0, 5.0), (65535.0, 1.0, 5.0))
    assert box.step.tolist() == [1.0, 2.0 / 65535.0, 0.0]


def test_small_facts(make_clip) -> None:
    clip = make_clip()
    assert clip.times == [0.0, 2.0, 5.0]
    assert not clip.has_colors
    assert make_clip(colors=True).has_colors
    assert clip.palette.tolist() == [[150, 124, 92, 255], [63, 144, 218, 255]]
    assert Group(3, 4, Motion.MOVE).stop == 7
    assert [len(interval) for interval in clip.intervals] == [300, 300]
    assert [make_clip(degree=d).intervals[0].degree for d in (1, 2, 3)] == [1, 2, 3]


def test_the_package_has_what_it_names() -> None:
    for name in gclip.__all__:
        assert getattr(gclip, name)
    with pytest.raises(AttributeError, match="attribute opne"):
        gclip.opne  # noqa: B018
