"""What is written into pictures is there, true to scale, and nothing else changes."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import imageio.v3 as iio
import numpy as np
import pytest

from gclip import Clip, Motion, Track
from gclip.evaluate import linear_to_srgb, srgb_to_linear
from player.cli import main as play
from player.errors import PlayerError
from player.export import Film, export
from player.view.annotations import Annotations, round_length
from player.view.colors import Colors
from player.view.style import Style

SIZE = (640, 360)


@pytest.fixture
def clip(make_clip: Any) -> Clip:
    return make_clip()


def still(clip: Clip, folder: Path, **wishes: Any) -> np.ndarray:
    film = Film(size=SIZE, at=(1.0,), **wishes)
    export(clip, film, folder / "still.png")
    return iio.imread(folder / "still.png").astype(int)


@pytest.mark.parametrize(
    ("wishes", "rows", "columns", "ground"),
    [
        ({"title": "Maize"}, slice(0, 60), slice(0, 200), "light"),
        ({"annotations": Annotations(date=True)}, slice(300, 360), slice(0, 200), "dark"),
        ({"annotations": Annotations(scale_bar=True)}, slice(300, 360), slice(440, 640), "dark"),
        ({"annotations": Annotations(legend=True)}, slice(0, 60), slice(440, 640), "dark"),
    ],
)
def test_each_stamp_has_its_corner(
    clip: Clip, tmp_path: Path, wishes: dict, rows: slice, columns: slice, ground: str
) -> None:
    style = Style(ground=ground)
    changed = np.abs(
        still(clip, tmp_path, style=style, **wishes) - still(clip, tmp_path, style=style)
    )
    marked = changed.max(axis=2) > 60
    assert marked[rows, columns].sum() > 20
    marked[rows, columns] = False
    assert not marked.any()


def test_the_scale_bar_is_as_long_as_it_says(clip: Clip, tmp_path: Path) -> None:
    plain, barred = (
        still(clip, tmp_path, annotations=Annotations(scale_bar=on)) for on in (False, True)
    )
    camera = Film(size=SIZE).cameras(clip)[0]
    units = SIZE[1] / (2 * camera.distance * math.tan(camera.field_of_view / 2))
    columns = np.flatnonzero((np.abs(barred - plain).max(axis=2) > 60)[325:347].any(axis=0))
    width = columns[-1] - columns[0] + 1
    assert width / units == pytest.approx(round_length(0.22 * SIZE[0] / units), abs=1.5 / units)


@pytest.mark.parametrize(
    ("longest", "length"), [(1.0, 1.0), (1.9, 1.0), (2.0, 2.0), (49, 20), (0.07, 0.05), (5e6, 5e6)]
)
def test_bars_have_round_lengths(longest: float, length: float) -> None:
    assert round_length(longest) == pytest.approx(length)


def test_a_long_legend_is_cut_and_says_so(clip: Clip, tmp_path: Path) -> None:
    many = tuple(Track(i, f"organ {i}\n\x1b", (i % 256, 99, 0)) for i in range(400))
    picture = still(replace(clip, track_table=many), tmp_path, annotations=Annotations(legend=True))
    plain = still(replace(clip, track_table=many), tmp_path)
    rows = np.flatnonzero(np.abs(picture - plain).max(axis=(1, 2)) > 60)
    assert 150 < rows[-1] < 0.8 * SIZE[1]


def test_a_transparent_picture_over_the_ground_is_the_picture(clip: Clip, tmp_path: Path) -> None:
    bare, no_organ = Style(floor=False), frozenset(range(len(clip.track_table)))
    plain = still(clip, tmp_path, style=bare)
    ground = still(clip, tmp_path, style=replace(bare, hidden=no_organ))
    cut = still(clip, tmp_path, transparent=True)
    assert cut.shape == (*SIZE[::-1], 4)
    opacity = cut[..., 3:] / 255.0
    assert (opacity[:20] == 0).all()
    assert (opacity == 1.0).sum() > 4000, "the plant itself is opaque"
    assert ((opacity > 0.0) & (opacity < 1.0)).sum() > 100, "its edges are smooth"
    plant, behind = (srgb_to_linear(picture[..., :3] / 255.0) for picture in (cut, ground))
    over = 255.0 * linear_to_srgb(opacity * plant + (1.0 - opacity) * behind)
    assert np.abs(over - plain[..., :3]).max() <= 3


def test_transparency_is_for_pictures(clip: Clip, tmp_path: Path) -> None:
    with pytest.raises(PlayerError, match="holds no transparency"):
        export(clip, Film(transparent=True), tmp_path / "film.mp4")


def test_a_legend_of_colors_that_are_not_shown_is_refused(make_clip: Any, tmp_path: Path) -> None:
    clip = make_clip(colors=((1, 2, 3, 255), (1, 2, 3, 255)))
    film = Film(size=(64, 48), annotations=Annotations(legend=True))
    with pytest.raises(PlayerError, match="--color track"):
        export(clip, film, tmp_path / "still.png")
    for meant in ("track", "age", "height"):
        export(clip, replace(film, style=Style(color_by=meant)), tmp_path / "still.png")


def test_a_legend_of_values_shows_the_ramp(clip: Clip, tmp_path: Path) -> None:
    style = Style(color_by="height")
    plain, named = (
        still(clip, tmp_path, style=style, annotations=wanted)
        for wanted in (Annotations(), Annotations(legend=True))
    )
    changed = named[(plain != named).any(axis=2)].astype(int)
    scale = Colors(clip).value_range(style)
    assert scale is not None
    for color in scale.colors()[[8, 128, 248]].astype(int):
        assert np.abs(changed[:, :3] - color).max(axis=1).min() <= 6


def test_webm_has_the_films_frames_and_is_reproducible(clip: Clip, tmp_path: Path) -> None:
    import imageio_ffmpeg

    film = Film(size=(64, 48), fps=10, every=1.0, title="x")
    for name in ("a.webm", "b.webm"):
        export(clip, film, tmp_path / name)
    assert (tmp_path / "a.webm").read_bytes() == (tmp_path / "b.webm").read_bytes()
    reader = imageio_ffmpeg.read_frames(str(tmp_path / "a.webm"))
    about = next(reader)
    assert about["codec"] == "vp9"
    assert about["size"] == (64, 48)
    assert "bt709" in about["pix_fmt"]
    assert len(list(reader)) == 6, "days 0 to 5, one frame each"


def test_every_steps_in_equal_times(make_clip: Any) -> None:
    clip = make_clip(lost=Motion.FADE)
    assert Film(every=2.0).days(clip) == [0.0, 2.0, 4.0]
    assert Film(every=0.1).days(clip)[-1] == 5.0
    assert Film(every=99.0).days(clip) == [0.0]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--every", "0"], "--every is '0'; Input should be greater"),
        (["--every", "nan"], "--every is 'nan'; Input should be greater"),
        (["--every", "1", "--seconds", "3"], "give one of them"),
        (["--every", "1e-5"], "frames would be written"),
    ],
)
def test_times_that_make_no_film_are_refused(
    clip: Clip, tmp_path: Path, capsys: Any, arguments: list[str], words: str
) -> None:
    clip.save(tmp_path / "p.gclip")
    output = str(tmp_path / "film.mp4")
    assert play([str(tmp_path / "p.gclip"), "--export", output, *arguments]) == 2
    assert words in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["p.gclip"]


def test_the_list_of_exports_names_every_suffix(clip: Clip, tmp_path: Path, capsys: Any) -> None:
    from player.export.formats import FORMATS

    assert play(["--list-exports"]) == 0
    listed = capsys.readouterr().out
    assert all(one.example in listed for one in FORMATS)
    clip.save(tmp_path / "x.gclip")
    assert play([str(tmp_path / "x.gclip"), "--export", "x.docx"]) == 2
    refused = capsys.readouterr().err
    assert all(name in refused for one in FORMATS for name in one.suffixes)
