"""What is seen at a time, number by number: the table of motions in docs/format.md."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gclip
from gclip import Group, Layer, Motion
from gclip.evaluate import LITTER_FADE, bernstein, layers_at, locate


@pytest.fixture
def falling(make_clip) -> gclip.Clip:
    """Times 0, 2, 5, 9: the second interval loses an organ, the third one does not."""
    clip = make_clip(lost=Motion.FALL)
    still = replace(clip.intervals[0], start=5.0, end=9.0)
    scans = (*clip.scans, replace(clip.scans[0], time=9.0))
    return replace(clip, scans=scans, intervals=(*clip.intervals, still))


@pytest.mark.parametrize(
    ("motion", "share", "expected"),
    [
        (Motion.FALL, 0.0, (0.0, 0.0, 1.0, False)),
        (Motion.FALL, 0.5, (0.25, 0.5, 1.0, False)),
        (Motion.FALL, 1.0, (1.0, 1.0, 1.0, True)),
        (Motion.FADE, 0.0, (0.0, 0.0, 1.0, False)),
        (Motion.FADE, 0.5, (0.5, 0.5, 0.5, False)),
        (Motion.FADE, 1.0, None),
        (Motion.REMOVE, 0.0, (0.0, 0.0, 1.0, False)),
        (Motion.REMOVE, 0.5, None),
        (Motion.REMOVE, 1.0, None),
    ],
)
def test_what_is_lost(make_clip, motion: Motion, share: float, expected: tuple | None) -> None:
    moving, *rest = layers_at(make_clip(lost=motion), 2.0 + 3.0 * share)
    assert moving == Layer(1, Group(0, 150, Motion.MOVE), share, share, 1.0)
    if expected is None:
        assert rest == []
    else:
        assert rest == [Layer(1, Group(150, 150, motion), *expected)]


@pytest.mark.parametrize(
    ("share", "alpha"),
    [(0.0, 1.0), (LITTER_FADE / 4, 0.75), (LITTER_FADE + 1e-9, None), (0.5, None)],
)
def test_litter_of_the_interval_before(falling, share: float, alpha: float | None) -> None:
    litter = [layer for layer in layers_at(falling, 5.0 + 4.0 * share) if layer.litter]
    if alpha is None:
        assert litter == []
    else:
        assert litter == [
            Layer(1, Group(150, 150, Motion.FALL), 1.0, 1.0, pytest.approx(alpha), litter=True)
        ]
    first = layers_at(falling, 0.0)
    assert not any(layer.litter for layer in first), "nothing was lost before the first scan"


@pytest.mark.parametrize(
    ("day", "index", "share"),
    [
        (-1.0, 0, 0.0),
        (0.0, 0, 0.0),
        (1.5, 0, 0.75),
        (2.0, 1, 0.0),
        (3.5, 1, 0.5),
        (5.0, 2, 0.0),
        (9.0, 2, 1.0),
        (99.0, 2, 1.0),
    ],
)
def test_a_scan_s_time_begins_its_interval(falling, day: float, index: int, share: float) -> None:
    assert locate(falling, day) == (index, share)


def test_bernstein_weights() -> None:
    assert bernstein(1, 0.25).tolist() == [0.75, 0.25]
    assert bernstein(2, 0.5).tolist() == [0.25, 0.5, 0.25]
    assert bernstein(3, 0.5).tolist() == [0.125, 0.375, 0.375, 0.125]
    for degree in (1, 2, 3):
        assert bernstein(degree, 0.0).tolist() == [1.0] + [0.0] * degree
        assert bernstein(degree, 1.0).tolist() == [0.0] * degree + [1.0]
        assert bernstein(degree, 0.3).sum() == pytest.approx(1.0)


def test_litter_fades_in_the_colors_too(falling) -> None:
    frame = falling.at(5.0 + 4.0 * LITTER_FADE / 2)
    assert frame.litter is not None
    assert set(frame.litter.colors[:, 3].tolist()) == {128}
    assert set(frame.colors[:, 3].tolist()) == {255}


@pytest.mark.parametrize(
    ("times", "words"),
    [((3.0, 3.0), "do not ascend"), ((4.0, 3.0), "do not ascend"), ((-0.1, 1.0), "outside"),
     ((1.0, 5.1), "outside"), ((0.0, 5.0), "")],
)  # fmt: skip
def test_scans_left_out_lie_within_the_series(make_clip, tmp_path, times, words: str) -> None:
    points = np.zeros((2, 3), np.float32)
    held_out = tuple(gclip.ScanMark("x.ply", time, "", len(points), points) for time in times)
    if words:
        with pytest.raises(ValueError, match=words):
            replace(make_clip(), held_out=held_out)
    else:
        replace(make_clip(), held_out=held_out).save(tmp_path / "c.gclip")
        assert [scan.time for scan in gclip.open(tmp_path / "c.gclip").held_out] == list(times)


def test_litter_is_that_of_the_interval_before_and_no_other(make_clip) -> None:
    clip = make_clip(lost=Motion.FALL)
    assert not any(layer.litter for layer in layers_at(clip, 0.0)), "not of the last interval"
    falls, still = clip.intervals[1], clip.intervals[0]
    swapped = replace(
        clip,
        intervals=(replace(falls, start=0.0, end=2.0), replace(still, start=2.0, end=5.0)),
    )
    litter = [layer for layer in layers_at(swapped, 2.0) if layer.litter]
    assert litter == [Layer(0, Group(150, 150, Motion.FALL), 1.0, 1.0, 1.0, litter=True)]
