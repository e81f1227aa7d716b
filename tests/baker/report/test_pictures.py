"""Pictures taken by the player."""

from __future__ import annotations

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from baker.report.pictures import NoPicture, Picture, PictureRequest, take_pictures


@pytest.fixture
def requested(baked) -> dict[str, PictureRequest]:
    """The first scan in grey with its highest point in red; the last scan in grey."""
    _, record = baked
    grey = []
    for frame in (record.keyframes[0], record.keyframes[-1]):
        colors = np.full((len(frame.positions), 3), 120, np.uint8)
        grey.append(PictureRequest(frame.positions, colors))
    grey[0].colors[grey[0].points[:, 2].argmax()] = (255, 0, 0)
    return dict(zip(("first", "last"), grey, strict=True))


@pytest.mark.usefixtures("player_draws")
def test_a_picture_shows_what_was_requested_and_says_where_everything_is(baked, requested):
    first, last = take_pictures(requested, baked[0]).values()
    image = np.asarray(Image.open(BytesIO(first.jpeg))).astype(int)
    assert image.shape == (first.size[1], first.size[0], 3)
    top = requested["first"].points[requested["first"].points[:, 2].argmax()]
    ((x, y),) = first.project(top[None])
    red = (image[:, :, 0] - image[:, :, 1:].max(axis=2) > 60).nonzero()
    assert np.hypot(red[1] - x, red[0] - y).min() < 3.0
    assert np.allclose(first.view, last.view), "one camera for all"
    spots = last.project(requested["last"].points)
    assert (spots >= 0).all()
    assert (spots <= last.size).all()


def test_a_player_that_cannot_draw_is_quoted(baked, requested, player_fails):
    with pytest.raises(NoPicture, match="no EGL here"):
        take_pictures(requested, baked[0])


def test_a_window_shows_the_plant_in_the_pictures_shape(requested):
    """Seen straight from the front, a unit of length is 40 pixels wide and 80 high."""
    picture = Picture(b"", (400, 800), np.diag([0.2, 0.2, 0.0, 1.0]))
    for points in (requested["first"].points / 30, requested["last"].points / 30, np.zeros((1, 3))):
        x, y, width, height = picture.window(points)
        places = picture.project(points)
        assert (places >= [x, y]).all()
        assert (places <= [x + width, y + height]).all()
        assert height == pytest.approx(2 * width, abs=0.2)
        assert 0 <= x <= x + width <= 400
        assert 0 <= y <= y + height <= 800
