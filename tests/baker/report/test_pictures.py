"""Pictures taken by the player."""

from __future__ import annotations

import base64
from dataclasses import replace
from io import BytesIO
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

from baker.report.pictures import NEUTRAL_COLOR, NoPicture, Pictures, scans_pictured, take_pictures
from traits.doubts import Doubt


def pixels(picture: str) -> np.ndarray:
    head, _, content = picture.partition(",")
    assert head == "data:image/jpeg;base64"
    return np.asarray(Image.open(BytesIO(base64.b64decode(content)))).astype(int)


def grown(clip):
    """The clip in two colours that nothing else in a picture has: a red stem, blue leaves."""
    colors = {track.id: (255, 0, 0) if track.id == 0 else (0, 0, 255) for track in clip.track_table}
    table = tuple(replace(track, color=colors[track.id]) for track in clip.track_table)
    return replace(clip, track_table=table)


def count(picture: str, channel: int) -> int:
    image = pixels(picture)
    others = np.delete(image, channel, axis=2).max(axis=2)
    return int((image[:, :, channel] - others > 60).sum())


@pytest.fixture(scope="module")
def pictures(baked, player_draws) -> Pictures:
    """Of the scans, of what was left out, and of a doubt about a leaf and one about the stem."""
    doubts = [[Doubt(0.0, 2.0, track, "it tears", 1.0)] for track in (1, 0)]
    return take_pictures(grown(baked[0]), doubts)


def test_pictures_of_the_scans_and_of_those_left_out_share_a_camera(baked, pictures):
    clip, record = baked
    assert len(pictures.scans) == len(clip.scans)
    assert len(pictures.errors) == len(record.held_out)
    shapes = {pixels(picture).shape for picture in (*pictures.scans, *pictures.errors)}
    assert len(shapes) == 1
    sizes = [count(picture, 0) for picture in pictures.scans]
    assert 0 < sizes[0] < sizes[1] < sizes[2], "the stem grows"


def test_the_scans_have_a_scale_bar(pictures):
    dark = [int((pixels(picture).max(axis=2) < 90).sum()) for picture in pictures.scans]
    assert min(dark) > 20 > max(int((pixels(p).max(axis=2) < 90).sum()) for p in pictures.doubts[0])


def test_of_a_doubtful_interval_only_the_organs_in_doubt_have_colours(pictures):
    (leaf, *_), (stem, *_) = pictures.doubts
    assert count(leaf, 2) > 0 == count(leaf, 0)
    assert count(stem, 0) > 0 == count(stem, 2)
    assert max(NEUTRAL_COLOR) - min(NEUTRAL_COLOR) < 30


def test_a_player_that_cannot_draw_is_quoted(baked, player_fails):
    with pytest.raises(NoPicture, match="no EGL here"):
        take_pictures(baked[0], [])


def test_of_many_scans_a_dozen_is_shown_with_both_ends(baked):
    clip, _ = baked
    times = np.linspace(*clip.times[::2], 60).tolist()
    scans = tuple(replace(clip.scans[0], time=time) for time in times)
    interval = clip.intervals[0]
    intervals = tuple(replace(interval, start=a, end=b) for a, b in pairwise(times))
    many = replace(clip, scans=scans, intervals=intervals)
    shown = scans_pictured(many)
    assert len(shown) == len(set(shown)) == 12
    assert (shown[0], shown[-1]) == (0, 59)
