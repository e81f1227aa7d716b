"""What people do with a clip in Python."""

from __future__ import annotations

import numpy as np
import pytest


def test_a_clip_says_what_it_is_in_one_line(make_clip):
    text = repr(make_clip())
    assert text.startswith("<gclip.Clip: ")
    assert "day 0 to day 5" in text
    assert "\n" not in text
    assert len(text) < 120


def test_tracks_are_found_by_name(make_clip):
    clip = make_clip()
    assert clip.tracks["stem"] is clip.track_table[0]
    with pytest.raises(KeyError, match="no track is called 'twig'; these are: stem, "):
        clip.tracks["twig"]


def test_an_open3d_cloud_has_the_frame_s_points_and_colors(make_clip):
    clip = make_clip()
    cloud, frame = clip.to_open3d(2.5), clip.at(2.5)
    assert np.array_equal(np.asarray(cloud.points), frame.positions)
    assert np.array_equal(np.round(255 * np.asarray(cloud.colors)), frame.colors[:, :3])


def test_traits_are_the_table_that_is_exported(make_clip):
    clip = make_clip()
    table = clip.traits(days=[0.0, 5.0])
    assert {"organ", "trait", "value", "unit", "time", "sure"} <= {*table.columns}
    heights = table.query("level == 'plant' and trait == 'height' and state == 'scan'")
    assert heights["time"].tolist() == [0.0, 5.0]
    assert (heights["value"] > 0).all()
    assert table["sure"].dtype == bool
